// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lightloom {

/// Photons near a point as keys: bits of the squared distance above, number below, so that one comparison of integers
/// orders by both and no two are equal.
[[nodiscard]] inline float squaredOf(std::uint64_t key)
{
    return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32));
}

/// The `k`-th least of `count` keys, k from 1 to count. Takes a few passes of counting where distances lie as on a
/// surface, evenly in their squares; never more than a selection. `work` is memory kept between calls.
[[nodiscard]] std::uint64_t leastKey(const std::uint64_t* keys, std::size_t count, std::size_t k,
                                     std::vector<std::uint64_t>& work);

/// Keeps the keys up to `most`, in their order. Returns how many.
std::size_t keepUpTo(std::uint64_t most, std::uint64_t* keys, std::size_t count);

/// Puts the keys up to `most` first, then the others, both in their order. `work` is memory kept between calls.
void partAt(std::uint64_t most, std::uint64_t* keys, std::size_t count, std::vector<std::uint64_t>& work);

} // namespace lightloom
