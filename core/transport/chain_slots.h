// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

/// The inner loops of ChainPartners: over slots of a slice, which lie on a line each of their own, so that eight and
/// more are computed with at once and no branch depends on what they are.
namespace lightloom {

/// What a line has met so far, read and written in one piece. Its lower half: the entry that the next one facing back
/// sees, -1 for none. Its upper half: the slot whose end is that of all that wait; or, below 0 where none waits,
/// kNoneWaits + the last slice in which an entry that faces back still sees that of the lower half.
using ChainLine = std::uint64_t;
inline constexpr std::int32_t kNoneWaits = INT32_MIN;
inline constexpr ChainLine kNewLine = 0x8000'0000'FFFF'FFFFu;

struct ChainSlots {
    const float *x, *y, *z;  ///< normals
    const std::uint32_t* uv; ///< as in WalkOrder
    const std::int32_t* entry;
    /// Of one that faces back or nowhere its partner, -1 for none; of one that faces forth kNoneWaits + a slot,
    /// whose end is its partner.
    std::int32_t* found;
    std::int32_t* ends; ///< of slots that were the first to wait; -1 for none
    ChainLine* lines;
};
struct ChainWalk {
    glm::vec3 along;
    std::uint32_t width = 0, offset = 0; ///< of LineNumbers
    std::int32_t slice = 0;
    std::int32_t unused = 0; ///< the spare place of ChainSlots::ends
};

/// Goes through slots [first, end), all those of a slice. In eights: some after them are overwritten.
void walkChains(const ChainSlots& slots, std::size_t first, std::size_t end, const ChainWalk& walk);

/// Partners of `count` slots, by entry.
void chainsToEntries(const ChainSlots& slots, std::size_t count, std::uint32_t* partners);

} // namespace lightloom
