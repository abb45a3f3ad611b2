// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/scene/scene.h"
#include "core/trace/reached_facet.h"
#include <array>
#include <functional>
#include <optional>
#include <span>

namespace lightloom {

/// A cubic lattice of 2^depth cells a side over the scene.
struct CellLattice {
    glm::vec3 lowest{0.0f};
    float rootSize = 1.0f; ///< metres, whole lattice
    int depth = 0;
    [[nodiscard]] float cellSize() const { return rootSize / static_cast<float>(1u << depth); }
};

/// Lattice over a scene's bound, padded by a thousandth so that no wall coincides with its border. A `shift` of part of
/// a cell moves it towards the low corner along all axes, with cells larger by 1 / (2^depth - 1) so that it still
/// covers.
[[nodiscard]] CellLattice latticeOver(const Bounds& bounds, int depth, float shift);

/// The part of a triangle inside one cell: a convex polygon of 3 to 9 corners, scene space.
struct CellPolygon {
    glm::uvec3 cell;
    std::span<const glm::dvec3> corners;
    double area = 0.0; ///< m2, positive
    glm::dvec3 centroid{0.0};
};
/// Clips a triangle against the lattice (exact, Sutherland-Hodgman, by halving cells) and visits each part in a fixed
/// order. Areas add up to the triangle's. A point on a cell border belongs to the upper cell. After a stop the rest is
/// left out.
void clipTriangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, const CellLattice& lattice,
                  const std::function<void(const CellPolygon&)>& visit, const std::stop_token& stop = {});
/// The same, but cells of coarser depths for which `isOne(cell, depth)` are not halved further: `cell` of what is
/// visited there counts in their depth.
void clipTriangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, const CellLattice& lattice,
                  const std::function<bool(glm::uvec3, int)>& isOne,
                  const std::function<void(const CellPolygon&, int depth)>& visit);

/// Corners of a triangle's part inside one cell of the lattice, as `clipTriangle` cuts it, into `corners`; how many: 0
/// or 3 to 9.
std::size_t clipToCell(glm::vec3 a, glm::vec3 b, glm::vec3 c, const CellLattice& lattice, glm::uvec3 cell,
                       std::array<glm::dvec3, 9>& corners);

/// The part of one reached facet inside one cell.
struct CellPiece {
    std::uint64_t cell;  ///< Morton code
    std::uint32_t facet; ///< index into LightReach::facets
    float area;          ///< m2
    glm::vec3 centroid;  ///< scene space
};
struct CellPieces {
    std::vector<CellPiece> pieces;
    bool complete = false;
};
/// Cells of a coarser depth of a lattice: Morton codes, rising.
struct CellsWithin {
    std::span<const std::uint64_t> cells;
    int depth = 0;
};
/// All reached facets, or their parts in the cells of `within`, against the lattice, sorted by (cell, facet).
/// `complete` false: stopped, do not use.
[[nodiscard]] CellPieces clipToCells(const std::vector<ReachedFacet>& facets, const CellLattice& lattice,
                                     Workers& workers, const std::stop_token& stop,
                                     const std::optional<CellsWithin>& within = {});

/// Interleaves the low 21 bits of each coordinate: x lowest.
[[nodiscard]] std::uint64_t mortonCode(glm::uvec3 cell);
[[nodiscard]] glm::uvec3 mortonCell(std::uint64_t code);

} // namespace lightloom
