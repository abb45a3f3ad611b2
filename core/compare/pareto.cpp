// SPDX-License-Identifier: Apache-2.0
#include "core/compare/pareto.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lightloom {

std::vector<bool> paretoFront(std::span<const Trade> trades)
{
    std::vector<std::size_t> order(trades.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::erase_if(order,
                  [&](std::size_t i) { return !std::isfinite(trades[i].cost) || !std::isfinite(trades[i].error); });
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
        const Trade &x = trades[a], &y = trades[b];
        return x.cost != y.cost ? x.cost < y.cost : x.error < y.error;
    });
    std::vector<bool> isFront(trades.size(), false);
    Trade last{-1.0, std::numeric_limits<double>::infinity()}; // the newest of the front
    for (const std::size_t i : order) {
        const Trade& t = trades[i];
        isFront[i] = t.error < last.error || (t.error == last.error && t.cost == last.cost);
        if (isFront[i]) last = t;
    }
    return isFront;
}

} // namespace lightloom
