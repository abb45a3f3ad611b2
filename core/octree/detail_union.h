// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"

namespace lightloom {

/// One level below an octree's depth: the leaves that any lamp has there, and which of them are whose.
struct UnionLevel {
    OctreeGeometry geometry;
    std::vector<std::vector<std::int32_t>> own; ///< by layer: the number in its own level of each entry, -1 where the
                                                ///< lamp's leaf is not split; empty: nowhere
};

/// All lamps' deeper leaves, as pixels and files for other programs see them; what a leaf holds depends on its cell
/// alone. `details` by layer.
[[nodiscard]] std::vector<UnionLevel> uniteDetails(const OctreeGeometry& base,
                                                   const std::vector<std::shared_ptr<const LampDetail>>& details);

} // namespace lightloom
