// SPDX-License-Identifier: Apache-2.0
#include "core/transport/direction_set.h"
#include "core/base/low_discrepancy.h"
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

namespace lightloom {
namespace {

/// Radical inverse in base 3: with base 2 for the other coordinate, Halton's sequence.
double radicalInverse3(unsigned i)
{
    double value = 0.0, digit = 1.0 / 3.0;
    for (; i > 0; i /= 3, digit /= 3.0) value += digit * (i % 3);
    return value;
}

/// Point i on the half sphere z > 0, uniform by area.
glm::dvec3 pointOn(unsigned i)
{
    const double z = 1.0 - (static_cast<double>(radicalInverse2(i)) + 0x1p-16), r = std::sqrt(1.0 - z * z);
    const double turn = 2.0 * std::numbers::pi * radicalInverse3(i);
    return {r * std::cos(turn), r * std::sin(turn), z};
}

} // namespace

LineDirection lineAlong(glm::ivec3 step)
{
    const glm::ivec3 size = glm::abs(step);
    LineDirection line;
    line.major = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    line.step = step[line.major] < 0 ? -step : step;
    line.unit = glm::vec3(glm::normalize(glm::dvec3(line.step)));
    return line;
}

std::vector<LineDirection> directionSet(int count)
{
    assert(count >= 1 && count <= kMostDirections);
    std::vector<LineDirection> lines;
    std::set<std::tuple<int, int, int>> seen; // as shares of the largest component: (32, 16, 0) is (64, 32, 0)
    for (unsigned i = 0; static_cast<int>(lines.size()) < count; ++i) {
        const glm::dvec3 p = pointOn(i);
        const double largest = std::max({std::abs(p.x), std::abs(p.y), p.z});
        const LineDirection line = lineAlong(glm::ivec3(glm::round(p * (kLargestStep / largest))));
        if (seen.insert({line.step.x, line.step.y, line.step.z}).second) lines.push_back(line);
    }
    return lines;
}

} // namespace lightloom
