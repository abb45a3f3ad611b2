// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/wide_vectors.h"
#include "core/transport/partner_table.h"

namespace lightloom {

/// Values of a few channels by entry, in lines of `width` times four; one more line at the end is always 0: what an
/// entry without a partner sees. Of at most kMostWidth: a cache line.
struct ChannelLines {
    static constexpr std::size_t kMostWidth = 4;
    struct alignas(16) Four {
        float values[4];
    };
    std::size_t width = 1;
    std::vector<Four> fours; ///< of entry e: [e * width, (e + 1) * width)

    ChannelLines(std::size_t entries, std::size_t channels)
        : width((channels + 3) / 4), fours((entries + 1) * width, Four{})
    {
    }
    [[nodiscard]] float* line(std::size_t entry) { return fours[entry * width].values; }
    [[nodiscard]] const float* line(std::size_t entry) const { return fours[entry * width].values; }
};

/// The directions of a block by component; 0 beyond those that count.
struct BlockDirections {
    alignas(64) float x[PartnerBlock::kDirections] = {}, y[PartnerBlock::kDirections] = {},
                      z[PartnerBlock::kDirections] = {};
    BlockDirections(std::span<const LineDirection> set, std::size_t block);
};

/// Adds what entries [first, end) see along a block's directions, one after the other: the partners' values times the
/// entry's cosine to `sums`, the cosines themselves to `cosines` (by entry). O(entries x directions).
void gatherRows(const PartnerBlock& block, const BlockDirections& directions, std::span<const Orientation> entries,
                std::size_t first, std::size_t end, const ChannelLines& values, ChannelLines& sums,
                std::vector<float>& cosines);

} // namespace lightloom
