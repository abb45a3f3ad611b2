// SPDX-License-Identifier: Apache-2.0
#include "core/transport/chain_slots.h"
#include "core/base/wide_vectors.h"
#include "core/transport/line_slots.h"
#include <algorithm>

namespace lightloom {
namespace {

using Unsigned8 = std::uint32_t __attribute__((vector_size(32)));
constexpr std::size_t kChunk = 128;   ///< slots whose lines are read, then computed with, then written
constexpr std::int32_t kSameWall = 2; ///< slices

} // namespace

LIGHTLOOM_EIGHT_WIDE_VECTORS void walkChains(const ChainSlots& s, std::size_t first, std::size_t end,
                                             const ChainWalk& walk)
{
    alignas(32) std::uint32_t numbers[kChunk];
    alignas(32) ChainLine met[kChunk]; // what is read and written of lines, in one piece
    alignas(32) std::int32_t ended[kChunk];
    const Ints8 lanes{0, 1, 2, 3, 4, 5, 6, 7};
    const Ints8 kEven{0, 2, 4, 6, 8, 10, 12, 14}, kOdd{1, 3, 5, 7, 9, 11, 13, 15}, kLow{0, 8, 1, 9, 2, 10, 3, 11},
        kHigh{4, 12, 5, 13, 6, 14, 7, 15};
    const std::int32_t recent = kNoneWaits + walk.slice;
    for (; first < end; first += kChunk) {
        const std::size_t count = std::min(kChunk, end - first), eights = (count + kLanes - 1) / kLanes;
        for (std::size_t i = 0; i < eights; ++i) {
            const Unsigned8 uv = lanesOf<Unsigned8>(s.uv + first, i);
            lanesOf<Unsigned8>(numbers, i) = (uv & 0xFFFFu) * walk.width + (uv >> 16) + walk.offset;
        }
        for (std::size_t i = 0; i < count; ++i) met[i] = s.lines[numbers[i]];
        for (std::size_t i = 0; i < eights; ++i) {
            const Floats8 cosine = lanesOf<Floats8>(s.x + first, i) * walk.along.x +
                                   lanesOf<Floats8>(s.y + first, i) * walk.along.y +
                                   lanesOf<Floats8>(s.z + first, i) * walk.along.z;
            const Ints8 isForth = cosine > kAlongSurface, isBack = cosine < -kAlongSurface;
            const Ints8 slot = lanes + static_cast<std::int32_t>(first + i * kLanes);
            Ints8 &low = lanesOf<Ints8>(met, 2 * i), &high = lanesOf<Ints8>(met, 2 * i + 1);
            const Ints8 who = __builtin_shuffle(low, high, kEven), was = __builtin_shuffle(low, high, kOdd);
            const Ints8 entry = lanesOf<Ints8>(s.entry + first, i);
            const Ints8 isWaiting = was >= 0;
            const Ints8 head = isWaiting ? was : slot, emitter = who | (was < recent);
            lanesOf<Ints8>(s.ends + first, i) = Ints8{} - 1;
            lanesOf<Ints8>(ended, i) = isBack & isWaiting ? was : Ints8{} + walk.unused;
            lanesOf<Ints8>(s.found + first, i) = isForth ? head + kNoneWaits : emitter | ~isBack;
            const Ints8 seen = isForth ? entry : isBack ? emitter : who;
            const Ints8 state = isForth ? head : isBack ? Ints8{} + (recent + kSameWall) : was;
            low = __builtin_shuffle(seen, state, kLow), high = __builtin_shuffle(seen, state, kHigh);
        }
        for (std::size_t i = 0; i < count; ++i) {
            s.lines[numbers[i]] = met[i];
            s.ends[ended[i]] = s.entry[first + i];
        }
    }
}

LIGHTLOOM_EIGHT_WIDE_VECTORS void chainsToEntries(const ChainSlots& s, std::size_t count, std::uint32_t* partners)
{
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t found = s.found[i];
        const bool isForth = found < -1;
        const std::int32_t end = s.ends[isForth ? found - kNoneWaits : 0];
        partners[s.entry[i]] = static_cast<std::uint32_t>(isForth ? end : found);
    }
}

} // namespace lightloom
