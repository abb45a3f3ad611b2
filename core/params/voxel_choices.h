// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string_view>

namespace lightloom {

/// How light on a place follows from lit voxels (docs/methods/voxel-lightcuts.md): a cut through the tree of all of
/// them with rays for what is near, voxels drawn at random with a ray to each, or the voxels around it.
enum class VoxelLookup { lightcuts, samples, field };

inline constexpr std::array<std::string_view, 3> kVoxelLookupNames{"lightcuts", "samples", "field"};

} // namespace lightloom
