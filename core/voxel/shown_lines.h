// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/ray_scene.h"
#include "core/transport/voxel_lines.h"

namespace lightloom {

/// Some discrete lines of one direction, and what exchanges light along them: for whoever wants to see how voxels are
/// lit.
struct ShownLines {
    LineDirection direction;
    struct Line {
        glm::vec3 from, to; ///< middles of its first and its last voxel, in the line's own direction; scene space
    };
    /// An entry and the one that it takes light from along the direction, one way or the other.
    struct Pair {
        std::uint32_t entry, partner;
        bool isExact; ///< found by an exact ray, where the line leaves a closed room through a corner
    };
    std::vector<Line> lines;
    std::vector<Pair> pairs;  ///< of all entries on these lines; two that see each other are told once
    std::size_t allLines = 0; ///< that meet voxels
    int every = 1;            ///< each so-manieth line is shown, across both ways
};

/// Lines along direction `number` of the set (directionSet), from 0; about `most` of them, evenly spread. Partners are
/// those that a bake's bounces of more than `number` directions have, by lines as `how` says. O(voxels).
[[nodiscard]] ShownLines shownLines(const RayScene& rays, const SurfaceVoxels& voxels, VoxelLines how, int number,
                                    std::size_t most);

} // namespace lightloom
