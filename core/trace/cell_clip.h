// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/trace/light_reach.h"

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

/// The part of one side of a triangle inside one cell.
struct CellPiece {
    std::uint64_t cell; ///< Morton code
    std::uint32_t side; ///< 2 * triangle, + 1 for its back
    float area;         ///< m2
    glm::vec3 centroid; ///< scene space
};

/// Clips every triangle side that light reaches against the lattice (exact polygon clipping, Sutherland-Hodgman, by
/// halving cells). Sorted by (cell, side). Areas of the pieces of a side add up to the side's area. A point on a cell
/// border belongs to the upper cell. Empty and false in `complete`: stopped.
struct CellPieces {
    std::vector<CellPiece> pieces;
    bool complete = false;
};
[[nodiscard]] CellPieces clipToCells(const RayScene& rays, const LightReach& reach, const CellLattice& lattice,
                                     Workers& workers, const std::stop_token& stop);

/// Interleaves the low 21 bits of each coordinate: x lowest.
[[nodiscard]] std::uint64_t mortonCode(glm::uvec3 cell);
[[nodiscard]] glm::uvec3 mortonCell(std::uint64_t code);

} // namespace lightloom
