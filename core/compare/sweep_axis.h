// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/params/param_text.h"

namespace lightloom {

/// One parameter of a sweep and the values it takes, in the order they were given.
struct SweepAxis {
    const ParamSpec* param = nullptr; ///< into `kParams`
    std::vector<double> values;       ///< a choice's index for choices; no value twice
};

inline constexpr std::size_t kMostSweepRows = 10'000;

/// `NAME=ITEM,ITEM,...`; an item is a value, a range `a..b:step`, or a geometric range `a..b*factor` (rounded for whole
/// numbers). Ranges include b where a step lands on it. Errors name the item: no such parameter, one that `method` does
/// not read, a value it cannot take, a range that goes nowhere.
[[nodiscard]] Result<SweepAxis> parseSweepAxis(std::string_view text, Method method);

/// `base` with every combination of the axes' values, the last axis turning fastest; `base` alone without axes. Errors:
/// the same parameter twice, more than `kMostSweepRows`, values that do not go together.
[[nodiscard]] Result<std::vector<BakeParams>> sweepRows(const BakeParams& base, const std::vector<SweepAxis>& axes);

/// The order in which rows are best baked: parameters that redo the earliest stage turn slowest, so that photons of one
/// row are still there for the next. Numbers of rows, each once.
[[nodiscard]] std::vector<std::size_t> sweepOrder(const std::vector<BakeParams>& rows);

} // namespace lightloom
