// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/image.h"
#include "core/compare/false_colour.h"
#include "core/compare/image_error.h"
#include <string>

/// Heatmaps as pictures with their legend in them.
namespace lightloom {

/// What the numbers of a legend are in. Percent: values are fractions.
enum class LegendUnit { plain, percent, lux, candelaPerM2 };

/// "12.5%", "40 lx", "40 cd/m2", "0.5"; with `withSign` a + in front of what is above 0.
[[nodiscard]] std::string legendText(float value, LegendUnit unit, bool withSign = false);

/// Smallest of 1, 2, 5 x 10^k that holds the size of all but the largest half percent of the values; .01 if they are
/// all 0.
[[nodiscard]] float legendTop(const ScalarImage& map);

struct HeatmapStyle {
    ErrorKind kind = ErrorKind::relative;
    float top = 1.0f; ///< end of the legend, above 0; differences run from -top to top
    LegendUnit unit = LegendUnit::percent;
    std::string caption; ///< what the numbers are; small letters (core/compare/tiny_font), 38 fit the least width
    int decades = 0;     ///< above 0: of amounts, logarithmic over so many powers of ten below `top`
    [[nodiscard]] float valueAt(float part) const; ///< of the bar, from 0 at its left
    [[nodiscard]] glm::vec3 colourOf(float value) const;
};

/// The map in false colour, below it a bar with ticks, numbers and the caption. As wide as the map, but at least 240
/// pixels; kLegendHeight pixels higher.
[[nodiscard]] ByteImage heatmap(const ScalarImage& map, const HeatmapStyle& style);
inline constexpr int kLegendHeight = 60;

} // namespace lightloom
