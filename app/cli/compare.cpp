// SPDX-License-Identifier: Apache-2.0
#include "app/cli/compare_inputs.h"
#include "app/cli/methods.h"
#include "core/base/image_file.h"
#include "core/compare/flip.h"
#include "core/compare/image_error.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

struct Outcome {
    std::optional<ErrorMetrics> metrics;
    std::optional<double> flip;
    double noise = 0;
};

/// FLIP wants pictures as a screen shows them: EXR values are exposed alike, so that 99 % of the reference's pixels are
/// within range.
void exposeLike(const std::vector<double>& reference, FloatImage& a, FloatImage& b)
{
    std::vector<double> sorted = reference;
    const auto rank = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
    const double white = sorted[static_cast<std::size_t>(rank)];
    const auto scale = static_cast<float>(white > 0 ? 1.0 / white : 1.0);
    for (FloatImage* image : {&a, &b}) {
        for (glm::vec3& p : image->pixels) p *= scale;
    }
}

constexpr std::array<std::pair<const char*, double ErrorMetrics::*>, 6> kMetrics{{
    {"relrmse", &ErrorMetrics::relRmse},
    {"bias", &ErrorMetrics::bias},
    {"mae", &ErrorMetrics::mae},
    {"p95", &ErrorMetrics::p95},
    {"max", &ErrorMetrics::max},
    {"perpoint", &ErrorMetrics::perPoint},
}};

void printJson(const std::string& wanted, const Pair& pair, const Outcome& outcome)
{
    nlohmann::json json{{"compared", pair.what}};
    if (outcome.metrics) {
        for (const auto& [name, member] : kMetrics) json[name] = (*outcome.metrics).*member;
        json["count"] = outcome.metrics->count;
        json["mean_reference"] = outcome.metrics->meanReference;
        if (!pair.standardErrors.empty()) json["reference_noise"] = outcome.noise;
    }
    if (outcome.flip) json["flip"] = *outcome.flip;
    if (!wanted.empty()) json["metric"] = wanted;
    fmt::print("{}\n", json.dump(2));
}

void printAll(const Context& context, const std::string& wanted, const Pair& pair, const Outcome& outcome)
{
    if (context.json) {
        printJson(wanted, pair, outcome);
        return;
    }
    if (wanted == "flip") {
        fmt::print("{}\n", *outcome.flip);
        return;
    }
    for (const auto& [name, member] : kMetrics) {
        if (wanted == name) {
            fmt::print("{}\n", (*outcome.metrics).*member);
            return;
        }
    }
    fmt::print("{}; mean of the reference {:.6g}\n", pair.what, outcome.metrics->meanReference);
    for (const auto& [name, member] : kMetrics)
        fmt::print("{:<16} {:9.4f} %\n", name, 100.0 * (*outcome.metrics).*member);
    if (!pair.standardErrors.empty()) fmt::print("{:<16} {:9.4f} %\n", "reference noise", 100.0 * outcome.noise);
    if (outcome.flip) fmt::print("{:<16} {:9.4f}\n", "flip", *outcome.flip);
}

/// How the error map is drawn. FLIP values are fractions of the largest difference there is.
HeatmapStyle styleOf(const CompareCommand& command, const Pair& pair, const ScalarImage& map)
{
    if (command.metric == "flip") return {ErrorKind::relative, 1.0f, LegendUnit::plain, "flip difference"};
    switch (command.map) {
    case ErrorKind::absolute:
        return {command.map, legendTop(map), pair.unit, "absolute error"};
    case ErrorKind::difference:
        return {command.map, legendTop(map), LegendUnit::percent, "difference / mean of the reference"};
    case ErrorKind::relative:
        break;
    }
    return {command.map, legendTop(map), LegendUnit::percent, "error / mean of the reference"};
}

/// FLIP of the pair, and its map.
ScalarImage flipOf(const CompareCommand& command, Pair& pair)
{
    if (*kindOf(command.a) != FileKind::png || *kindOf(command.b) != FileKind::png)
        exposeLike(pair.reference, pair.a, pair.b);
    return flipMap(pair.a, pair.b);
}

} // namespace

int compare(const Context& context, const CompareCommand& command)
{
    if (!command.heatmap.empty()) {
        if (const Result<Done> fine = checkOutput(command.heatmap); !fine) return failWriting(fine.error());
    }
    if (const Result<Done> fine = checkSides(command); !fine) return fail(fine.error());
    if (const Result<BakeParams> fine = bakeParams(command.options, {}); !fine) return failUsage(fine.error());
    const bool isFlip = command.metric == "flip";
    Result<Pair> pair = readSides(context, command, isFlip);
    if (!pair) return fail(pair.error());

    const std::string place = fmt::format("{} against {}", command.a, command.b);
    for (const auto& [values, whose] : {std::pair(&pair->values, "result"), std::pair(&pair->reference, "reference")}) {
        const Result<Done> finite = checkFinite(*values, whose); // before FLIP could make black of NaN
        if (!finite) return fail(finite.error().in(place));
    }
    Outcome outcome;
    const Result<ErrorMetrics> metrics = measureError(pair->values, pair->reference);
    if (!metrics && !isFlip) return fail(metrics.error().in(place)); // FLIP can be had against black, too
    if (metrics) {
        outcome.metrics = *metrics;
        outcome.noise = relativeNoise(pair->standardErrors, metrics->meanReference);
    }
    ScalarImage map;
    if (isFlip) {
        map = flipOf(command, *pair);
        outcome.flip = meanOf(map);
    } else if (!command.heatmap.empty()) {
        map = errorMap(pair->a, pair->b, metrics->meanReference, command.map);
    }
    if (!command.heatmap.empty()) {
        const HeatmapStyle style = styleOf(command, *pair, map);
        const Result<Done> written = writePng(command.heatmap, heatmap(map, style), {{"Title", style.caption}});
        if (!written) return failWriting(written.error());
    }
    printAll(context, command.metric, *pair, outcome);
    return kDone;
}

} // namespace lightloom::cli
