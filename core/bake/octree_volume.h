// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/bake_file.h"

namespace lightloom {

/// A light octree under its mix as a plain OpenVDB file for other programs, in the scene file's frame, metres. Voxels
/// are the leaves; every leaf is active, dark ones too. Grids:
///   irradiance            lux per channel on the leaf's own surface, mean over its orientations by area
///   illuminance           luminance of that, lux (float)
///   area                  m2 of surface in the leaf (float)
///   normal                of the largest orientation
///   vdl<j>_colour         lux per channel of its virtual directional light j, on a surface that faces it
///   vdl<j>_direction      unit, towards where that light comes from
/// The file says method, parameters, scene and unit in its metadata. The same octree gives the same bytes.
[[nodiscard]] Result<std::vector<std::uint8_t>> octreeVolume(const LightOctree& octree, const BakeInfo& info,
                                                             const Scene& scene);

} // namespace lightloom
