// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/voxel_lines.h"

/// What a walk along lines of one direction finds out about the slots of a slice before it goes through them, eight at
/// once (line_partners.h).
namespace lightloom {

inline constexpr float kAlongSurface = 1e-4f; ///< cosine below which a line neither meets a surface nor leaves it
/// A line may pass beside surface of curvature c that is less than its own cross-section deep: cosine^2 < 2 c depth,
/// in cells. A cross-section is 1 to 1.4 cells across.
inline constexpr float kSkimDepth = 2.5f;
inline constexpr float kAboutPlane = 1.5f;                      ///< cells: so near to a plane a line is about it
inline constexpr float kFurthest = 2047.0f;                     ///< slices: no line goes on for so many
inline constexpr int kPlaceBits = 13, kWhole = 1 << kPlaceBits; ///< parts of a line's cross-section
inline constexpr float kMostShare = 2.0f * kWhole;              ///< of it that one slot counts as

/// Finaliser of MurmurHash3: every bit reaches every other.
template<class Bits>
[[gnu::always_inline]] inline void mix(Bits& x)
{
    x = (x ^ (x >> 16)) * 0x85EBCA6Bu;
    x = (x ^ (x >> 13)) * 0xC2B2AE35u;
    x = x ^ (x >> 16);
}

/// Uniform in [0, 1).
[[nodiscard]] inline float drawn(std::uint32_t key, std::uint32_t voxel)
{
    std::uint32_t bits = key ^ voxel;
    mix(bits);
    return static_cast<float>(static_cast<std::int32_t>(bits >> 8)) * 0x1p-24f;
}

/// A place in a line's cross-section, uniform in [0, kWhole).
[[nodiscard]] inline int placeIn(std::uint32_t key, std::uint32_t line)
{
    std::uint32_t bits = key ^ line;
    mix(bits);
    return static_cast<int>(bits >> (32 - kPlaceBits));
}

/// What the walk does with a voxel of one entry, in the lowest bits; above them, where surface is bent, what it covers
/// of its line's cross-section, and the place that is drawn there.
enum SlotKind : std::int32_t { kAlong = 0, kForth = 1, kBack = 2, kSkims = 4 };
inline constexpr int kShareBit = 3, kPlaceBit = 18, kShareBits = (1 << (kPlaceBit - kShareBit)) - 1;

/// Of the slots from the first of a slice on.
struct SliceSlots {
    const float *x, *y, *z, *area, *bend, *bendX, *bendY, *bendZ;
    const std::uint32_t* uv;
};
struct SliceWalk {
    glm::vec3 along;
    std::uint32_t width, offset; ///< of LineNumbers
    std::uint32_t key;           ///< of what is drawn
    float planeSlices;           ///< kAboutPlane in slices
    float wholePerArea;          ///< per m2
};
struct PreparedSlots {
    float* cosines;         ///< between normal and line
    std::uint32_t* numbers; ///< of lines
    std::int32_t* kinds;    ///< SlotKind
    std::int32_t* reaches;  ///< slices until a line has left the plane behind
};

/// For `count` slots, in eights: some more are overwritten.
void prepareSlots(const SliceSlots& s, std::size_t count, const SliceWalk& walk, const PreparedSlots& out);

/// Marks slots [first, end) where surface bends away from the line, and all of them with what they cover of the line's
/// cross-section and a place in it, both in kWhole. In eights: some before and after are marked too.
void markSkimmed(const SliceSlots& s, std::size_t first, std::size_t end, const SliceWalk& walk,
                 const PreparedSlots& out);

/// partners[entries[i]] = entries[ends[i]] for `count` slots.
void toEntries(const std::uint32_t* entries, const std::uint32_t* ends, std::size_t count, std::uint32_t* partners);

} // namespace lightloom
