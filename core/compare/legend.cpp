// SPDX-License-Identifier: Apache-2.0
#include "core/compare/legend.h"
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <fmt/format.h>
#include <string_view>

namespace lightloom {
namespace {

constexpr int kLeastWidth = 240, kMargin = 12, kBarTop = 8, kBarHeight = 14, kTickHeight = 4;
constexpr int kGlyphWidth = 5, kGlyphHeight = 7, kAdvance = kGlyphWidth + 1;
constexpr std::array<std::uint8_t, 3> kPaper{24, 24, 24}, kInk{230, 230, 230};

/// One row per line, bit 4 is the left pixel.
struct Glyph {
    char character;
    std::array<std::uint8_t, kGlyphHeight> rows;
};
constexpr std::array kGlyphs{
    Glyph{'0', {14, 17, 19, 21, 25, 17, 14}}, Glyph{'1', {4, 12, 4, 4, 4, 4, 14}},
    Glyph{'2', {14, 17, 1, 6, 8, 16, 31}},    Glyph{'3', {14, 17, 1, 6, 1, 17, 14}},
    Glyph{'4', {2, 6, 10, 18, 31, 2, 2}},     Glyph{'5', {31, 16, 30, 1, 1, 17, 14}},
    Glyph{'6', {6, 8, 16, 30, 17, 17, 14}},   Glyph{'7', {31, 1, 2, 4, 8, 8, 8}},
    Glyph{'8', {14, 17, 17, 14, 17, 17, 14}}, Glyph{'9', {14, 17, 17, 15, 1, 2, 12}},
    Glyph{'.', {0, 0, 0, 0, 0, 12, 12}},      Glyph{'%', {24, 25, 2, 4, 8, 19, 3}},
    Glyph{'-', {0, 0, 0, 14, 0, 0, 0}},       Glyph{'+', {0, 4, 4, 31, 4, 4, 0}},
    Glyph{'e', {0, 0, 14, 17, 31, 16, 14}},
};

/// CIELAB (D65) to linear Rec.709.
glm::vec3 fromLab(glm::vec3 lab)
{
    const float y = (lab.x + 16.0f) / 116.0f;
    const auto uncurve = [](float v) {
        constexpr float delta = 6.0f / 29.0f;
        return v > delta ? v * v * v : 3.0f * delta * delta * (v - 4.0f / 29.0f);
    };
    const float X = 0.9504559f * uncurve(y + lab.y / 500.0f), Y = uncurve(y),
                Z = 1.0890578f * uncurve(y - lab.z / 200.0f);
    return {3.2409699f * X - 1.5373832f * Y - 0.4986108f * Z, -0.9692436f * X + 1.8759675f * Y + 0.0415551f * Z,
            0.0556301f * X - 0.2039770f * Y + 1.0569715f * Z};
}

/// A parabola in CIELAB, inside the gamut all the way, walked at even speed.
class ColourPath {
public:
    ColourPath()
    {
        constexpr int steps = 4096;
        std::array<float, steps + 1> length{};
        for (int i = 1; i <= steps; ++i) {
            length[static_cast<std::size_t>(i)] =
                length[static_cast<std::size_t>(i) - 1] + glm::length(point(i, steps) - point(i - 1, steps));
        }
        int at = 0;
        for (std::size_t i = 0; i < table_.size(); ++i) {
            const float wanted = length.back() * static_cast<float>(i) / static_cast<float>(table_.size() - 1);
            while (at < steps && length[static_cast<std::size_t>(at)] < wanted) ++at;
            table_[i] = glm::clamp(fromLab(point(at, steps)), 0.0f, 1.0f);
        }
    }
    [[nodiscard]] glm::vec3 at(float t) const
    {
        const float inside = t < 1.0f ? std::max(t, 0.0f) : 1.0f; // NaN is not below 1
        const float place = (std::isnan(t) ? 1.0f : inside) * static_cast<float>(table_.size() - 1);
        const auto low = std::min(static_cast<std::size_t>(place), table_.size() - 2);
        return glm::mix(table_[low], table_[low + 1], place - static_cast<float>(low));
    }

private:
    static glm::vec3 point(int i, int steps)
    {
        constexpr glm::vec3 dark(14.0f, 24.0f, -40.0f), bend(54.0f, 62.0f, 6.0f), pale(94.0f, -8.0f, 45.0f);
        const float s = static_cast<float>(i) / static_cast<float>(steps);
        return glm::mix(glm::mix(dark, bend, s), glm::mix(bend, pale, s), s);
    }
    std::array<glm::vec3, 257> table_;
};

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
    void text(int left, int top, std::string_view text)
    {
        for (const char c : text) {
            const auto glyph = std::ranges::find(kGlyphs, c, &Glyph::character);
            assert(glyph != kGlyphs.end());
            for (int y = 0; y < kGlyphHeight; ++y) {
                for (int x = 0; x < kGlyphWidth; ++x) {
                    if (glyph->rows[static_cast<std::size_t>(y)] >> (kGlyphWidth - 1 - x) & 1)
                        set(left + x, top + y, kInk);
                }
            }
            left += kAdvance;
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

void drawLegend(Canvas& canvas, int top, int width, float most, LegendUnit unit)
{
    const int left = kMargin, right = width - 1 - kMargin, length = right - left;
    for (int x = 0; x <= length; ++x) {
        const auto colour = screen(falseColour(static_cast<float>(x) / static_cast<float>(length)));
        for (int y = 0; y < kBarHeight; ++y) canvas.set(left + x, top + kBarTop + y, colour);
    }
    for (int tick = 0; tick <= 4; ++tick) {
        const int x = left + length * tick / 4;
        for (int y = 0; y < kTickHeight; ++y) canvas.set(x, top + kBarTop + kBarHeight + y, kInk);
        const float value = most * static_cast<float>(tick) / 4.0f;
        const std::string text =
            unit == LegendUnit::percent ? fmt::format("{:.4g}%", 100.0f * value) : fmt::format("{:.4g}", value);
        const int wide = kAdvance * static_cast<int>(text.size()) - 1;
        const int at = std::clamp(x - wide / 2, 2, width - 2 - wide);
        canvas.text(at, top + kBarTop + kBarHeight + kTickHeight + 3, text);
    }
}

} // namespace

glm::vec3 falseColour(float t)
{
    static const ColourPath path;
    return path.at(t);
}

float legendTop(const ScalarImage& map)
{
    std::vector<float> values = map.values;
    if (values.empty()) return 0.01f;
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

ByteImage heatmap(const ScalarImage& map, float top, LegendUnit unit)
{
    assert(top > 0.0f);
    const int width = std::max(map.width, kLeastWidth);
    Canvas canvas(width, map.height + kLegendHeight);
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            const auto i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x);
            canvas.set(x, y, screen(falseColour(map.values[i] / top)));
        }
    }
    drawLegend(canvas, map.height, width, top, unit);
    return canvas.take();
}

} // namespace lightloom
