// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/params/grid_choices.h"
#include <array>
#include <glm/glm.hpp>
#include <span>

/// Irradiance vectors and what follows from them for a surface (RR-6983, sections 3.2 and 4.1; docs/methods).
namespace lightloom {

/// I_delta, the integral of L w over the hemisphere around delta, w pointing to where the light comes from, for delta =
/// -x +x -y +y -z +z; columns R, G, B; lux.
using IrradianceVectors = std::array<glm::mat3, 6>;
/// Index of the vector on the side of `axis` that `n` faces.
[[nodiscard]] inline std::size_t sideOf(int axis, const glm::vec3& n)
{
    return static_cast<std::size_t>(2 * axis + (n[axis] < 0.0f ? 0 : 1));
}

/// Numbers kept per vertex and channel for a remap.
[[nodiscard]] constexpr std::size_t remapSize(GridRemap remap)
{
    return remap == GridRemap::harmonic ? 9 : remap == GridRemap::flux ? 6 : 18;
}

/// What a remap keeps of six vectors: remapSize vec3, RGB each. All of them are linear in the vectors, so that weighted
/// sums may be taken before or after. harmonic: coefficients of 1, x, y, z, xy, yz, zx, x2 - y2, 3 z2 - 1 of the
/// irradiance as a function of the normal. flux: I_delta . delta. paper: the vectors, direction by direction, x y z.
void keepForRemap(GridRemap remap, const IrradianceVectors& vectors, std::span<glm::vec3> kept);

/// Irradiance (lux per channel, may be below 0 for harmonics) on a surface that faces `n` (unit), from second-order
/// harmonics that `keepForRemap` made.
[[nodiscard]] glm::vec3 harmonicIrradiance(std::span<const glm::vec3> kept, const glm::vec3& n);
/// The part of one axis in the other two remaps: n_a^2 (I . delta) or, as printed, n_a^2 (I . n). They add up over
/// axes.
[[nodiscard]] glm::vec3 axisIrradiance(GridRemap remap, int axis, std::span<const glm::vec3> kept, const glm::vec3& n);
/// All of it, by any remap.
[[nodiscard]] glm::vec3 remapIrradiance(GridRemap remap, std::span<const glm::vec3> kept, const glm::vec3& n);

} // namespace lightloom
