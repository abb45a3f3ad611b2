// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/field/indirect_field.h"
#include "core/ivg/grid_lattice.h"
#include <memory>
#include <vector>

namespace lightloom {

class IrradianceGrid;

/// What vertices of a grid are coloured by over the picture.
enum class VertexMarks { none, openness, noise };

inline constexpr float kMostVertexNoise = 0.1f; ///< of a vertex's light: where the colours end

/// Vertices of a grid, and of the finer one inside, as dots. Never changed once made.
struct GridVertices {
    struct Lattice {
        GridLattice lattice;
        std::vector<glm::u8vec4> colours; ///< by vertex, as shown; A: how much of it is seen, 0: nothing
    };
    std::vector<Lattice> lattices;
};

/// `openness`: green in the open, yellow where walls leave part of its faces, orange where a face is left out, red
/// behind walls; those that no wall is near are faint. `noise`: standard error of the light that comes to a vertex from
/// all sides under `mix`, of that light, as false colour from 0 to kMostVertexNoise; vertices behind walls are not
/// shown. Outer vertices that the finer grid stands in for are left out. Null for `none`.
[[nodiscard]] std::shared_ptr<const GridVertices> gridVertices(const IrradianceGrid& grid, const Mix& mix,
                                                               VertexMarks marks);

} // namespace lightloom
