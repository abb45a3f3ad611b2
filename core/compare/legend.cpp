// SPDX-License-Identifier: Apache-2.0
#include "core/compare/legend.h"
#include "core/compare/tiny_font.h"
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace lightloom {
namespace {

constexpr int kLeastWidth = 240, kMargin = 12, kBarTop = 8, kBarHeight = 14, kTickHeight = 4, kGap = 3;
constexpr std::array<std::uint8_t, 3> kPaper{24, 24, 24}, kInk{230, 230, 230};

class Canvas {
public:
    Canvas(int width, int height) : image_{width, height, {}}
    {
        const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        image_.rgb.reserve(pixels * 3);
        for (std::size_t i = 0; i < pixels; ++i) image_.rgb.insert(image_.rgb.end(), kPaper.begin(), kPaper.end());
    }
    void set(int x, int y, std::array<std::uint8_t, 3> colour)
    {
        if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
        const auto at =
            3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x));
        std::ranges::copy(colour, image_.rgb.begin() + static_cast<std::ptrdiff_t>(at));
    }
    /// Around `centre`, but within the picture.
    void text(int centre, int top, std::string_view text)
    {
        const int wide = kGlyphAdvance * static_cast<int>(text.size()) - 1;
        int left = std::clamp(centre - wide / 2, 2, std::max(2, image_.width - 2 - wide));
        for (const char c : text) {
            const auto& rows = glyph(c);
            for (int y = 0; y < kGlyphHeight; ++y) {
                for (int x = 0; x < kGlyphWidth; ++x) {
                    if (rows[static_cast<std::size_t>(y)] >> (kGlyphWidth - 1 - x) & 1) set(left + x, top + y, kInk);
                }
            }
            left += kGlyphAdvance;
        }
    }
    ByteImage take() { return std::move(image_); }

private:
    ByteImage image_;
};

std::array<std::uint8_t, 3> screen(glm::vec3 linear)
{
    const auto byte = [](float v) { return static_cast<std::uint8_t>(std::lround(255.0f * encodeSrgb(v))); };
    return {byte(linear.x), byte(linear.y), byte(linear.z)};
}

void drawLegend(Canvas& canvas, int top, int width, const HeatmapStyle& style)
{
    const int left = kMargin, right = width - 1 - kMargin, length = right - left;
    const bool isSigned = style.kind == ErrorKind::difference;
    for (int x = 0; x <= length; ++x) {
        const auto colour = screen(style.colourOf(style.valueAt(static_cast<float>(x) / static_cast<float>(length))));
        for (int y = 0; y < kBarHeight; ++y) canvas.set(left + x, top + kBarTop + y, colour);
    }
    const int ticksTop = top + kBarTop + kBarHeight, numbersTop = ticksTop + kTickHeight + kGap;
    for (int tick = 0; tick <= 4; ++tick) {
        const int x = left + length * tick / 4;
        for (int y = 0; y < kTickHeight; ++y) canvas.set(x, ticksTop + y, kInk);
        // at both ends with the unit, between them there may be no room for it
        const bool isEnd = tick == 0 || tick == 4;
        const LegendUnit unit = isEnd || style.unit == LegendUnit::percent ? style.unit : LegendUnit::plain;
        canvas.text(x, numbersTop, legendText(style.valueAt(static_cast<float>(tick) / 4.0f), unit, isSigned));
    }
    canvas.text(width / 2, numbersTop + kGlyphHeight + 2 * kGap, style.caption);
}

} // namespace

float HeatmapStyle::valueAt(float part) const
{
    if (decades > 0) return top * std::pow(10.0f, static_cast<float>(decades) * (part - 1.0f));
    return top * (kind == ErrorKind::difference ? 2.0f * part - 1.0f : part);
}

glm::vec3 HeatmapStyle::colourOf(float value) const
{
    if (decades == 0) return errorColour(kind, value, top);
    return falseColour(value > 0.0f ? 1.0f + std::log10(value / top) / static_cast<float>(decades) : 0.0f);
}

std::string legendText(float value, LegendUnit unit, bool withSign)
{
    const char* sign = withSign && value > 0.0f ? "+" : "";
    switch (unit) {
    case LegendUnit::percent:
        return fmt::format("{}{:.4g}%", sign, 100.0f * value);
    case LegendUnit::lux:
        return fmt::format("{}{:.4g} lx", sign, value);
    case LegendUnit::candelaPerM2:
        return fmt::format("{}{:.4g} cd/m2", sign, value);
    case LegendUnit::plain:
        break;
    }
    return fmt::format("{}{:.4g}", sign, value);
}

float legendTop(const ScalarImage& map)
{
    std::vector<float> values = map.values;
    if (values.empty()) return 0.01f;
    for (float& v : values) v = std::abs(v);
    const auto rank = static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    const float wanted = values[static_cast<std::size_t>(rank)];
    if (!(wanted > 0.0f) || !std::isfinite(wanted)) return 0.01f;
    const double decade = std::pow(10.0, std::floor(std::log10(double{wanted})));
    for (const double step : {1.0, 2.0, 5.0}) {
        if (step * decade >= double{wanted}) return static_cast<float>(step * decade);
    }
    return static_cast<float>(10.0 * decade);
}

ByteImage heatmap(const ScalarImage& map, const HeatmapStyle& style)
{
    assert(style.top > 0.0f);
    const int width = std::max(map.width, kLeastWidth);
    Canvas canvas(width, map.height + kLegendHeight);
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            const auto i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x);
            canvas.set(x, y, screen(style.colourOf(map.values[i])));
        }
    }
    drawLegend(canvas, map.height, width, style);
    return canvas.take();
}

} // namespace lightloom
