// SPDX-License-Identifier: Apache-2.0
#include "app/cli/methods.h"
#include "app/cli/progress.h"
#include "core/base/atomic_file.h"
#include "core/compare/field_probe.h"
#include "core/compare/image_error.h"
#include "core/compare/probes.h"
#include <atomic>
#include <chrono>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

constexpr double kBakeShare = 0.8; ///< of a probe's time, where it bakes first

/// Light at the rows that were finished, the first ones.
ProbeTable tableOf(const std::vector<ProbeRow>& rows, std::size_t finished)
{
    ProbeTable table;
    table.points.assign(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(finished));
    table.direct.resize(finished);
    table.indirect.resize(finished);
    return table;
}

void tellSource(const Context& context, const KeptReference& kept)
{
    const ReferenceResult& r = kept.result;
    if (kept.wasStored) log(context.log, LogLevel::info, fmt::format("from {}", kept.file.string()));
    if (kept.resumed > 0) {
        log(context.log, LogLevel::info, fmt::format("{} of {} paths were traced before", kept.resumed, r.paths));
    }
    if (r.capped > 0) {
        log(context.log, LogLevel::warning,
            fmt::format("{} of {} points used all {} paths before they met the target; raise reference.samples",
                        r.capped, r.probes.size(), r.leastPaths));
    }
}

ProbeTable byReference(const Context& context, const ReferenceStore& store, const Lighting& lighting,
                       const std::vector<ProbeRow>& rows, const std::vector<ProbePoint>& points)
{
    const BakeParams& p = lighting.params;
    const ReferenceJob job{p.seed, p.referenceSamples, p.referenceStderr, p.pathDepth, p.directSamples};
    const KeptReference kept = store.illuminance(
        *lighting.lit.rays, *lighting.lit.lights, {}, points, job, ReferenceMatch::sameBits, *context.workers,
        context.stop, [&](double fraction) { context.report->progress("reference", fraction); });
    tellSource(context, kept);
    const ReferenceResult& result = kept.result;
    ProbeTable table = tableOf(rows, result.finished);
    for (std::size_t i = 0; i < result.finished; ++i) {
        const ProbeLight& light = result.probes[i];
        table.direct[i] = light.direct;
        table.indirect[i] = light.indirect;
        // the two are estimated from different random numbers
        table.standardError.push_back(
            glm::sqrt(light.directError * light.directError + light.indirectError * light.indirectError));
    }
    if (result.causticPhotons == 0) return table;
    for (std::size_t i = 0; i < result.finished; ++i) {
        table.caustic.push_back(result.probes[i].caustic);
        table.causticBlur.push_back(result.probes[i].causticBlur);
    }
    log(context.log, LogLevel::info,
        fmt::format("caustics of small lamps: {} photons, averaged over {:.3g} m (caustic_blur bounds what that blurs)",
                    result.causticPhotons, result.causticRadius));
    return table;
}

ProbeTable byField(const Context& context, const Lighting& lighting, const std::vector<ProbeRow>& rows,
                   const std::vector<ProbePoint>& points)
{
    const FieldProbe light(*lighting.lit.rays, *lighting.lit.lights, lighting.shown.get(), lighting.params);
    ProbeTable table = tableOf(rows, rows.size());
    std::vector<std::uint8_t> isDone(rows.size(), 0);
    std::atomic<std::size_t> done = 0;
    const double from = lighting.bakeSeconds > 0 ? kBakeShare : 0.0;
    context.workers->run(rows.size(), context.stop, [&](std::size_t i) {
        table.direct[i] = light.direct(points[i]);
        table.indirect[i] = light.indirect(points[i]);
        isDone[i] = 1;
        const double part = static_cast<double>(++done) / static_cast<double>(rows.size());
        context.report->progress("probe", from + (1.0 - from) * part);
    });
    const auto finished = static_cast<std::size_t>(std::ranges::find(isDone, 0) - isDone.begin());
    table.points.resize(finished);
    table.direct.resize(finished);
    table.indirect.resize(finished);
    return table;
}

nlohmann::json summary(const Context& context, const Lighting& lighting, const ProbeTable& table, double seconds,
                       const std::string& output)
{
    const auto mean = [](const std::vector<glm::vec3>& light) {
        double sum = 0;
        for (const double l : luminances(light)) sum += l;
        return light.empty() ? 0.0 : sum / static_cast<double>(light.size());
    };
    nlohmann::json json{{"method", methodName(lighting.method)},
                        {"points", table.points.size()},
                        {"mean_direct_lux", mean(table.direct)},
                        {"mean_indirect_lux", mean(table.indirect)},
                        {"seconds", seconds},
                        {"threads", context.workers->threadCount()},
                        {"isa", lighting.lit.rays->isaName()},
                        {"output", output}};
    if (lighting.field) json["bake_seconds"] = lighting.bakeSeconds;
    if (!table.standardError.empty()) {
        const double all = mean(table.direct) + mean(table.indirect);
        json["relative_standard_error"] = relativeNoise(table.standardError, all);
    }
    return json;
}

/// What was finished is kept, with a last line that no reader can take for numbers.
int saveInterrupted(const ProbeTable& table, std::size_t wanted, const std::string& output, bool canResume)
{
    const std::string what = fmt::format("interrupted after {} of {} points{}", table.points.size(), wanted,
                                         canResume ? " (--resume goes on)" : "");
    if (table.points.empty() || output.empty()) return fail({Error::Kind::cancelled, what + "; nothing was written"});
    const Result<Done> written = writeFile(output, resultText(table, wanted));
    if (!written) return failWriting(written.error());
    return fail({Error::Kind::cancelled, fmt::format("{}; {} holds these, marked as incomplete", what, output)});
}

} // namespace

int probe(const Context& context, const ProbeCommand& command)
{
    const LightingRequest request{command.scene, command.method, command.bakeFile, command.options, command.cache};
    if (const Result<Done> fine = checkRequest(request); !fine) return failUsage(fine.error());
    if (context.json && command.output.empty()) {
        return failUsage({Error::Kind::badInput, "with --json the table needs a file: -o RESULT.csv"});
    }
    if (!command.output.empty()) {
        if (const Result<Done> fine = checkOutput(command.output); !fine) return failWriting(fine.error());
    }
    const Result<std::vector<ProbeRow>> rows = readPoints(command.points);
    if (!rows) return fail(rows.error());

    const auto began = std::chrono::steady_clock::now();
    const Result<Lighting> lighting = prepareLighting(context, request, kBakeShare);
    if (!lighting) return fail(lighting.error());
    std::vector<ProbePoint> points;
    for (const ProbeRow& row : *rows) points.push_back(inScene(*lighting->lit.scene, row));
    const ReferenceStore store = storeOf(context, command.scene, command.cache);
    const ProbeTable table = lighting->method == Method::reference
                                 ? byReference(context, store, *lighting, *rows, points)
                                 : byField(context, *lighting, *rows, points);
    if (table.points.size() < rows->size()) {
        const bool canResume = lighting->method == Method::reference && command.cache.isUsed;
        return saveInterrupted(table, rows->size(), command.output, canResume);
    }

    const std::string text = resultText(table);
    if (command.output.empty()) {
        fmt::print("{}", text);
        return kDone;
    }
    if (const Result<Done> written = writeFile(command.output, text); !written) return failWriting(written.error());
    if (context.json) {
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
        const nlohmann::json json = summary(context, *lighting, table, seconds.count(), command.output);
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    }
    return kDone;
}

} // namespace lightloom::cli
