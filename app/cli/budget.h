// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "app/cli/commands.h"
#include "core/compare/budget.h"
#include <nlohmann/json_fwd.hpp>

/// --time-budget and --error-budget of whatever command bakes.
namespace lightloom::cli {

/// A plan, and what came of it.
struct BudgetReport {
    BudgetAsked asked;
    BudgetPlan plan;
    BudgetOutcome outcome;
    double cpuSeconds = 0; ///< of the bake
};

[[nodiscard]] bool hasBudget(const BakeOptions& options);
/// Error: a budget that is no positive number, or with a method or a file that leaves nothing to pick.
[[nodiscard]] Result<Done> checkBudget(const BakeOptions& options, const std::string& method,
                                       const std::string& bakeFile);

/// Runs the pilots and says what was picked and is expected.
[[nodiscard]] Result<BudgetReport> pickForBudget(const Context& context, const BakeOptions& options, const BakeJob& job,
                                                 Method method, const ReferenceStore& store, BakeProducts& products);
/// Measures what came out and says so.
[[nodiscard]] Result<Done> judgeBudget(const Context& context, BudgetReport& report, const SceneProducts& at,
                                       const IndirectField& field, double cpuSeconds);

[[nodiscard]] nlohmann::json asJson(const BudgetReport& report);

} // namespace lightloom::cli
