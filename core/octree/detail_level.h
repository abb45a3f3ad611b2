// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include <cstdint>
#include <stop_token>
#include <vector>

namespace lightloom {

/// A level of deeper leaves while it is being judged: all children of some cells of the level above, of which those
/// stay whose parent is to be split.
struct DetailCandidates {
    std::vector<std::uint64_t> parents; ///< Morton codes, rising
    std::shared_ptr<const OctreeGeometry> geometry;
    std::shared_ptr<VdlLayer> layer;
    std::vector<float> gain; ///< per entry: squared error that the level above is seen to have there, in variances of
                             ///< the entry itself; scatters around 0 where the level above is right
    /// Per entry whose kernel was widened to hold enough photons: photons that lie within the width it should have, and
    /// photons that the widened one lets expect there. Else none.
    struct Few {
        float found = 0.0f, expected = 0.0f;
    };
    std::vector<Few> few;
    std::vector<bool> splits; ///< per parent
    [[nodiscard]] std::size_t parentOf(std::size_t leaf) const;
};

/// Takes light from the entries whose kernels were widened as far as fewer photons than expected are found, there and
/// just around: a kernel of a given number of photons reaches out of a dark gap into the light before it. After a stop
/// the level is not to be used.
void darken(DetailCandidates& level, const std::stop_token& stop);

/// Splits a parent where the mean gain over it and the candidates up to two cells around is worth it: an entry sees a
/// small kernel, and what is blurred is blurred for some cells around.
void judge(DetailCandidates& level, const std::stop_token& stop);

/// What stays of the levels, a parent of a split cell being split as well. Ends with the first level that has no leaf.
[[nodiscard]] LampDetail splitLeaves(std::vector<DetailCandidates>& levels);

} // namespace lightloom
