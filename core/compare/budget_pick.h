// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/compare/cost_model.h"
#include "core/compare/error_model.h"
#include <functional>
#include <optional>

namespace lightloom {

/// What a budget may choose, and what it chose.
struct BudgetPick {
    int depth = 0;                    ///< of the octree; 0: the method has none
    int count = 0, photons = 0;       ///< K, and photons per group
    double error = 0, cpuSeconds = 0; ///< expected
};

/// Both models of one scene, and what is settled already. Choices are a lattice: every depth of `costs`, K and photons
/// in steps of an eighth and a twentieth. It does not move with the budget, so a larger budget never gets a worse pick.
struct BudgetModels {
    ErrorModel error;
    CostModel costs;                   ///< its depths are those there is a choice of
    double mostPhotons = 1e9;          ///< per group: what fits into memory
    std::optional<int> count, photons; ///< as the user set them

    /// The least error for `cpuSeconds`. Nothing: no bake is that cheap.
    [[nodiscard]] std::optional<BudgetPick> bestFor(double cpuSeconds) const;
    /// The cheapest bake with an error of at most `error`. Nothing: it is below the floor.
    [[nodiscard]] std::optional<BudgetPick> cheapestFor(double error) const;
    [[nodiscard]] BudgetPick floor() const;    ///< the least error at any cost
    [[nodiscard]] BudgetPick cheapest() const; ///< the least cost of any bake worth the name

private:
    void forChoices(const std::function<void(const BudgetPick&)>& visit) const;
};

} // namespace lightloom
