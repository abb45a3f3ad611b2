// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"
#include "core/trace/ray_scene.h"

namespace lightloom {

/// Vertices of a grid of boxes over a scene, `cells + 1` along each axis. Grid coordinates count cells from the lowest
/// vertex: vertices are where they are whole.
struct GridLattice {
    glm::vec3 lowest{0.0f};   ///< vertex (0, 0, 0), scene space
    glm::vec3 cellSize{1.0f}; ///< metres, positive
    glm::ivec3 cells{1};      ///< at least 1

    [[nodiscard]] glm::ivec3 vertices() const { return cells + 1; }
    [[nodiscard]] std::size_t vertexCount() const
    {
        const glm::ivec3 n = vertices();
        return static_cast<std::size_t>(n.x) * static_cast<std::size_t>(n.y) * static_cast<std::size_t>(n.z);
    }
    [[nodiscard]] std::size_t index(glm::ivec3 vertex) const
    {
        const glm::ivec3 n = vertices();
        return static_cast<std::size_t>((vertex.z * n.y + vertex.y) * n.x + vertex.x);
    }
    [[nodiscard]] glm::ivec3 vertex(std::size_t index) const
    {
        const glm::ivec3 n = vertices();
        const int i = static_cast<int>(index);
        return {i % n.x, i / n.x % n.y, i / n.x / n.y};
    }
    [[nodiscard]] glm::vec3 position(glm::ivec3 vertex) const { return lowest + glm::vec3(vertex) * cellSize; }
    [[nodiscard]] glm::vec3 toGrid(glm::vec3 p) const { return (p - lowest) / cellSize; }
    /// m2, of the rectangle around an inner vertex that faces `axis`.
    [[nodiscard]] float faceArea(int axis) const { return cellSize[(axis + 1) % 3] * cellSize[(axis + 2) % 3]; }
    [[nodiscard]] float cellVolume() const { return cellSize.x * cellSize.y * cellSize.z; } ///< m3
    bool operator==(const GridLattice&) const = default;
};

/// How many cells a grid has.
struct GridSize {
    int longest = 32;      ///< along the longest side, at least 2; cells are cubes, others as many as it takes
    glm::ivec3 perAxis{0}; ///< where not 0: so many along this axis, at least 2, whatever shape cells have then
};

/// Where surfaces lie that are parallel to a coordinate plane, by axis: fractions of a cell from the low bound, sorted.
/// Light arrives at such a surface and leaves it on one plane: a grid plane there would be a matter of rounding.
[[nodiscard]] std::vector<float> wallFractions(const RayScene& rays, int axis, float low, float cellSize);

inline constexpr float kWallClearance = 0.15f; ///< of a cell, between walls and grid planes

/// The place nearest to `wanted` on a ring of length 1 that is at least `clearance` from all of `taken` (sorted, each
/// in [0, 1)); where there is none, the middle of the widest gap.
[[nodiscard]] float freePlace(float wanted, const std::vector<float>& taken, float clearance);

/// A lattice that covers the bounds with a cell to spare, so that it does so under any `shift` (a fraction of a cell,
/// moves it towards the low corner). At shift 0 the scene's bound lies half-way between planes. Moved a little further
/// where a wall would lie within kWallClearance of a plane; where walls leave no such place, as far from all as can be.
/// O(triangles).
[[nodiscard]] GridLattice placeGrid(const RayScene& rays, const GridSize& size, float shift);

} // namespace lightloom
