// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/ivg/grid_layer.h"

namespace lightloom {

/// A vertex that a lookup reads, and its part.
struct GridCorner {
    std::size_t vertex;
    float weight;
    float known; ///< how far the lookup may rest on it: as `weight`, but whole where a vertex behind the surface leans
};

/// Up to 64 of them.
class GridCorners {
public:
    void clear() { count_ = 0; }
    void add(std::size_t vertex, float weight, float known) { corners_[count_++] = {vertex, weight, known}; }
    [[nodiscard]] const GridCorner* begin() const { return corners_.data(); }
    [[nodiscard]] const GridCorner* end() const { return corners_.data() + count_; }
    [[nodiscard]] bool isEmpty() const { return count_ == 0; }

private:
    std::array<GridCorner, 64> corners_;
    std::size_t count_ = 0;
};

/// Where on the lattice a surface at `p` that faces `n` (unit) looks: `offset` cells along its normal, grid
/// coordinates.
[[nodiscard]] glm::vec3 lookupPlace(const GridLattice& lattice, glm::vec3 p, glm::vec3 n, float offset);

/// Which vertices may light a surface.
enum class CornerSide {
    before, ///< those before it
    leaning ///< to a hundredth also those behind it that see, along an axis, a wall which faces them as the surface
            ///< does
};

/// Of the eight vertices around grid coordinates `at` (moved into the grid), with trilinear weights, those in the open,
/// on that side of the surface at `p` that faces `n` (unit), and from which no wall hides it along any axis; all fade.
///
/// `leaning` is for normals that are bent towards another wall, by a map or by smooth shading: all that is before them
/// may lie in it. Through a flat sheet it lets nothing: from its other side it faces the vertices along no axis.
void trilinearCorners(const GridGeometry& geometry, glm::vec3 at, glm::vec3 p, glm::vec3 n, CornerSide side,
                      GridCorners& corners);

/// The 64 vertices around `at`, cubic B-spline weights (never negative, they smooth) or Catmull-Rom's (they pass
/// through the values). Beyond the border its vertices count again. Behind walls too: who looks weighs by what is open.
void tricubicCorners(const GridLattice& lattice, glm::vec3 at, GridFilter filter, GridCorners& corners);

} // namespace lightloom
