// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/bake_file.h"

namespace lightloom {

/// A voxel field under its mix as a plain OpenVDB file for other programs, in the scene file's frame, metres; every
/// surface voxel is active, dark ones too. Grids, means over the voxel's orientations by area:
///   irradiance            indirect lux per channel
///   irradiance_direct     lux per channel straight from the lamps
///   illuminance           luminance of both, lux (float)
///   radiosity             lm/m2 per channel that the surface sends on of both
///   albedo                share that it sends on, per channel
///   area                  m2 of surface in the voxel (float)
///   normal                of the largest orientation
[[nodiscard]] Result<std::vector<std::uint8_t>> voxelVolume(const VoxelField& field, const BakeInfo& info,
                                                            const Scene& scene);

} // namespace lightloom
