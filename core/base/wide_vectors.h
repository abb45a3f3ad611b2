// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <type_traits>

/// Before a function: it is compiled for several widths of vectors, and the machine's own is picked when the program is
/// loaded. Not under ThreadSanitizer, which is not ready yet when the pick is made. `EIGHT`: up to eight numbers at
/// once, where single ones have to be picked out of registers, which costs more in wider ones: walks along lines take 4
/// % longer in sixteen, sums over partners a third.
#ifdef __SANITIZE_THREAD__
#define LIGHTLOOM_WIDE_VECTORS
#define LIGHTLOOM_EIGHT_WIDE_VECTORS
#else
#define LIGHTLOOM_WIDE_VECTORS __attribute__((target_clones("avx512f", "avx2", "default")))
#define LIGHTLOOM_EIGHT_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#endif

namespace lightloom {

/// Four numbers that are computed with at once, on every machine.
using Floats4 = float __attribute__((vector_size(16)));
using Ints4 = std::int32_t __attribute__((vector_size(16)));

/// Eight numbers that are computed with at once: one register where the machine has AVX2, several elsewhere, with the
/// same bits. Within functions marked as above only: how they are handed over depends on the machine.
using Floats8 = float __attribute__((vector_size(32)));
using Ints8 = std::int32_t __attribute__((vector_size(32)));
inline constexpr std::size_t kLanes = 8;

/// Number `block` of the groups in an array, of as many as `Lanes` holds.
template<class Lanes, class Element>
[[gnu::always_inline]] inline auto& lanesOf(Element* values, std::size_t block)
{
    typedef Lanes AnyPlace __attribute__((aligned(alignof(Element)), may_alias));
    if constexpr (std::is_const_v<Element>)
        return reinterpret_cast<const AnyPlace*>(values)[block];
    else
        return reinterpret_cast<AnyPlace*>(values)[block];
}

} // namespace lightloom
