// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/bake_file.h"

namespace lightloom {

/// An irradiance grid under its mix as a plain OpenVDB file for other programs, in the scene file's frame, metres.
/// Voxels lie around vertices; names end in _minus_x, _plus_x, ... _plus_z for the direction delta. Grids:
///   valid                     1 for vertices in the open, 0 behind walls (float); every vertex of the grid is active
/// and with the valid vertices active alone, dark ones too:
///   irradiance_vector_<r|g|b>_<delta>   I_delta of that channel, the integral of L w over the hemisphere around delta,
///   lux irradiance_<delta>        lux per channel on a surface that faces delta open                      open share
///   of the face around the vertex, by axis, 0 to 1
/// and the same with inside_ before their names, of a finer grid inside.
/// The file says method, parameters, scene and unit in its metadata. The same grid gives the same bytes.
[[nodiscard]] Result<std::vector<std::uint8_t>> gridVolume(const IrradianceGrid& grid, const BakeInfo& info,
                                                           const Scene& scene);

} // namespace lightloom
