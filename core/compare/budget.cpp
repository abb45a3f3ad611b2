// SPDX-License-Identifier: Apache-2.0
#include "core/compare/budget.h"
#include "core/bake/solver_for.h"
#include "core/compare/field_probe.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_products.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr int kGrowth = 2, kMostProbes = 4800, kDeepest = 8;
constexpr double kOfBake = 1.0;    ///< what a further pilot may cost of a bake that is to reach an error
constexpr double kOfTime = 0.14;   ///< what all pilots may cost of a time budget, if the first does not cost more
constexpr double kAim = 0.9;       ///< of the error asked for: models are good to a tenth or two
constexpr double kWellBelow = 0.5; ///< of the floor: refused at once; else only after a second pilot

class Planner {
public:
    Planner(const BakeJob& job, Method method, const BudgetAsked& asked, const ReferenceStore& store,
            BakeProducts& products, BakeControl& control)
        : job_(job), method_(method), asked_(asked), store_(store), products_(products), control_(control)
    {
        if (asked.error) { // which often hangs on few small places
            size_.probes *= 3;
            size_.depths.push_back(6);
        }
        int on = 0; // lamps share the effort
        for (int g = 0; g < static_cast<int>(job.scene->groups.size()); ++g) on += isOff(job.mix, g) ? 0 : 1;
        size_.photons = static_cast<int>(size_.photons / std::sqrt(std::max(on, 1)));
        if (method == Method::lightOctree && asked.isDepthSet) size_.depths = {job.params.octreeDepth};
        if (asked.isCountSet) models_.count = job.params.gatherCount;
        if (asked.isPhotonsSet) models_.photons = job.params.photonCount;
        models_.mostPhotons = mostPhotons();
    }

    Result<BudgetPlan> plan()
    {
        for (int pilots = 1;; ++pilots) {
            Result<PilotFindings> found = runPilot(job_, method_, size_, store_, products_, control_);
            if (!found) return found.error();
            spent_ += found->cpuSeconds;
            models_.error = ErrorModel::fit(found->errors);
            models_.costs = found->costs;
            const std::optional<BudgetPick> best = pick();
            const bool isDoubtful =
                !best && asked_.error && pilots == 1 && *asked_.error > kWellBelow * models_.floor().error;
            const bool goesOn = isDoubtful || isWorth(kGrowth * found->cpuSeconds, best);
            if (!goesOn || size_.probes * kGrowth > kMostProbes) {
                if (!best) return refusal();
                return finish(*best, *std::move(found));
            }
            size_.probes *= kGrowth;
            size_.photons *= kGrowth;
            growDepths(best);
        }
    }

private:
    [[nodiscard]] double mostPhotons() const
    {
        BakeJob job = job_;
        job.params.photonCount = 1'000'000'000;
        while (job.params.photonCount > 2000 && !checkPhotonsFit(job))
            job.params.photonCount -= job.params.photonCount / 20;
        return job.params.photonCount;
    }

    [[nodiscard]] std::optional<BudgetPick> pick() const
    {
        if (!asked_.error) return models_.bestFor(*asked_.cpuSeconds);
        std::optional<BudgetPick> best = models_.cheapestFor(kAim * *asked_.error);
        if (!best) best = models_.cheapestFor(*asked_.error);
        if (best && asked_.cpuSeconds && best->cpuSeconds > *asked_.cpuSeconds) return {};
        return best;
    }

    [[nodiscard]] bool isWorth(double next, const std::optional<BudgetPick>& best) const
    {
        if (asked_.cpuSeconds && spent_ + next > kOfTime * *asked_.cpuSeconds) return false;
        return !asked_.error || (best && next <= kOfBake * best->cpuSeconds);
    }

    /// One depth further where the deepest was the best, or nothing was good enough.
    void growDepths(const std::optional<BudgetPick>& best)
    {
        if (method_ != Method::lightOctree || asked_.isDepthSet) return;
        const int deepest = size_.depths.back();
        if (deepest < kDeepest && (!best || best->depth == deepest)) size_.depths.push_back(deepest + 1);
    }

    [[nodiscard]] Error refusal() const
    {
        const auto refuse = [](std::string message) { return Error{Error::Kind::badInput, std::move(message)}; };
        if (models_.floor().count == 0) {
            return refuse(
                fmt::format("gather.count={} needs more photons than fit into memory", job_.params.gatherCount));
        }
        if (!asked_.error) {
            return refuse(fmt::format("{:.3g} CPU-seconds are too few for this scene: {} takes at least {:.2g}",
                                      *asked_.cpuSeconds, methodName(method_), models_.cheapest().cpuSeconds));
        }
        const std::optional<BudgetPick> anyhow = models_.cheapestFor(*asked_.error);
        if (!anyhow) {
            return refuse(fmt::format("an error of {:.2g} % is below the floor of {} on this scene, about {:.2g} %",
                                      100.0 * *asked_.error, methodName(method_), 100.0 * models_.floor().error));
        }
        return refuse(fmt::format("an error of {:.2g} % takes about {:.2g} CPU-seconds on this scene, more than {:.3g}",
                                  100.0 * *asked_.error, anyhow->cpuSeconds, *asked_.cpuSeconds));
    }

    [[nodiscard]] BudgetPlan finish(const BudgetPick& best, PilotFindings found) const
    {
        BudgetPlan plan{job_.params, best, models_.floor(), size_, spent_, std::move(found.judge)};
        // the models know nothing of deeper leaves, of what they cost and of what they mend
        plan.params.octreeDetail = 0;
        plan.params.gatherCount = best.count;
        plan.params.photonCount = best.photons;
        if (best.depth > 0) plan.params.octreeDepth = plan.params.octreeFirstDepth = best.depth;
        return plan;
    }

    const BakeJob& job_;
    Method method_;
    const BudgetAsked& asked_;
    const ReferenceStore& store_;
    BakeProducts& products_;
    BakeControl& control_;
    PilotSize size_;
    BudgetModels models_;
    double spent_ = 0;
};

} // namespace

Result<BudgetPlan> planBudget(const BakeJob& job, Method method, const BudgetAsked& asked, const ReferenceStore& store,
                              BakeProducts& products, BakeControl& control)
{
    if (!solverFor(method)) {
        return Error{Error::Kind::badInput,
                     fmt::format("{} bakes nothing that a budget could be for", methodName(method))};
    }
    if (method == Method::irradianceGrid || method == Method::voxelLightcuts) {
        return Error{Error::Kind::unsupported,
                     fmt::format("budgets for {} cannot be planned yet; set {}", methodName(method),
                                 method == Method::irradianceGrid ? "photons and grid.size"
                                                                  : "voxel.size and voxel.directions")};
    }
    return Planner(job, method, asked, store, products, control).plan();
}

std::optional<BudgetOutcome> budgetOutcome(const BudgetPlan& plan, const SceneProducts& at, const IndirectField& field,
                                           BakeControl& control)
{
    const FieldProbe probe(*at.rays, *at.lights, &field, plan.params);
    const auto light = probe.indirect(plan.judge.points, control.workers(), control.stop());
    if (!light) return {};
    const std::vector<double> values = luminances(*light);
    const SplitSquares squares = splitSquares(values, values, plan.judge);
    const double error = std::sqrt(std::max(squares.systematic.value, 0.0));
    return BudgetOutcome{error, error > 0.0 ? 0.5 * squares.systematicSpread / error : 0.0};
}

} // namespace lightloom
