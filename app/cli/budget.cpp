// SPDX-License-Identifier: Apache-2.0
#include "app/cli/budget.h"
#include "app/cli/progress.h"
#include "core/bake/solver_for.h"
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lightloom::cli {
namespace {

std::string pickText(const BudgetPick& pick)
{
    const std::string depth = pick.depth > 0 ? fmt::format("octree.depth={} ", pick.depth) : "";
    return fmt::format("{}gather.count={} photons={}", depth, pick.count, pick.photons);
}

} // namespace

bool hasBudget(const BakeOptions& options) { return options.timeBudget || options.errorBudget; }

Result<Done> checkBudget(const BakeOptions& options, const std::string& method, const std::string& bakeFile)
{
    if (!hasBudget(options)) return Done{};
    const auto refuse = [](std::string message) { return Error{Error::Kind::badInput, std::move(message)}; };
    for (const auto& [value, name] :
         {std::pair(options.timeBudget, "--time-budget"), std::pair(options.errorBudget, "--error-budget")}) {
        if (value && !(*value > 0.0 && std::isfinite(*value)))
            return refuse(fmt::format("{} {} is not above 0", name, *value));
    }
    if (!bakeFile.empty()) return refuse(bakeFile + " is baked already; a budget needs a new bake");
    const Result<Method> known = methodNamed(method);
    if (known && !solverFor(*known)) {
        return refuse(method + " bakes nothing that a budget could be for; --target-stderr sets a reference's error");
    }
    return Done{};
}

Result<BudgetReport> pickForBudget(const Context& context, const BakeOptions& options, const BakeJob& job,
                                   Method method, const ReferenceStore& store, BakeProducts& products)
{
    BudgetReport report;
    report.asked = {options.timeBudget, options.errorBudget, isSet(options, "octree.depth"),
                    isSet(options, "gather.count"), isSet(options, "photons")};
    BakeControl control(*context.workers, {}, context.stop);
    context.report->progress("pilots", 0.0);
    Result<BudgetPlan> plan = planBudget(job, method, report.asked, store, products, control);
    if (!plan) return plan.error();
    report.plan = *std::move(plan);
    const BudgetPlan& p = report.plan;
    log(context.log, LogLevel::info,
        fmt::format("picked {} after {:.2g} CPU-seconds of pilots ({} points, {} photons per light group)",
                    pickText(p.expected), p.pilotCpuSeconds, p.pilot.probes, p.pilot.photons));
    log(context.log, LogLevel::info,
        fmt::format("expected: {:.3g} CPU-seconds, error {:.2g} %; floor of the method about {:.2g} %",
                    p.expected.cpuSeconds, 100.0 * p.expected.error, 100.0 * p.floor.error));
    return report;
}

Result<Done> judgeBudget(const Context& context, BudgetReport& report, const SceneProducts& at,
                         const IndirectField& field, double cpuSeconds)
{
    BakeControl control(*context.workers, {}, context.stop);
    const std::optional<BudgetOutcome> outcome = budgetOutcome(report.plan, at, field, control);
    if (!outcome) return Error{Error::Kind::cancelled, "interrupted after the bake, before its error was measured"};
    report.outcome = *outcome;
    report.cpuSeconds = cpuSeconds;
    log(context.log, LogLevel::info,
        fmt::format("came out: {:.3g} CPU-seconds, error {:.2g} % (+- {:.1g} %)", cpuSeconds, 100.0 * outcome->error,
                    100.0 * outcome->spread));
    return Done{};
}

nlohmann::json asJson(const BudgetReport& report)
{
    const BudgetPlan& p = report.plan;
    nlohmann::json asked = nlohmann::json::object();
    if (report.asked.cpuSeconds) asked["cpu_seconds"] = *report.asked.cpuSeconds;
    if (report.asked.error) asked["error"] = *report.asked.error;
    nlohmann::json picked{{"gather.count", p.expected.count}, {"photons", p.expected.photons}};
    if (p.expected.depth > 0) picked["octree.depth"] = p.expected.depth;
    return {{"asked", asked},
            {"picked", picked},
            {"expected", {{"cpu_seconds", p.expected.cpuSeconds}, {"error", p.expected.error}}},
            {"floor", p.floor.error},
            {"pilots", {{"cpu_seconds", p.pilotCpuSeconds}, {"probes", p.pilot.probes}, {"photons", p.pilot.photons}}},
            {"came_out",
             {{"cpu_seconds", report.cpuSeconds},
              {"error", report.outcome.error},
              {"error_spread", report.outcome.spread}}}};
}

} // namespace lightloom::cli
