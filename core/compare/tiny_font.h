// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

/// Letters for pictures that core writes without a display: 5 x 7 pixels, six from one to the next.
namespace lightloom {

inline constexpr int kGlyphWidth = 5, kGlyphHeight = 7, kGlyphAdvance = 6;

/// Rows from the top, bit 4 is the left pixel. Digits, small letters and `. , % - + / ( ) =`; anything else is blank.
[[nodiscard]] const std::array<std::uint8_t, kGlyphHeight>& glyph(char character);

} // namespace lightloom
