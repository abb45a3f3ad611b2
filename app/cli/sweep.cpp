// SPDX-License-Identifier: Apache-2.0
#include "app/cli/methods.h"
#include "app/cli/progress.h"
#include "core/bake/solver_for.h"
#include "core/base/atomic_file.h"
#include "core/compare/sweep_plot.h"
#include "core/compare/sweep_table.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/gltf_reader.h"
#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

constexpr float kUsualNoise = 0.02f;    ///< of a traced reference: a quarter of the error a usual bake has
constexpr double kReferenceShare = 0.3; ///< of the time, where the reference is traced

/// A sweep while it runs: what was asked, and the rows so far, on disk after each.
class SweepJob {
public:
    SweepJob(const Context& context, const SweepCommand& command, SweepPlan plan)
        : context_(context), command_(command), plan_(std::move(plan)), rows_(*sweepRows(plan_.base, plan_.axes))
    {
    }

    Result<Done> run()
    {
        Result<std::shared_ptr<const Scene>> scene = readScene(command_.scene, context_.log);
        if (!scene) return scene.error();
        plan_.scene = *scene;
        BakeControl control(*context_.workers, {{}, [this](const Progress& p) { tell(p); }}, context_.stop);
        const Result<Judge> judge = findJudge(control);
        if (!judge) return judge.error();
        log(context_.log, LogLevel::info,
            fmt::format("reference: {} points, mean {:.4g} lx, noise {:.2g} %", judge->points.size(), judge->mean,
                        100.0 * judge->noise));
        noise_ = judge->noise;
        Result<SweepTable> table = resumeSweep(command_.output, plan_, *judge);
        if (!table) return table.error();
        const SweepKeys keys(plan_, *judge);
        for (const BakeParams& row : rows_) wanted_.push_back(keys.of(row));
        done_ = std::move(table->rows);
        kept_ = doneOfPlan();
        if (table->isDamaged)
            log(context_.log, LogLevel::warning, command_.output + ": the last line was broken off and is made again");
        if (kept_ > 0)
            log(context_.log, LogLevel::info,
                fmt::format("{} of {} rows are in {} already", kept_, rows_.size(), command_.output));
        // progress counts from here: the reference was another matter
        BakeControl sweeping(*context_.workers, {{}, [this](const Progress& p) { tell(p); }}, context_.stop);
        Result<Done> written = Done{};
        const std::vector<SweepRow> known = done_;
        const Result<Done> swept = runSweep(plan_, *judge, known, products_, sweeping, [&](SweepRow row) {
            report(row);
            done_.push_back(std::move(row));
            sortLike(done_, wanted_);
            if (written) written = save(doneOfPlan() < rows_.size());
        });
        if (!written) return written.error();
        if (swept) return save(false);
        return swept;
    }

    Result<Done> plot() const
    {
        if (command_.plot.empty()) return Done{};
        const std::string name = std::filesystem::path(command_.scene).stem().string();
        return writeFile(command_.plot, svgPlot(sweepPlot(done_, plan_.method, name)));
    }

    void print() const
    {
        const std::vector<bool> isFront = sweepFront(done_);
        if (context_.json) {
            printJson(isFront);
            return;
        }
        if (context_.quiet) return;
        const std::vector<SweepAxis> axes = axesOf(done_, plan_.method);
        std::size_t widest = 10;
        for (const SweepRow& row : done_) widest = std::max(widest, axesText(axes, row.params).size());
        fmt::print("{:<{}}  {:>9} {:>9} {:>8} {:>8} {:>10}\n", "parameters", widest, "CPU-s", "relRMSE", "bias",
                   "noise", "systematic");
        for (std::size_t i = 0; i < done_.size(); ++i) {
            const SweepRow& row = done_[i];
            fmt::print("{:<{}}  {:9.3f} {:7.2f} % {:+6.2f} % {:6.2f} % {:8.2f} %{}\n", axesText(axes, row.params),
                       widest, row.cpuSeconds(), 100.0 * row.error.relRmse, 100.0 * row.error.bias,
                       100.0 * row.split.noise, 100.0 * row.split.systematic, isFront[i] ? " *" : "");
        }
        fmt::print("* beaten by no other; noise of the reference {:.2g} %\n", 100.0 * noise_);
    }

    /// A reference as noisy as what it judges is no judge.
    void warnOfNoise() const
    {
        double least = 1e300;
        for (const SweepRow& row : done_) least = std::min(least, row.error.relRmse);
        if (done_.empty() || noise_ <= 0.25 * least) return;
        log(context_.log, LogLevel::warning,
            fmt::format("the reference's noise, {:.2g} %, is more than a quarter of the least error, {:.2g} %; ask for "
                        "--target-stderr {:.1g}",
                        100.0 * noise_, 100.0 * least, 0.25 * least));
    }

    [[nodiscard]] std::string progressText() const
    {
        return done_.empty()
                   ? fmt::format("interrupted before the first of {} rows was done; nothing was written", rows_.size())
                   : fmt::format("interrupted after {} of {} rows; {} holds these, the same command goes on",
                                 doneOfPlan(), rows_.size(), command_.output);
    }

private:
    Result<Judge> findJudge(BakeControl& control)
    {
        if (command_.reference != "auto") {
            const Result<ProbeTable> table = readResult(command_.reference);
            if (!table) return table.error();
            const Result<Judge> judge = judgeFrom(*table, *plan_.scene);
            return judge ? judge : judge.error().in(command_.reference);
        }
        BakeParams p = plan_.base;
        BakeOptions options = command_.options;
        if (p.referenceStderr == 0.0f) p.referenceStderr = kUsualNoise;
        options.targetStderr = static_cast<double>(p.referenceStderr);
        makeRoomForTarget(p, options);
        const Result<SceneProducts> at = sceneProducts({plan_.scene, p, {}, plan_.isa}, products_, control);
        if (!at) return at.error();
        const std::vector<ProbeRow> rows = probeRows(*at, command_.probes, kJudgeSeed);
        if (rows.empty()) {
            return Error{Error::Kind::badInput,
                         fmt::format("{}: no surface has an area that light can reach", command_.scene)};
        }
        const ReferenceJob job{kJudgeSeed, p.referenceSamples, p.referenceStderr, p.pathDepth, p.directSamples};
        const Result<Judge> judge =
            traceJudge(*at, rows, job, ReferenceStore(command_.scene, context_.log), *context_.workers, context_.stop,
                       [this](double f) { context_.report->progress("reference", kReferenceShare * f); });
        referenceShare_ = kReferenceShare;
        return judge ? judge : judge.error().in(command_.scene);
    }

    void tell(const Progress& p)
    {
        context_.report->progress(stageName(p.stage), referenceShare_ + (1.0 - referenceShare_) * p.fraction,
                                  p.remainingSeconds);
    }

    void report(const SweepRow& row) const
    {
        log(context_.log, LogLevel::info,
            fmt::format("{} of {}: {}{}{:.3g} CPU-s, relRMSE {:.2f} %", doneOfPlan() + 1, rows_.size(),
                        axesText(plan_.axes, row.params), plan_.axes.empty() ? "" : ": ", row.cpuSeconds(),
                        100.0 * row.error.relRmse));
    }

    [[nodiscard]] std::size_t doneOfPlan() const
    {
        return static_cast<std::size_t>(std::ranges::count_if(
            done_, [&](const SweepRow& row) { return std::ranges::find(wanted_, row.key) != wanted_.end(); }));
    }

    Result<Done> save(bool isIncomplete) const
    {
        const std::optional<std::size_t> wanted = isIncomplete ? std::optional(rows_.size()) : std::nullopt;
        return writeFile(command_.output, sweepText(done_, plan_.method, wanted));
    }

    void printJson(const std::vector<bool>& isFront) const
    {
        nlohmann::json front = nlohmann::json::array();
        for (std::size_t i = 0; i < done_.size(); ++i) {
            if (!isFront[i]) continue;
            nlohmann::json values = nlohmann::json::object();
            for (const SweepAxis& axis : plan_.axes)
                values[std::string(axis.param->key)] = paramText(done_[i].params, *axis.param);
            front.push_back(
                {{"parameters", values}, {"cpu_seconds", done_[i].cpuSeconds()}, {"relrmse", done_[i].error.relRmse}});
        }
        const nlohmann::json json{{"method", methodName(plan_.method)}, {"rows", done_.size()},
                                  {"baked", doneOfPlan() - kept_},      {"kept", kept_},
                                  {"reference_noise", noise_},          {"front", front},
                                  {"output", command_.output}};
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    }

    const Context& context_;
    const SweepCommand& command_;
    SweepPlan plan_;
    std::vector<BakeParams> rows_;    ///< wanted
    std::vector<std::string> wanted_; ///< their keys
    std::vector<SweepRow> done_;      ///< as the file holds them; may be more than wanted
    std::size_t kept_ = 0;            ///< of `done_`, from an earlier run
    BakeProducts products_;
    double noise_ = 0, referenceShare_ = 0;
};

/// The plan, but for the scene. What cannot be followed is wrong usage.
Result<SweepPlan> planOf(const SweepCommand& command)
{
    const Result<Method> method = methodNamed(command.method);
    if (!method) return method.error();
    if (!solverFor(*method)) {
        return Error{Error::Kind::badInput, command.method + " keeps nothing to bake, so there is nothing to sweep"};
    }
    const Result<BakeParams> base = bakeParams(command.options, *method);
    if (!base) return base.error();
    SweepPlan plan{nullptr, *method, command.options.isa, *base, {}, LIGHTLOOM_VERSION};
    for (const std::string& text : command.vary) {
        Result<SweepAxis> axis = parseSweepAxis(text, *method);
        if (!axis) return axis.error();
        plan.axes.push_back(*std::move(axis));
    }
    const Result<std::vector<BakeParams>> rows = sweepRows(plan.base, plan.axes);
    if (!rows) return rows.error();
    return plan;
}

} // namespace

int sweep(const Context& context, const SweepCommand& command)
{
    Result<SweepPlan> plan = planOf(command);
    if (!plan) return failUsage(plan.error());
    for (const std::string& output : {command.output, command.plot}) {
        if (output.empty()) continue;
        if (const Result<Done> fine = checkOutput(output); !fine) return failWriting(fine.error());
    }
    SweepJob job(context, command, *std::move(plan));
    const Result<Done> done = job.run();
    const bool isInterrupted = !done && done.error().kind == Error::Kind::cancelled;
    if (!done && !isInterrupted) return fail(done.error());
    if (const Result<Done> plotted = job.plot(); !plotted) return failWriting(plotted.error());
    if (isInterrupted) return fail({Error::Kind::cancelled, job.progressText()});
    job.warnOfNoise();
    job.print();
    return kDone;
}

} // namespace lightloom::cli
