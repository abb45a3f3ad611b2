// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace lightloom {

inline constexpr int kLargestStep = 64; ///< of a direction's components

/// An integer direction that discrete lines follow; light goes along it both ways.
struct LineDirection {
    glm::ivec3 step; ///< components from -kLargestStep to kLargestStep, not all 0; the largest of them is positive
    glm::vec3 unit;  ///< step, normalised
    int major = 0;   ///< axis of the largest component, the first of equals
};
[[nodiscard]] LineDirection lineAlong(glm::ivec3 step); ///< turned round if its largest component is negative

/// `count` directions, spread evenly over the sphere when each is followed both ways: points of a sequence of low
/// discrepancy on half of it, rounded to integers, each at most once. Sets are nested: the first n of a larger set are
/// the set of n. Every direction stands for 4 pi / (2 count) sr each way: together exactly the sphere. `count` from 1
/// to kMostDirections.
[[nodiscard]] std::vector<LineDirection> directionSet(int count);
inline constexpr int kMostDirections = 8192;

} // namespace lightloom
