// SPDX-License-Identifier: Apache-2.0
#include "core/compare/svg_plot.h"
#include "core/base/image.h"
#include "core/compare/false_colour.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr double kWidth = 1000, kHeight = 600, kLeft = 84, kRight = 650, kTop = 72, kBottom = 532, kLegendLeft = 676;
constexpr std::size_t kMostMarkedInLegend = 12;
constexpr const char* kInk = "#222222";

/// Okabe and Ito 2008, without the yellow that white paper swallows.
constexpr std::array<const char*, 7> kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                              "#E69F00", "#56B4E9", "#000000"};
/// Outlines around the origin, about as large as a circle of radius 5.
constexpr std::array<const char*, 7> kShapes{
    "M5,0A5,5 0 1 1 -5,0A5,5 0 1 1 5,0Z",
    "M-4.4,-4.4H4.4V4.4H-4.4Z",
    "M0,-5.8L5.2,4H-5.2Z",
    "M0,-6L6,0L0,6L-6,0Z",
    "M0,5.8L5.2,-4H-5.2Z",
    "M-5,-1.7H-1.7V-5H1.7V-1.7H5V1.7H1.7V5H-1.7V1.7H-5Z",
    "M0,-6L1.8,-1.9L6,-1.9L2.7,1L3.8,5.5L0,3L-3.8,5.5L-2.7,1L-6,-1.9L-1.8,-1.9Z"};

/// Text that XML may hold: its own signs escaped, control characters and bytes that are no UTF-8 replaced.
std::string escaped(const std::string& text)
{
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const auto byte = static_cast<unsigned char>(text[i]);
        const std::size_t length = byte < 0x80 ? 1 : byte >> 5 == 6 ? 2 : byte >> 4 == 14 ? 3 : byte >> 3 == 30 ? 4 : 0;
        bool isWhole = length > 0 && i + length <= text.size() && byte >= 0x20 && byte != 0x7F;
        for (std::size_t k = 1; isWhole && k < length; ++k)
            isWhole = (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
        if (!isWhole) {
            out += '?';
            ++i;
            continue;
        }
        const std::string_view character = std::string_view(text).substr(i, length);
        out += character == "<"    ? "&lt;"
               : character == ">"  ? "&gt;"
               : character == "&"  ? "&amp;"
               : character == "\"" ? "&quot;"
                                   : character;
        i += length;
    }
    return out;
}

/// One axis: value to pixel.
struct Scale {
    LogScale scale;
    double from = 0, to = 1; ///< pixels of both ends
    [[nodiscard]] double at(double value) const { return from + (to - from) * scale.partOf(value); }
};

const char* shapeOf(std::size_t series, std::size_t count)
{
    return count <= kShapes.size() ? kShapes[series] : kShapes[0];
}

class SvgWriter {
public:
    explicit SvgWriter(const LogPlot& plot)
        : plot_(plot), x_{logScale(plot, &PlotPoint::x), kLeft, kRight}, y_{logScale(plot, &PlotPoint::y), kBottom,
                                                                            kTop}
    {
    }

    std::string write()
    {
        add(R"svg(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" )svg"
            R"svg(font-family="DejaVu Sans, Verdana, sans-serif" font-size="12" fill="{2}">)svg",
            kWidth, kHeight, kInk);
        add(R"svg(<rect width="{}" height="{}" fill="#FFFFFF"/>)svg", kWidth, kHeight);
        text(kLeft, 30, plot_.title, R"svg(font-size="17" font-weight="bold")svg");
        text(kLeft, 52, plot_.subtitle, R"svg(fill="#555555")svg");
        axes();
        line();
        front();
        for (std::size_t s = 0; s < plot_.series.size(); ++s) drawSeries(s);
        numbers();
        legend();
        add("</svg>");
        return std::move(out_);
    }

private:
    template<class... T>
    void add(fmt::format_string<T...> format, T&&... values)
    {
        fmt::format_to(std::back_inserter(out_), format, std::forward<T>(values)...);
        out_ += '\n';
    }
    void text(double x, double y, const std::string& words, const std::string& attributes = "")
    {
        add(R"svg(<text x="{:.1f}" y="{:.1f}" {}>{}</text>)svg", x, y, attributes, escaped(words));
    }

    void axes()
    {
        for (const Tick& t : x_.scale.ticks) {
            const double x = x_.at(t.value);
            add(R"svg(<line class="x-tick" data-value="{}" x1="{:.3f}" x2="{:.3f}" y1="{}" y2="{}" stroke="{}"/>)svg",
                t.value, x, x, kTop, t.label.empty() ? kBottom : kBottom + 5, t.label.empty() ? "#EFEFEF" : "#D0D0D0");
            if (!t.label.empty()) text(x, kBottom + 20, t.label, R"svg(text-anchor="middle")svg");
        }
        for (const Tick& t : y_.scale.ticks) {
            const double y = y_.at(t.value);
            add(R"svg(<line class="y-tick" data-value="{}" x1="{}" x2="{}" y1="{:.3f}" y2="{:.3f}" stroke="{}"/>)svg",
                t.value, t.label.empty() ? kLeft : kLeft - 5, kRight, y, y, t.label.empty() ? "#EFEFEF" : "#D0D0D0");
            const std::string label = t.label.empty() ? "" : fmt::format("{:.4g}", t.value * plot_.yScale);
            if (!label.empty()) text(kLeft - 9, y + 4, label, R"svg(text-anchor="end")svg");
        }
        add(R"svg(<rect x="{}" y="{}" width="{}" height="{}" fill="none" stroke="{}"/>)svg", kLeft, kTop,
            kRight - kLeft, kBottom - kTop, kInk);
        text(0.5 * (kLeft + kRight), kBottom + 46, plot_.xLabel, R"svg(text-anchor="middle" font-size="13")svg");
        add(R"svg(<text transform="translate(24,{}) rotate(-90)" text-anchor="middle" font-size="13">{}</text>)svg",
            0.5 * (kTop + kBottom), escaped(plot_.yLabel));
    }

    void line()
    {
        if (!(plot_.yLine >= y_.scale.low && plot_.yLine <= y_.scale.high)) return;
        const double y = y_.at(plot_.yLine);
        add(R"svg(<line x1="{}" x2="{}" y1="{:.2f}" y2="{:.2f}" stroke="#777777" stroke-dasharray="5 4"/>)svg", kLeft,
            kRight, y, y);
        text(kRight - 6, y - 5, plot_.yLineLabel, R"svg(text-anchor="end" fill="#555555")svg");
    }

    /// What no other beats, joined in order of x.
    void front()
    {
        for (const PlotSeries& series : plot_.series) {
            for (const PlotPoint& p : series.points) {
                if (!p.mark.empty() && canShow(p)) marked_.push_back(&p);
            }
        }
        std::ranges::stable_sort(marked_, {}, [](const PlotPoint* p) { return p->x; });
        std::string path;
        for (const PlotPoint* p : marked_)
            path += fmt::format("{}{:.3f},{:.3f}", path.empty() ? "M" : "L", x_.at(p->x), y_.at(p->y));
        if (!path.empty())
            add(R"svg(<path d="{}" fill="none" stroke="#999999" stroke-width="5" stroke-opacity="0.35"/>)svg", path);
    }

    void drawSeries(std::size_t s)
    {
        const PlotSeries& series = plot_.series[s];
        const std::string colour = plotColour(s, plot_.series.size());
        std::string path;
        for (const PlotPoint& p : series.points) {
            if (canShow(p))
                path +=
                    fmt::format("{}{:.3f},{:.3f}", path.empty() || p.startsLine ? "M" : "L", x_.at(p.x), y_.at(p.y));
        }
        add(R"svg(<path d="{}" fill="none" stroke="{}" stroke-opacity="0.6"/>)svg", path.empty() ? "M0,0" : path,
            colour);
        for (const PlotPoint& p : series.points) {
            if (!canShow(p)) continue;
            add(R"svg(<g class="point{}" data-x="{}" data-y="{}" transform="translate({:.3f},{:.3f})"><title>{}</title>)svg",
                p.mark.empty() ? "" : " marked", p.x, p.y, x_.at(p.x), y_.at(p.y), escaped(p.tip));
            if (!p.mark.empty()) add(R"svg(<circle r="9" fill="none" stroke="{}" stroke-width="1.4"/>)svg", kInk);
            add(R"svg(<path d="{}" fill="{}" stroke="#FFFFFF" stroke-width="0.7"/></g>)svg",
                shapeOf(s, plot_.series.size()), colour);
        }
    }

    void numbers()
    {
        for (std::size_t i = 0; i < marked_.size(); ++i) {
            text(x_.at(marked_[i]->x) + 11, y_.at(marked_[i]->y) - 8, fmt::format("{}", i + 1),
                 R"svg(font-weight="bold" font-size="11")svg");
        }
    }

    void legend()
    {
        double y = kTop + 8;
        text(kLegendLeft, y, plot_.legendTitle, R"svg(font-weight="bold")svg");
        const std::size_t count = plot_.series.size(), step = std::max<std::size_t>(1, (count + 11) / 12);
        for (std::size_t s = 0; s < count; s += step) { // a long list thins out
            y += 19;
            add(R"svg(<path transform="translate({},{})" d="{}" fill="{}"/>)svg", kLegendLeft + 6, y - 4,
                shapeOf(s, count), plotColour(s, count));
            text(kLegendLeft + 20, y, plot_.series[s].name);
        }
        if (marked_.empty()) return;
        y += 36;
        add(R"svg(<circle cx="{}" cy="{}" r="7" fill="none" stroke="{}" stroke-width="1.4"/>)svg", kLegendLeft + 6,
            y - 4, kInk);
        text(kLegendLeft + 20, y, plot_.markedTitle, R"svg(font-weight="bold")svg");
        y += 17;
        text(kLegendLeft + 20, y, plot_.markedUnits, R"svg(font-size="10.5" fill="#555555")svg");
        for (std::size_t i = 0; i < std::min(marked_.size(), kMostMarkedInLegend); ++i) {
            y += 17;
            text(kLegendLeft + 14, y, fmt::format("{}", i + 1),
                 R"svg(text-anchor="end" font-weight="bold" font-size="11")svg");
            text(kLegendLeft + 20, y, marked_[i]->mark, R"svg(font-size="10.5")svg");
        }
        if (marked_.size() > kMostMarkedInLegend)
            text(kLegendLeft + 20, y + 17, fmt::format("and {} more", marked_.size() - kMostMarkedInLegend));
    }

    const LogPlot& plot_;
    Scale x_, y_;
    std::vector<const PlotPoint*> marked_;
    std::string out_;
};

} // namespace

std::vector<Tick> logTicks(double& low, double& high)
{
    const bool isWide = high / low > 100.0;
    const auto isLabelled = [&](int digit) { return digit == 1 || (!isWide && (digit == 2 || digit == 5)); };
    std::vector<Tick> ticks;
    const int first = static_cast<int>(std::floor(std::log10(low))) - 1,
              last = static_cast<int>(std::ceil(std::log10(high))) + 1;
    double from = 0, to = 0;
    for (int decade = first; decade <= last; ++decade) {
        for (int digit = 1; digit <= 9; ++digit) {
            const double value = digit * std::pow(10.0, decade);
            ticks.push_back({value, isLabelled(digit) ? fmt::format("{:.4g}", value) : ""});
            if (!isLabelled(digit)) continue;
            if (value <= low) from = value;
            if (value >= high && to == 0) to = value;
        }
    }
    low = from, high = to;
    std::erase_if(ticks, [&](const Tick& t) { return t.value < low * 0.9999 || t.value > high * 1.0001; });
    return ticks;
}

bool canShow(const PlotPoint& p) { return p.x > 0 && p.y > 0 && std::isfinite(p.x) && std::isfinite(p.y); }

double LogScale::partOf(double value) const { return std::log(value / low) / std::log(high / low); }

LogScale logScale(const LogPlot& plot, double PlotPoint::*coordinate)
{
    double low = 0, high = 0;
    for (const PlotSeries& series : plot.series) {
        for (const PlotPoint& p : series.points) {
            if (!canShow(p)) continue;
            low = low == 0 ? p.*coordinate : std::min(low, p.*coordinate);
            high = std::max(high, p.*coordinate);
        }
    }
    if (low == 0) low = 1, high = 10;
    low *= 0.94, high *= 1.06; // no point on the frame
    std::vector<Tick> ticks = logTicks(low, high);
    return {low, high, std::move(ticks)};
}

std::string plotColour(std::size_t series, std::size_t count)
{
    if (count <= kColours.size()) return kColours[series];
    // the palest tenth of the map would vanish on white
    const glm::vec3 c = falseColour(0.85f * static_cast<float>(series) / static_cast<float>(count - 1));
    const auto byte = [](float v) { return static_cast<int>(std::lround(255.0f * encodeSrgb(v))); };
    return fmt::format("#{:02X}{:02X}{:02X}", byte(c.x), byte(c.y), byte(c.z));
}

std::string svgPlot(const LogPlot& plot) { return SvgWriter(plot).write(); }

} // namespace lightloom
