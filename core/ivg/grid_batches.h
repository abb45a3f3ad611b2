// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>

/// In which batches blocks of photons are traced and summed. Part of a result's definition: sums of a batch are in
/// float, those of all in double. Small ones first, so that light shows soon.
namespace lightloom {

inline constexpr std::uint64_t kFirstGridBatch = 16, kGridBatch = 128; ///< blocks

/// Where the batch that begins with block `first` ends, of `all` blocks.
[[nodiscard]] inline std::uint64_t gridBatchEnd(std::uint64_t first, std::uint64_t all)
{
    const std::uint64_t size = std::clamp(first, kFirstGridBatch, kGridBatch); // doubles what there is
    return std::min(all, first + size);
}

/// Blocks in the largest batch.
[[nodiscard]] inline std::uint64_t largestGridBatch(std::uint64_t all)
{
    std::uint64_t largest = 0;
    for (std::uint64_t first = 0; first < all && largest < kGridBatch; first = gridBatchEnd(first, all))
        largest = std::max(largest, gridBatchEnd(first, all) - first);
    return largest;
}

/// Whether light is worth a look after so many blocks: twice as many as the last time.
[[nodiscard]] inline bool isGridMilestone(std::uint64_t blocks)
{
    return blocks >= kFirstGridBatch && std::has_single_bit(blocks);
}

} // namespace lightloom
