// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/sight_line.h"
#include <cmath>

namespace lightloom {

std::optional<float> alongAxis(glm::vec3 p, glm::vec3 axis, const SightLine& sight)
{
    const float cosine = glm::dot(axis, sight.along), sine2 = 1.0f - cosine * cosine;
    if (!(sine2 > 1e-3f)) return std::nullopt;
    const glm::vec3 d = sight.eye - p;
    return (glm::dot(d, axis) - glm::dot(d, sight.along) * cosine) / sine2;
}

std::optional<glm::vec3> onPlane(glm::vec3 p, glm::vec3 n, const SightLine& sight)
{
    const float slope = glm::dot(sight.along, n);
    if (!(std::abs(slope) > 1e-3f)) return std::nullopt;
    const float t = glm::dot(p - sight.eye, n) / slope;
    if (!(t > 0.0f)) return std::nullopt;
    return sight.eye + t * sight.along;
}

} // namespace lightloom
