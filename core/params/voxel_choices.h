// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string_view>

namespace lightloom {

/// How light on a place follows from lit voxels (docs/methods/voxel-lightcuts.md): a cut through the tree of all of
/// them with rays for what is near, voxels drawn at random with a ray to each, or the voxels around it.
enum class VoxelLookup { lightcuts, samples, field };
/// Whom an entry sees along a discrete line: by all rules of docs/methods/voxel-lightcuts.md, by what surface covers of
/// the line; or by the papers' chain rule alone, over one mean normal a voxel.
enum class VoxelLines { covered, paper };
/// How bounces follow each other: each from what the one before has left, with half of its directions; or in sixteen
/// parts of the surface in turn, each from what the others have by then (Gauss-Seidel).
enum class VoxelBounces { halving, gaussSeidel };
/// What is averaged over neighbouring entries that face alike: nothing, the lamps' own light, what bounces bring, both.
enum class VoxelSmooth { off, first, bounced, both };

inline constexpr std::array<std::string_view, 3> kVoxelLookupNames{"lightcuts", "samples", "field"};
inline constexpr std::array<std::string_view, 2> kVoxelLinesNames{"covered", "paper"};
inline constexpr std::array<std::string_view, 2> kVoxelBouncesNames{"halving", "gauss-seidel"};
inline constexpr std::array<std::string_view, 4> kVoxelSmoothNames{"off", "first", "bounced", "both"};

} // namespace lightloom
