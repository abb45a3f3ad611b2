// SPDX-License-Identifier: Apache-2.0
#include "core/transport/line_slots.h"
#include "core/base/wide_vectors.h"

namespace lightloom {
namespace {

using Unsigned8 = std::uint32_t __attribute__((vector_size(32)));

} // namespace

LIGHTLOOM_EIGHT_WIDE_VECTORS void prepareSlots(const SliceSlots& s, std::size_t count, const SliceWalk& walk,
                                               const PreparedSlots& out)
{
    for (std::size_t i = 0; i < (count + kLanes - 1) / kLanes; ++i) {
        const Floats8 cosine = lanesOf<Floats8>(s.x, i) * walk.along.x + lanesOf<Floats8>(s.y, i) * walk.along.y +
                               lanesOf<Floats8>(s.z, i) * walk.along.z;
        const Floats8 size = cosine < 0.0f ? -cosine : cosine;
        lanesOf<Floats8>(out.cosines, i) = cosine;
        const Unsigned8 uv = lanesOf<Unsigned8>(s.uv, i);
        lanesOf<Unsigned8>(out.numbers, i) = (uv & 0xFFFFu) * walk.width + (uv >> 16) + walk.offset;
        const Ints8 isForth = cosine > kAlongSurface, isBack = cosine < -kAlongSurface;
        lanesOf<Ints8>(out.kinds, i) = (isForth & std::int32_t(kForth)) | (isBack & std::int32_t(kBack));
        const Floats8 reach = walk.planeSlices / size;
        lanesOf<Ints8>(out.reaches, i) =
            __builtin_convertvector(reach < kFurthest ? reach : kFurthest + Floats8{}, Ints8);
    }
}

LIGHTLOOM_EIGHT_WIDE_VECTORS void markSkimmed(const SliceSlots& s, std::size_t first, std::size_t end,
                                              const SliceWalk& walk, const PreparedSlots& out)
{
    for (std::size_t i = first / kLanes; i < (end + kLanes - 1) / kLanes; ++i) {
        const Floats8 most = lanesOf<Floats8>(s.bendX, i) * walk.along.x + lanesOf<Floats8>(s.bendY, i) * walk.along.y +
                             lanesOf<Floats8>(s.bendZ, i) * walk.along.z;
        const Floats8 cosine = lanesOf<Floats8>(out.cosines, i), squared = cosine * cosine;
        const Ints8 isSkimmed = squared < kSkimDepth * (lanesOf<Floats8>(s.bend, i) + most * most);
        const Floats8 shown = lanesOf<Floats8>(s.area, i) * (cosine < 0.0f ? -cosine : cosine) * walk.wholePerArea;
        const Ints8 share = __builtin_convertvector(shown < kMostShare ? shown : kMostShare + Floats8{}, Ints8);
        Unsigned8 bits = lanesOf<Unsigned8>(out.numbers, i) ^ walk.key;
        mix(bits);
        const Ints8 place = reinterpret_cast<Ints8>(bits >> (32 - kPlaceBits));
        lanesOf<Ints8>(out.kinds, i) |= (isSkimmed & std::int32_t(kSkims)) | share << kShareBit | place << kPlaceBit;
    }
}

LIGHTLOOM_EIGHT_WIDE_VECTORS void toEntries(const std::uint32_t* entries, const std::uint32_t* ends, std::size_t count,
                                            std::uint32_t* partners)
{
    for (std::size_t i = 0; i < count; ++i) partners[entries[i]] = entries[ends[i]];
}

} // namespace lightloom
