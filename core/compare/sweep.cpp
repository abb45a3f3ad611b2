// SPDX-License-Identifier: Apache-2.0
#include "core/compare/sweep.h"
#include "core/bake/packed_octree.h"
#include "core/bake/solver_for.h"
#include "core/base/memory_use.h"
#include "core/compare/field_probe.h"
#include "core/compare/sweep_effort.h"
#include "core/photonmap/photon_products.h"
#include <algorithm>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

/// One seed's bake: cost alone, and light at the judge's points.
struct SeedResult {
    std::vector<StageCost> stages;
    std::vector<double> values;
    double fieldMiB = 0;
};

class SweepRun {
public:
    SweepRun(const SweepPlan& plan, const Judge& judge, std::unique_ptr<Solver> solver, BakeProducts& products,
             BakeControl& control)
        : plan_(plan), judge_(judge), solver_(std::move(solver)), products_(products), control_(control),
          keys_(plan, judge), effort_(plan.method, plan.scene->groups.size())
    {
    }

    Result<Done> bakeAll(const std::vector<BakeParams>& rows, const std::vector<std::size_t>& order,
                         const std::function<void(SweepRow)>& onRow)
    {
        const BakeParams* before = nullptr;
        for (std::size_t i = 0; i < order.size(); ++i) {
            const BakeParams& params = rows[order[i]];
            leftAfterRow_ = 0;
            for (std::size_t j = i + 1; j < order.size(); ++j)
                leftAfterRow_ += effort_.seconds(rows[order[j]], &rows[order[j - 1]]);
            rowSeconds_ = effort_.seconds(params, before);
            const double beganMs = control_.elapsedMs();
            Result<SweepRow> row = rowOf(params);
            if (!row) return row.error().kind == Error::Kind::cancelled ? row.error() : placed(row.error(), params);
            effort_.learn(params, before, (control_.elapsedMs() - beganMs) / 1000.0);
            before = &params;
            onRow(*std::move(row));
        }
        control_.progress(Stage::show, 1.0);
        return Done{};
    }

private:
    [[nodiscard]] Error placed(const Error& error, const BakeParams& params) const
    {
        const std::string place = axesText(plan_.axes, params);
        return place.empty() ? error : error.in(place);
    }

    Result<SweepRow> rowOf(const BakeParams& params)
    {
        resetPeakMemory();
        BakeParams other = params;
        other.seed = otherSeed(params.seed);
        const Result<SeedResult> a = bake(params, 0.0), b = a ? bake(other, 0.5) : a;
        if (!b) return b.error();
        const Result<ErrorMetrics> error = measureError(a->values, judge_.reference);
        if (!error) return error.error();
        SweepRow row;
        row.params = params;
        row.threads = control_.workers().threadCount();
        for (const auto& seed : {&*a, &*b}) {
            for (const StageCost& s : seed->stages) {
                PartCost& part = row.parts[static_cast<std::size_t>(sweepPart(s.stage))];
                part.wallSeconds += 0.5e-3 * s.wallMs;
                part.cpuSeconds += 0.5e-3 * s.cpuMs;
            }
        }
        row.processPeakMiB = static_cast<double>(peakMemoryBytes()) / kMiB;
        row.fieldMiB = 0.5 * (a->fieldMiB + b->fieldMiB);
        row.error = *error;
        row.split = splitError(a->values, b->values, judge_);
        row.referenceNoise = judge_.noise;
        row.key = keys_.of(params);
        return row;
    }

    /// `from`: part of the row that is done already.
    Result<SeedResult> bake(const BakeParams& params, double from)
    {
        std::shared_ptr<const IndirectField> field;
        BakeControl inner(control_, {[&](const Snapshot& s) { field = s.field; },
                                     [&](const Progress& p) { tell(p.stage, from + 0.45 * p.fraction); }});
        const BakeJob job{plan_.scene, params, {}, plan_.isa};
        products_.beginRound();
        if (const Result<Done> done = solver_->bake(job, products_, inner); !done) return done.error();
        SeedResult result;
        result.stages = products_.counters.stages;
        const Result<SceneProducts> at = sceneProducts(job, products_, inner); // finds what the solver left
        if (!at) return at.error();
        const Result<std::shared_ptr<const IndirectField>> shown = shownField(field, params, at->lights);
        if (!shown) return shown.error();
        field = *shown;
        result.fieldMiB = static_cast<double>(field->memoryBytes()) / kMiB;
        const FieldProbe probe(*at->rays, *at->lights, field.get(), params);
        const auto light = probe.indirect(judge_.points, control_.workers(), control_.stop(),
                                          [&](double f) { tell(Stage::show, from + 0.45 + 0.05 * f); });
        if (!light) return Error{Error::Kind::cancelled, "the sweep was cancelled"};
        result.values = luminances(*light);
        return result;
    }

    /// `part` of this row is done. The control takes elapsed and remaining time from the fraction.
    void tell(Stage stage, double part)
    {
        const double spent = control_.elapsedMs() / 1000.0, left = (1.0 - part) * rowSeconds_ + leftAfterRow_;
        control_.progress(stage, spent / std::max(spent + left, 1e-9));
    }

    const SweepPlan& plan_;
    const Judge& judge_;
    std::unique_ptr<Solver> solver_;
    BakeProducts& products_;
    BakeControl& control_;
    SweepKeys keys_;
    SweepEffort effort_;
    double rowSeconds_ = 0, leftAfterRow_ = 0; ///< expected; set between bakes, read by workers within one
};

} // namespace

SweepPart sweepPart(std::string_view stage)
{
    const std::string_view word = stage.substr(0, stage.find(' '));
    for (const std::string_view name : {"rays", "lamps", "reach", "area"}) {
        if (word == name) return SweepPart::prepare;
    }
    if (word == "shoot" || word == "first") return SweepPart::shoot; // "first light"
    if (word == "tree") return SweepPart::tree;
    if (word == "octree" || word == "voxels" || word == "partners") return SweepPart::build;
    if (word == "gather" || word == "bounces") return SweepPart::gather;
    return SweepPart::other;
}

double SweepRow::wallSeconds() const
{
    double sum = 0;
    for (const PartCost& part : parts) sum += part.wallSeconds;
    return sum;
}

double SweepRow::cpuSeconds() const
{
    double sum = 0;
    for (const PartCost& part : parts) sum += part.cpuSeconds;
    return sum;
}

SweepKeys::SweepKeys(const SweepPlan& plan, const Judge& judge)
    : common_(fmt::format("{}\n{}\n{}\n{}\n{}\n", toHex(sceneHash(*plan.scene)), methodName(plan.method),
                          kIsaNames[static_cast<std::size_t>(plan.isa)], plan.program, judge.digest)),
      method_(plan.method)
{
}

std::string SweepKeys::of(const BakeParams& params) const
{
    return toHex(Sha256().add(common_ + stageKey(params, Stage::show, method_)).finish()).substr(0, 16);
}

std::uint64_t otherSeed(std::uint64_t seed)
{
    // the largest seed is the last one that files keep exactly
    return static_cast<double>(seed) < findParam("seed")->most ? seed + 1 : seed - 1;
}

Result<Done> runSweep(const SweepPlan& plan, const Judge& judge, const std::vector<SweepRow>& known,
                      BakeProducts& products, BakeControl& control, const std::function<void(SweepRow)>& onRow)
{
    std::unique_ptr<Solver> solver = solverFor(plan.method);
    if (!solver) {
        return Error{Error::Kind::badInput, fmt::format("{} keeps nothing to sweep", methodName(plan.method))};
    }
    const Result<std::vector<BakeParams>> rows = sweepRows(plan.base, plan.axes);
    if (!rows) return rows.error();
    const SweepKeys keys(plan, judge);
    std::vector<std::size_t> order;
    for (const std::size_t i : sweepOrder(*rows)) {
        if (std::ranges::find(known, keys.of((*rows)[i]), &SweepRow::key) != known.end()) continue;
        order.push_back(i);
        const Result<Done> fits = checkPhotonsFit({plan.scene, (*rows)[i], {}, plan.isa});
        if (!fits) return fits.error().in(axesText(plan.axes, (*rows)[i]));
    }
    return SweepRun(plan, judge, std::move(solver), products, control).bakeAll(*rows, order, onRow);
}

std::string axesText(const std::vector<SweepAxis>& axes, const BakeParams& params)
{
    std::string text;
    for (const SweepAxis& axis : axes) {
        if (!text.empty()) text += ' ';
        text += fmt::format("{}={}", axis.param->key, paramText(params, *axis.param));
    }
    return text;
}

} // namespace lightloom
