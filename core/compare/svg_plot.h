// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace lightloom {

/// A number on an axis, with its label.
struct Tick {
    double value = 0;
    std::string label; ///< empty: a fine line without a number
};

/// Ticks of a logarithmic axis over [low, high] (0 < low < high): 1, 2, 5 x 10^k with labels, the other whole multiples
/// without; labels thin out to 1 x 10^k beyond two decades. `low` and `high` come out widened to the labelled ticks.
[[nodiscard]] std::vector<Tick> logTicks(double& low, double& high);

struct PlotPoint {
    double x = 0, y = 0;
    std::string tip;         ///< shown by viewers when the mouse rests on it
    std::string mark;        ///< not empty: ringed, joined to the other marked ones, numbered in the legend with this
    bool startsLine = false; ///< not joined to the point before it
    std::size_t source = 0;  ///< number of what it stands for, to whoever made the plot
};

struct PlotSeries {
    std::string name;
    std::vector<PlotPoint> points; ///< joined by a thin line in this order
};

/// Points over two logarithmic axes. Points and lines outside what a logarithm can show (0, negative) are left out.
struct LogPlot {
    std::string title, subtitle, xLabel, yLabel, legendTitle;
    std::string markedTitle, markedUnits; ///< head the list of marked points
    std::vector<PlotSeries> series;
    double yLine = 0; ///< dashed line across at this value; 0: none
    std::string yLineLabel;
    double yScale = 1; ///< printed numbers of y are values times this: 100 for per cent
};

/// Whether a logarithm can show the point.
[[nodiscard]] bool canShow(const PlotPoint& point);

/// One axis: a range of labelled ticks that holds all points.
struct LogScale {
    double low = 1, high = 10;
    std::vector<Tick> ticks;
    [[nodiscard]] double partOf(double value) const; ///< 0 at `low`, 1 at `high`
};
[[nodiscard]] LogScale logScale(const LogPlot& plot, double PlotPoint::*coordinate);

/// "#RRGGBB" of series number `series` of `count`, on white. Black is among the first seven.
[[nodiscard]] std::string plotColour(std::size_t series, std::size_t count);

/// The plot as an SVG file of 1000 x 600: axes with ticks and labels, legend, every point with `data-x`, `data-y` and a
/// tooltip. Up to eight series take colours that the colour-blind tell apart, and shapes; more take a sequential map.
[[nodiscard]] std::string svgPlot(const LogPlot& plot);

} // namespace lightloom
