// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

namespace lightloom {

/// What a choice costs and how far off it is: less is better in both.
struct Trade {
    double cost = 0, error = 0;
};

/// True for each trade that no other beats: none costs less and is no worse, or is better and costs no more. Of equal
/// ones all are in. What is not finite is out.
[[nodiscard]] std::vector<bool> paretoFront(std::span<const Trade> trades);

} // namespace lightloom
