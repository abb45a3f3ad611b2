// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include <array>

namespace lightloom {

/// Entry of a leaf whose normal is nearest `n`, or -1 where none is compatible.
[[nodiscard]] std::int64_t entryFor(const OctreeGeometry& geometry, std::int64_t leaf, glm::vec3 n);

/// The same for a place, in cells from the leaf's middle: an entry on its side of a wall, if there is one.
struct EntryThere {
    std::int64_t entry = -1;
    bool isBeyond = true; ///< the entry's wall
};
[[nodiscard]] EntryThere entryFor(const OctreeGeometry& geometry, std::int64_t leaf, glm::vec3 n, glm::vec3 fromMiddle);

/// The cells whose centres lie around a point, and their trilinear weights; none where the point is far off (or NaN).
struct Corners {
    std::array<glm::ivec3, 8> cells{};
    std::array<float, 8> weights{}; ///< positive
    int count = 0;
    glm::vec3 at{0.0f}; ///< the point, in cells: less the number of a cell, from that cell's middle
};
[[nodiscard]] Corners cornersAround(const OctreeGeometry& lattice, glm::vec3 p);

/// Entries that answer around a point, and their weights as they are, not renormalised.
struct Answers {
    std::array<std::size_t, 8> entries{};
    std::array<float, 8> weights{};
    int count = 0;
    float sum = 0.0f;   ///< of the weights; 0: nothing answers
    float above = 0.0f; ///< weight of the cells that are not split: the level above answers for them

    template<class ValueOf>
    [[nodiscard]] auto mean(const ValueOf& valueOf) const
    {
        auto total = weights[0] * valueOf(entries[0]);
        for (int i = 1; i < count; ++i) {
            const auto j = static_cast<std::size_t>(i);
            total += weights[j] * valueOf(entries[j]);
        }
        return total;
    }
};
[[nodiscard]] Answers answersAround(const OctreeGeometry& geometry, glm::vec3 p, glm::vec3 n);
/// Of level `level` of a lamp's detail below `base`.
[[nodiscard]] Answers answersAround(const OctreeGeometry& base, const LampDetail& detail, std::size_t level,
                                    glm::vec3 p, glm::vec3 n);

/// `coarse` is what the octree's own depth gives at `p`; goes through the levels below. valueOf(layer, entry).
template<class Value, class ValueOf>
[[nodiscard]] Value refined(Value coarse, const OctreeGeometry& base, const LampDetail& detail, glm::vec3 p,
                            glm::vec3 n, const ValueOf& valueOf)
{
    for (std::size_t level = 0; level < detail.size(); ++level) {
        const Answers finer = answersAround(base, detail, level, p, n);
        if (!(finer.sum > 0.0f)) break;
        const VdlLayer& layer = *detail[level].layer;
        const Value sum = finer.mean([&](std::size_t entry) { return valueOf(layer, entry); });
        coarse = (sum + finer.above * coarse) / (finer.sum + finer.above);
    }
    return coarse;
}

} // namespace lightloom
