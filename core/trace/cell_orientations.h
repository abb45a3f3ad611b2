// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/cell_clip.h"
#include <vector>

namespace lightloom {

/// The surface of one orientation inside a cell.
struct Orientation {
    glm::vec3 centroid; ///< scene space
    glm::vec3 normal;   ///< area-weighted mean, unit
    float area;         ///< m2
};

inline constexpr float kSameOrientation = 0.6f;      ///< cosine within which pieces share an orientation
inline constexpr std::size_t kMostOrientations = 32; ///< per cell; further ones join the nearest

/// Sorts the pieces of one cell after the other by orientation: each joins the nearest mean normal within 53 degrees,
/// or begins another one.
class CellOrientations {
public:
    explicit CellOrientations(glm::vec3 lowest) : lowest_(lowest) {} ///< corner of the lattice: sums are relative to it

    /// Number of the orientation that the piece joins, by time of their beginning.
    std::size_t add(const CellPiece& piece, glm::vec3 normal);
    /// Ends the cell: appends its orientations, largest first (of equals the earlier one), and gives their numbers in
    /// that order, valid until the next call.
    std::span<const std::size_t> finish(std::vector<Orientation>& out);

private:
    struct Gathering {
        glm::dvec3 normal{0.0}, moment{0.0}; // area-weighted sums; `moment` of positions relative to `lowest_`
        double area = 0.0;
    };
    std::size_t bestFor(glm::vec3 normal);

    glm::vec3 lowest_;
    std::vector<Gathering> open_;
    std::vector<std::size_t> order_;
};

} // namespace lightloom
