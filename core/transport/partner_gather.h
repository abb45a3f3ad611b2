// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/wide_vectors.h"
#include "core/transport/partner_table.h"

namespace lightloom {

/// Values of a few channels by row, in lines of `width` times four; one more line at the end is always 0: what an
/// entry without a partner sees. Of at most kMostWidth: a cache line.
struct ChannelLines {
    static constexpr std::size_t kMostWidth = 4;
    struct alignas(16) Four {
        float values[4];
    };
    std::size_t width = 1;
    std::vector<Four> fours; ///< of row r: [r * width, (r + 1) * width)

    ChannelLines(std::size_t rows, std::size_t channels) : width((channels + 3) / 4), fours((rows + 1) * width, Four{})
    {
    }
    [[nodiscard]] float* line(std::size_t row) { return fours[row * width].values; }
    [[nodiscard]] const float* line(std::size_t row) const { return fours[row * width].values; }
};

/// The directions of a block by component; 0 beyond those that count.
struct BlockDirections {
    alignas(64) float x[PartnerBlock::kDirections] = {}, y[PartnerBlock::kDirections] = {},
                      z[PartnerBlock::kDirections] = {};
    BlockDirections(std::span<const LineDirection> set, std::size_t block);
};

/// Adds what rows [first, end) see along the directions of blocks, one after the other: the partners' values times the
/// entry's cosine to `sums`, the cosines themselves to `cosines`, all by row. The same bits whatever blocks come
/// together. O(rows x directions).
void gatherRows(std::span<const PartnerBlock* const> blocks, std::span<const BlockDirections> directions,
                std::span<const Orientation> rows, std::size_t first, std::size_t end, const ChannelLines& values,
                ChannelLines& sums, std::vector<float>& cosines);

} // namespace lightloom
