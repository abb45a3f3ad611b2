// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/compare/budget_pick.h"
#include "core/compare/pilot.h"

/// A time or an error as a parameter: pilots learn the scene, two models foretell, and the rest is picked. How good
/// that is stands in docs/decisions/007 and docs/measurements.md.
namespace lightloom {

/// What was asked for. At least one of the two.
struct BudgetAsked {
    std::optional<double> cpuSeconds; ///< for the bake, of all threads; pilots come on top
    std::optional<double> error;      ///< relRMSE of the indirect light, a fraction
    bool isDepthSet = false, isCountSet = false, isPhotonsSet = false; ///< in the job's parameters, by the user
};

struct BudgetPlan {
    BakeParams params;          ///< the job's, with what was picked
    BudgetPick expected;        ///< of the bake alone
    BudgetPick floor;           ///< least error that this method can be expected to reach here
    PilotSize pilot;            ///< the last one
    double pilotCpuSeconds = 0; ///< spent on all pilots
    Judge judge;                ///< to tell afterwards what came out
};

/// Runs pilots, each twice as large as the one before, as long as that is little beside the bake, and picks.
/// Octree depth (with it the first depth), K and photons are picked unless they are set. Progress is not told: pilots
/// are short. The same measured costs give the same pick, on any number of threads. Errors of kind badInput: an error
/// below the method's floor, with the floor; a time that no bake keeps to, with the least one; both together out of
/// reach, with what it would take; a method without a bake. Cancelled.
[[nodiscard]] Result<BudgetPlan> planBudget(const BakeJob& job, Method method, const BudgetAsked& asked,
                                            const ReferenceStore& store, BakeProducts& products, BakeControl& control);

/// What a bake by that plan came out at.
struct BudgetOutcome {
    double error = 0;  ///< relRMSE at the plan's probes
    double spread = 0; ///< its standard error: what other probes might have told
};
/// Nothing if stopped.
[[nodiscard]] std::optional<BudgetOutcome> budgetOutcome(const BudgetPlan& plan, const SceneProducts& at,
                                                         const IndirectField& field, BakeControl& control);

} // namespace lightloom
