// SPDX-License-Identifier: Apache-2.0
#include "core/compare/budget_pick.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr double kLeastCount = 8, kMostCount = 20'000, kCountStep = 1.125;
constexpr double kLeastPhotons = 2000, kPhotonStep = 1.05;
constexpr double kMostRatio = 0.02; ///< K/N: wider kernels than a pilot has seen

/// `value` with so many digits: numbers to be read.
int rounded(double value, int digits)
{
    const double unit = std::pow(10.0, std::floor(std::log10(value)) - digits + 1);
    return static_cast<int>(unit < 1.0 ? std::round(value) : std::round(value / unit) * unit);
}

std::vector<int> steps(double from, double to, double step, int digits)
{
    std::vector<int> all;
    for (double value = from; value <= to; value *= step) {
        const int next = rounded(value, digits);
        if (all.empty() || next > all.back()) all.push_back(next);
    }
    return all;
}

} // namespace

void BudgetModels::forChoices(const std::function<void(const BudgetPick&)>& visit) const
{
    const std::vector<int> counts = count ? std::vector{*count} : steps(kLeastCount, kMostCount, kCountStep, 2),
                           numbers = photons
                                         ? std::vector{*photons}
                                         : steps(kLeastPhotons, std::max(mostPhotons, kLeastPhotons), kPhotonStep, 3);
    std::vector<CostModel::Depth> depths = costs.depths;
    if (depths.empty()) depths.emplace_back();
    for (const CostModel::Depth& d : depths) {
        for (const int k : counts) {
            for (const int n : numbers) {
                if (!photons && k > kMostRatio * n) continue;
                visit({d.depth, k, n, error.error(d.depth, k, n), costs.seconds(d.depth, k, n)});
            }
        }
    }
}

std::optional<BudgetPick> BudgetModels::bestFor(double cpuSeconds) const
{
    std::optional<BudgetPick> best;
    forChoices([&](const BudgetPick& pick) {
        if (pick.cpuSeconds <= cpuSeconds && (!best || pick.error < best->error)) best = pick;
    });
    return best;
}

std::optional<BudgetPick> BudgetModels::cheapestFor(double wanted) const
{
    std::optional<BudgetPick> best;
    forChoices([&](const BudgetPick& pick) {
        if (pick.error <= wanted && (!best || pick.cpuSeconds < best->cpuSeconds)) best = pick;
    });
    return best;
}

BudgetPick BudgetModels::floor() const
{
    return bestFor(std::numeric_limits<double>::infinity()).value_or(BudgetPick{});
}

BudgetPick BudgetModels::cheapest() const
{
    return cheapestFor(std::numeric_limits<double>::infinity()).value_or(BudgetPick{});
}

} // namespace lightloom
