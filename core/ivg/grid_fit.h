// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/ivg/grid_surface.h"
#include "core/ivg/irradiance_grid.h"

namespace lightloom {

inline constexpr double kFitBytesPerPatch = 200.0; ///< while it is made

/// By vertex and direction; 0 where no patch reads it.
struct SurfaceFit {
    std::vector<std::array<glm::vec3, 6>> correction; ///< of I_delta . delta, lux per channel
    std::vector<std::array<float, 6>> variance;       ///< of its luminance by what lands, lux^2
    std::vector<std::uint8_t> fitted;                 ///< by vertex: bit d is set where patches read direction d
    [[nodiscard]] bool isFitted(std::size_t vertex, std::size_t d) const { return (fitted[vertex] >> d & 1) != 0; }
};

/// What is to be added to I_delta . delta, by vertex and direction, so that lookups on surface agree better with what
/// lands there: the mean of what is missing on the patches that read the vertex in this direction, weighed by how much
/// they do, and by area. One step of a least-squares fit by simultaneous corrections (SIRT; Gilbert 1972): linear in
/// the light, and with less noise than before, since photons that land join those that pass. Where less than a
/// hundredth of a cell's face of surface reads a direction, less than half of it.
///
/// `grid` has one light group, without a fit; `landed` by patch of `surface` (SurfaceLight). No value falls below a
/// quarter of what it was or rises above four times: patches whose area is known badly, at the foot of things, do no
/// harm.
[[nodiscard]] SurfaceFit fitToSurface(const IrradianceGrid& grid, const GridSurface& surface,
                                      std::span<const LandedLight> landed, Workers& workers);

} // namespace lightloom
