// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/ivg/grid_surface.h"
#include "core/ivg/irradiance_grid.h"

namespace lightloom {

inline constexpr double kFitBytesPerPatch = 200.0; ///< while it is made

/// What is to be added to I_delta . delta, by vertex and direction, so that lookups on surface agree better with what
/// lands there: the mean of what is missing on the patches that read the vertex in this direction, weighed by how much
/// they do, and by area. One step of a least-squares fit by simultaneous corrections (SIRT; Gilbert 1972): linear in
/// the light, and with less noise than before, since photons that land join those that pass.
///
/// `grid` has one light group, without a fit; `illuminance` by patch of `surface`. No value falls below a quarter of
/// what it was or rises above four times: patches whose area is known badly, at the foot of things, do no harm.
[[nodiscard]] std::vector<std::array<glm::vec3, 6>> fitToSurface(const IrradianceGrid& grid, const GridSurface& surface,
                                                                 std::span<const glm::vec3> illuminance,
                                                                 Workers& workers);

} // namespace lightloom
