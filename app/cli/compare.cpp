// SPDX-License-Identifier: Apache-2.0
#include "app/cli/commands.h"
#include "core/base/image_file.h"
#include "core/compare/flip.h"
#include "core/compare/image_error.h"
#include "core/compare/legend.h"
#include "core/compare/probes.h"
#include <algorithm>
#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

/// What two files have in common to be compared by.
struct Pair {
    std::vector<double> values, reference; ///< luminances
    FloatImage a, b;                       ///< pictures: what `values` were taken from
    std::string what;                      ///< for people: "indirect, 2000 points"
    std::vector<glm::vec3> standardErrors; ///< of the reference, where it tells
};

struct Outcome {
    std::optional<ErrorMetrics> metrics;
    std::optional<double> flip;
    double noise = 0;
};

enum class FileKind { table, exr, png };

Result<FileKind> kindOf(const std::string& path)
{
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    if (extension == ".csv") return FileKind::table;
    if (extension == ".exr") return FileKind::exr;
    if (extension == ".png") return FileKind::png;
    return Error{Error::Kind::unsupported, fmt::format("{}: compare reads .csv, .exr and .png files", path)};
}

Result<Pair> readTables(const CompareCommand& command)
{
    Result<ProbeTable> a = readResult(command.a), b = readResult(command.b);
    if (!a) return a.error();
    if (!b) return b.error();
    if (a->indirect.size() != b->indirect.size()) {
        return Error{Error::Kind::badInput, fmt::format("{} has {} points, {} has {}", command.a, a->indirect.size(),
                                                        command.b, b->indirect.size())};
    }
    if (!a->points.empty() && !b->points.empty()) {
        for (std::size_t i = 0; i < a->points.size(); ++i) {
            if (a->points[i] == b->points[i]) continue;
            return Error{Error::Kind::badInput,
                         fmt::format("line {}: {} and {} hold different points", i + 2, command.a, command.b)};
        }
    }
    return Pair{luminances(a->indirect),
                luminances(b->indirect),
                FloatImage(),
                FloatImage(),
                fmt::format("indirect light, {} points", a->indirect.size()),
                b->standardError};
}

Result<LayeredImage> readPicture(const std::string& path, FileKind kind)
{
    if (kind == FileKind::exr) return readExr(path);
    const Result<ByteImage> png = readPng(path);
    if (!png) return png.error();
    return LayeredImage{{{"", toLinear(*png)}}, {}};
}

/// EXR pictures of ours are compared by their indirect light if both have it, any others by what they show.
Result<Pair> readPictures(const CompareCommand& command, FileKind kindA, FileKind kindB, bool asSeen)
{
    const Result<LayeredImage> filesA = readPicture(command.a, kindA), filesB = readPicture(command.b, kindB);
    if (!filesA) return filesA.error();
    if (!filesB) return filesB.error();
    const bool byIndirect = !asSeen && filesA->find("indirect") && filesB->find("indirect");
    const auto chosen = [&](const LayeredImage& file) -> const FloatImage& {
        const FloatImage* layer = file.find(byIndirect ? "indirect" : "");
        return layer ? *layer : file.layers.front().image;
    };
    const FloatImage &a = chosen(*filesA), &b = chosen(*filesB);
    if (!a.isSameSize(b)) {
        return Error{Error::Kind::badInput, fmt::format("{} is {} x {} pixels, {} is {} x {}", command.a, a.width,
                                                        a.height, command.b, b.width, b.height)};
    }
    return Pair{luminances(a.pixels),
                luminances(b.pixels),
                a,
                b,
                fmt::format("{}, {} x {} pixels", byIndirect ? "indirect light" : "picture", a.width, a.height),
                {}};
}

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

void printAll(const Context& context, const std::string& wanted, const Pair& pair, const Outcome& outcome)
{
    if (context.json) {
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

Result<Done> writeHeatmap(const std::string& path, const ScalarImage& map, bool isFlip)
{
    const ByteImage picture =
        isFlip ? heatmap(map, 1.0f, LegendUnit::plain) : heatmap(map, legendTop(map), LegendUnit::percent);
    return writePng(path, picture, {{"Title", isFlip ? "FLIP difference" : "error relative to the mean"}});
}

} // namespace

int compare(const Context& context, const CompareCommand& command)
{
    if (!command.heatmap.empty()) {
        if (const Result<Done> fine = checkOutput(command.heatmap); !fine) return failWriting(fine.error());
    }
    const Result<FileKind> kindA = kindOf(command.a), kindB = kindOf(command.b);
    if (!kindA) return fail(kindA.error());
    if (!kindB) return fail(kindB.error());
    const bool isTable = *kindA == FileKind::table, isFlip = command.metric == "flip";
    if (isTable != (*kindB == FileKind::table)) {
        return fail({Error::Kind::badInput,
                     fmt::format("{} and {} are a table and a picture; compare two of a kind", command.a, command.b)});
    }
    if (isTable && (isFlip || !command.heatmap.empty())) {
        return fail({Error::Kind::badInput, "FLIP and heatmaps need two pictures (.exr or .png), not tables"});
    }
    Result<Pair> pair = isTable ? readTables(command) : readPictures(command, *kindA, *kindB, isFlip);
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
        if (*kindA == FileKind::exr || *kindB == FileKind::exr) exposeLike(pair->reference, pair->a, pair->b);
        map = flipMap(pair->a, pair->b);
        outcome.flip = meanOf(map);
    } else if (!command.heatmap.empty()) {
        map = relativeErrorMap(pair->a, pair->b, metrics->meanReference);
    }
    if (!command.heatmap.empty()) {
        if (const Result<Done> written = writeHeatmap(command.heatmap, map, isFlip); !written) {
            return failWriting(written.error());
        }
    }
    printAll(context, command.metric, *pair, outcome);
    return kDone;
}

} // namespace lightloom::cli
