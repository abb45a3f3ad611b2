// SPDX-License-Identifier: Apache-2.0
#include "core/compare/sweep_plot.h"
#include "core/compare/pareto.h"
#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace lightloom {
namespace {

/// Rows by their axes' values, so that lines run along the last axis.
std::vector<std::size_t> lineOrder(const std::vector<SweepRow>& rows, const std::vector<SweepAxis>& axes)
{
    std::vector<std::size_t> order(rows.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        for (const SweepAxis& axis : axes) {
            const double x = paramValue(rows[a].params, *axis.param), y = paramValue(rows[b].params, *axis.param);
            if (x != y) return x < y;
        }
        return false;
    });
    return order;
}

/// Nothing but the last axis parts the two.
bool isOnOneLine(const std::vector<SweepAxis>& axes, const BakeParams& a, const BakeParams& b)
{
    for (std::size_t i = 0; i + 1 < axes.size(); ++i) {
        if (paramValue(a, *axes[i].param) != paramValue(b, *axes[i].param)) return false;
    }
    return true;
}

/// The values alone, in the order that the legend heads its list with.
std::string valuesText(const std::vector<SweepAxis>& axes, const BakeParams& params)
{
    std::string text;
    for (const SweepAxis& axis : axes) text += (text.empty() ? "" : " / ") + paramText(params, *axis.param);
    return text.empty() ? "the only row" : text;
}

} // namespace

std::vector<bool> sweepFront(const std::vector<SweepRow>& rows)
{
    std::vector<Trade> trades;
    for (const SweepRow& row : rows) trades.push_back({row.cpuSeconds(), row.error.relRmse});
    return paretoFront(trades);
}

std::vector<SweepAxis> axesOf(const std::vector<SweepRow>& rows, Method method)
{
    std::vector<SweepAxis> axes;
    for (const ParamSpec& spec : kParams) {
        if ((spec.methods & (1u << static_cast<unsigned>(method))) == 0) continue;
        SweepAxis axis{&spec, {}};
        for (const SweepRow& row : rows) axis.values.push_back(paramValue(row.params, spec));
        std::ranges::sort(axis.values);
        const auto doubled = std::ranges::unique(axis.values);
        axis.values.erase(doubled.begin(), doubled.end());
        if (axis.values.size() > 1) axes.push_back(std::move(axis));
    }
    return axes;
}

LogPlot sweepPlot(const std::vector<SweepRow>& rows, Method method, const std::string& sceneName)
{
    LogPlot plot;
    plot.title = fmt::format("{}: {}", sceneName, methodName(method));
    plot.xLabel = "cost of the bake, CPU-seconds of all threads";
    plot.yLabel = "relRMSE of the indirect light, %";
    plot.yScale = 100;
    plot.markedTitle = "beaten by no other";
    if (rows.empty()) return plot;
    const SweepRow& any = rows.front();
    plot.subtitle = fmt::format("{} bakes against a reference at {} points, its noise {:.2g} %", rows.size(),
                                any.error.count, 100.0 * any.referenceNoise);
    plot.yLine = any.referenceNoise;
    plot.yLineLabel = "noise of the reference";
    const std::vector<SweepAxis> axes = axesOf(rows, method);
    const std::vector<bool> isFront = sweepFront(rows);
    const BakeParams* last = nullptr;
    for (const SweepAxis& axis : axes) {
        plot.markedUnits += fmt::format("{}{}", plot.markedUnits.empty() ? "" : " / ", axis.param->key);
    }
    if (!axes.empty()) plot.legendTitle = axes.front().param->label;
    for (const std::size_t i : lineOrder(rows, axes)) {
        const SweepRow& row = rows[i];
        const std::string name = axes.empty() ? "" : paramText(row.params, *axes.front().param);
        const bool isNew = plot.series.empty() || plot.series.back().name != name;
        if (isNew) plot.series.push_back({name, {}});
        PlotPoint point{row.cpuSeconds(), row.error.relRmse, axesText(axes, row.params), "", false};
        if (isFront[i]) point.mark = valuesText(axes, row.params);
        point.source = i;
        point.startsLine = isNew || !isOnOneLine(axes, *last, row.params);
        plot.series.back().points.push_back(std::move(point));
        last = &row.params;
    }
    return plot;
}

} // namespace lightloom
