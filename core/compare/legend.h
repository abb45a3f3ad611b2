// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/image.h"
#include "core/compare/image_error.h"

/// False colour for errors, with a legend in the picture.
namespace lightloom {

/// Colour of `t` in [0,1] (clamped; NaN counts as 1), linear Rec.709: dark indigo over rose to pale yellow. Equal steps
/// of t are equal steps in CIELAB, lightness rises all the way: readable in grey and with any colour blindness.
[[nodiscard]] glm::vec3 falseColour(float t);

/// Smallest of 1, 2, 5 x 10^k that holds all but the largest half percent of the values; .01 if they are all 0.
[[nodiscard]] float legendTop(const ScalarImage& map);

enum class LegendUnit { percent, plain };

/// The map in false colour from 0 to `top`, below it a bar with ticks and numbers. As wide as the map, but at least
/// 240 pixels; kLegendHeight pixels higher.
[[nodiscard]] ByteImage heatmap(const ScalarImage& map, float top, LegendUnit unit);
inline constexpr int kLegendHeight = 48;

} // namespace lightloom
