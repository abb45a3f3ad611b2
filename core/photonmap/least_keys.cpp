// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/least_keys.h"
#include "core/base/wide_vectors.h"
#include <algorithm>

namespace lightloom {
namespace {

constexpr std::size_t kFew = 16; ///< keys that are ranked without more counting
constexpr int kPasses = 8;       ///< of counting; distances may be all the same

constexpr std::uint64_t kBeyond = ~std::uint64_t(0) >> 1; ///< greater than all keys: signs of distances are clear

using Longs4 = std::int64_t __attribute__((vector_size(32)));

LIGHTLOOM_WIDE_VECTORS std::size_t countUpTo(std::uint64_t most, const std::uint64_t* keys, std::size_t count)
{
    const auto limit = static_cast<std::int64_t>(most);
    Longs4 above{};
    std::size_t i = 0;
    for (; i + 4 <= count; i += 4) above += lanesOf<Longs4>(keys, i / 4) > limit;
    std::int64_t more = -(above[0] + above[1] + above[2] + above[3]);
    for (; i < count; ++i) more += keys[i] > most ? 1 : 0;
    return count - static_cast<std::size_t>(more);
}

/// The key with `rank` lesser ones among kFew.
LIGHTLOOM_WIDE_VECTORS std::uint64_t ranked(const std::uint64_t* keys, std::int64_t rank)
{
    std::uint64_t found = 0;
    for (std::size_t i = 0; i < kFew; ++i) {
        const auto key = static_cast<std::int64_t>(keys[i]);
        Longs4 less{};
        for (std::size_t g = 0; g < kFew / 4; ++g) less -= lanesOf<Longs4>(keys, g) < key;
        if ((less[0] + less[1]) + (less[2] + less[3]) == rank) found = keys[i];
    }
    return found;
}

std::uint64_t largest(const std::uint64_t* keys, std::size_t count)
{
    std::uint64_t a = 0, b = 0, c = 0, d = 0;
    std::size_t i = 0;
    for (; i + 4 <= count; i += 4) {
        a = std::max(a, keys[i]), b = std::max(b, keys[i + 1]);
        c = std::max(c, keys[i + 2]), d = std::max(d, keys[i + 3]);
    }
    for (; i < count; ++i) a = std::max(a, keys[i]);
    return std::max(std::max(a, b), std::max(c, d));
}

/// All keys up to a distance come before this one or are it.
std::uint64_t lastKeyAt(float squared) { return std::uint64_t(std::bit_cast<std::uint32_t>(squared)) << 32 | ~0u; }

} // namespace

std::uint64_t leastKey(const std::uint64_t* keys, std::size_t count, std::size_t k, std::vector<std::uint64_t>& work)
{
    std::uint64_t low = 0, high = largest(keys, count); // the key lies between, ends included
    std::size_t below = 0, upTo = count;                // keys under `low`, and up to `high`
    for (int pass = 0; pass < kPasses && upTo - below > kFew; ++pass) {
        // aim beside the place, now above, now below, so that both ends close in
        const double aside = pass % 2 == 0 ? kFew / 4.0 : -(kFew / 4.0);
        const double share = (static_cast<double>(k - below) + aside) / static_cast<double>(upTo - below);
        const auto from = static_cast<double>(squaredOf(low)), to = static_cast<double>(squaredOf(high));
        const std::uint64_t at = lastKeyAt(static_cast<float>(from + std::clamp(share, 0.0, 1.0) * (to - from)));
        if (at >= high || at < low) continue;
        const std::size_t counted = countUpTo(at, keys, count);
        if (counted >= k)
            high = at, upTo = counted;
        else
            low = at + 1, below = counted;
    }
    work.resize(std::max(work.size(), std::max(upTo - below, kFew) + 1)); // one to write to that is not kept
    std::uint64_t* const between = work.data();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t key = keys[i];
        between[kept] = key;
        kept += key - low <= high - low ? 1 : 0;
    }
    if (kept <= kFew) {
        std::fill_n(between + kept, kFew - kept, kBeyond);
        return ranked(between, static_cast<std::int64_t>(k - below) - 1);
    }
    std::nth_element(between, between + (k - below) - 1, between + kept);
    return between[k - below - 1];
}

std::size_t keepUpTo(std::uint64_t most, std::uint64_t* keys, std::size_t count)
{
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t key = keys[i];
        keys[kept] = key;
        kept += key <= most ? 1 : 0;
    }
    return kept;
}

void partAt(std::uint64_t most, std::uint64_t* keys, std::size_t count, std::vector<std::uint64_t>& work)
{
    work.resize(std::max(work.size(), count));
    std::size_t near = 0, far = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t key = keys[i];
        const std::size_t isNear = key <= most ? 1 : 0;
        keys[near] = work[far] = key;
        near += isNear, far += 1 - isNear;
    }
    std::copy_n(work.begin(), far, keys + near);
}

} // namespace lightloom
