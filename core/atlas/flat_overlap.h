// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

namespace lightloom {

struct OverlapSearch {
    std::optional<std::pair<std::size_t, std::size_t>> pair; ///< numbers, rising; nothing if none overlap
    std::uint64_t comparisons = 0;                           ///< of two triangles: what the search cost
};

/// Two triangles of the plane that overlap by more than `tolerance`: that each of them reaches that far over every edge
/// of the other. Sweeps once over them (after Shamos & Hoey 1976), O(n log n) whatever their shapes, and stops at the
/// first pair. Triangles without area overlap nothing; where many overlap within the tolerance, a pair that does so by
/// little more may be missed.
[[nodiscard]] OverlapSearch findOverlap(const std::vector<std::array<glm::dvec2, 3>>& triangles, double tolerance,
                                        const std::stop_token& stop);

} // namespace lightloom
