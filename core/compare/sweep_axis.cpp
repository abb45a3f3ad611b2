// SPDX-License-Identifier: Apache-2.0
#include "core/compare/sweep_axis.h"
#include "core/compare/csv_text.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace lightloom {
namespace {

constexpr std::size_t kMostPerRange = 1000;

Error badItem(std::string_view item, std::string_view what)
{
    return {Error::Kind::badInput, fmt::format("{}: {}", shownCell(item), what)};
}

/// "a..b:step" or "a..b*factor", taken apart.
struct Range {
    double first = 0, last = 0, step = 0;
    bool isGeometric = false;
};

Result<Range> parseRange(std::string_view item)
{
    const std::size_t dots = item.find("..");
    const std::string_view rest = item.substr(dots + 2);
    const std::size_t mark = rest.find_first_of(":*");
    Range range;
    const bool isFine = mark != std::string_view::npos && parseNumber(item.substr(0, dots), range.first) &&
                        parseNumber(rest.substr(0, mark), range.last) && parseNumber(rest.substr(mark + 1), range.step);
    if (!isFine) return badItem(item, "a range is a..b:step or a..b*factor");
    range.isGeometric = rest[mark] == '*';
    if (range.isGeometric && !(range.first > 0 && range.step > 1)) {
        return badItem(item, "a geometric range starts above 0 and has a factor above 1");
    }
    if (!range.isGeometric && !(range.step > 0)) return badItem(item, "the step must be above 0");
    if (!(range.first <= range.last)) return badItem(item, "the range ends before it begins");
    return range;
}

Result<std::vector<double>> valuesOf(std::string_view item, const Range& range, bool isWhole)
{
    // a last step that misses the end by rounding still lands on it
    const double end = range.last + 1e-9 * std::max(std::abs(range.first), std::abs(range.last));
    std::vector<double> values;
    for (std::size_t i = 0;; ++i) {
        const auto n = static_cast<double>(i);
        const double value = range.isGeometric ? range.first * std::pow(range.step, n) : range.first + n * range.step;
        if (!(value <= end)) return values;
        if (values.size() == kMostPerRange) {
            return badItem(item, fmt::format("more than {} values", kMostPerRange));
        }
        values.push_back(range.isGeometric && isWhole ? std::round(value) : value);
    }
}

/// The values of one item, none of them checked against the parameter's range yet.
Result<std::vector<double>> itemValues(std::string_view item, const ParamSpec& param)
{
    if (param.isChoice()) {
        const auto found = std::ranges::find(param.choices, item);
        if (found == param.choices.end()) return with({}, param.key, -1.0).error();
        return std::vector<double>{static_cast<double>(found - param.choices.begin())};
    }
    if (item.find("..") == std::string_view::npos) {
        double value = 0;
        if (!parseNumber(item, value)) return withText({}, param.key, item).error();
        return std::vector<double>{value};
    }
    const Result<Range> range = parseRange(item);
    if (!range) return range.error();
    return valuesOf(item, *range, !std::holds_alternative<float BakeParams::*>(param.field));
}

} // namespace

Result<SweepAxis> parseSweepAxis(std::string_view text, Method method)
{
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) return badItem(text, "expected NAME=V1,V2,...");
    const std::string_view key = text.substr(0, equals);
    SweepAxis axis{findParam(key), {}};
    if (!axis.param) return with({}, key, 0.0).error();
    if ((axis.param->methods & (1u << static_cast<unsigned>(method))) == 0) {
        return Error{Error::Kind::badInput, fmt::format("{} does nothing for {}", key, methodName(method))};
    }
    for (const std::string_view item : cellsOf(text.substr(equals + 1))) {
        const Result<std::vector<double>> values = itemValues(item, *axis.param);
        if (!values) return values.error();
        for (const double value : *values) {
            const Result<BakeParams> fits = with({}, key, value);
            if (!fits) return fits.error();
            const double kept = paramValue(*fits, *axis.param); // as the parameter's own type has it
            if (std::ranges::find(axis.values, kept) == axis.values.end()) axis.values.push_back(kept);
        }
    }
    return axis;
}

Result<std::vector<BakeParams>> sweepRows(const BakeParams& base, const std::vector<SweepAxis>& axes)
{
    std::vector<BakeParams> rows{base};
    std::vector<const ParamSpec*> seen;
    for (const SweepAxis& axis : axes) {
        if (std::ranges::find(seen, axis.param) != seen.end()) {
            return Error{Error::Kind::badInput, fmt::format("{} is varied twice", axis.param->key)};
        }
        seen.push_back(axis.param);
        if (rows.size() * axis.values.size() > kMostSweepRows) {
            return Error{Error::Kind::badInput, fmt::format("more than {} rows; vary less", kMostSweepRows)};
        }
        std::vector<BakeParams> next;
        for (const BakeParams& row : rows) {
            for (const double value : axis.values) next.push_back(*with(row, axis.param->key, value));
        }
        rows = std::move(next);
    }
    for (const BakeParams& row : rows) {
        if (const Result<Done> fits = checkTogether(row); !fits) return fits.error();
    }
    return rows;
}

std::vector<std::size_t> sweepOrder(const std::vector<BakeParams>& rows)
{
    std::vector<const ParamSpec*> byStage;
    for (const ParamSpec& spec : kParams) byStage.push_back(&spec);
    std::ranges::stable_sort(byStage, {}, &ParamSpec::redo);
    std::vector<std::size_t> order(rows.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        for (const ParamSpec* spec : byStage) {
            const double x = paramValue(rows[a], *spec), y = paramValue(rows[b], *spec);
            if (x != y) return x < y;
        }
        return false;
    });
    return order;
}

} // namespace lightloom
