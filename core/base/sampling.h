// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/units.h"
#include <cmath>

/// Maps from the unit square to directions and surfaces. `u1`, `u2` in [0,1). World space.
namespace lightloom {

/// Two unit vectors that make a right-handed frame with unit `n` (Duff et al. 2017; no branch on the pole, no
/// normalise).
struct Frame {
    glm::vec3 tangent, bitangent, normal;

    explicit Frame(glm::vec3 n) : normal(n)
    {
        const float sign = n.z < 0.0f ? -1.0f : 1.0f; // not copysign: a zero of either sign makes the same frame
        const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
        tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
        bitangent = {b, sign + n.y * n.y * a, -n.y};
    }
    [[nodiscard]] glm::vec3 toWorld(glm::vec3 v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
    [[nodiscard]] glm::vec3 toLocal(glm::vec3 v) const
    {
        return {glm::dot(v, tangent), glm::dot(v, bitangent), glm::dot(v, normal)};
    }
};

/// (cos, sin) of `turns` full turns, in [0,1]: within 1.2e-7 of exact. Series around the nearest quarter turn, without
/// a branch or a library call, so that loops over it vectorise and every machine gives the same bits.
[[nodiscard]] inline glm::vec2 circlePoint(float turns)
{
    const int quarter = static_cast<int>(4.0f * turns + 0.5f);
    const float x = 2.0f * kPi * (turns - 0.25f * static_cast<float>(quarter)), xx = x * x; // |x| <= pi / 4
    const float s =
        x * (1.0f + xx * (-1.0f / 6.0f + xx * (1.0f / 120.0f + xx * (-1.0f / 5040.0f + xx * (1.0f / 362880.0f)))));
    const float c = 1.0f + xx * (-0.5f + xx * (1.0f / 24.0f + xx * (-1.0f / 720.0f + xx * (1.0f / 40320.0f))));
    const bool isTurned = (quarter & 1) != 0;
    const float cosine = isTurned ? s : c, sine = isTurned ? c : s;
    return {((quarter + 1) & 2) != 0 ? -cosine : cosine, (quarter & 2) != 0 ? -sine : sine};
}

/// Uniform on the unit disc (polar).
[[nodiscard]] inline glm::vec2 sampleDisc(float u1, float u2) { return std::sqrt(u1) * circlePoint(u2); }

/// Around +z, density cos/pi.
[[nodiscard]] inline glm::vec3 sampleCosineHemisphere(float u1, float u2)
{
    const glm::vec2 d = sampleDisc(u1, u2);
    return {d.x, d.y, std::sqrt(glm::max(0.0f, 1.0f - u1))};
}

/// Uniform on the unit sphere, density 1/(4 pi).
[[nodiscard]] inline glm::vec3 sampleSphere(float u1, float u2)
{
    const float z = 1.0f - 2.0f * u1, r = std::sqrt(glm::max(0.0f, 1.0f - z * z));
    return {r * circlePoint(u2), z};
}

/// Uniform in the cone around +z with cosine of the half angle `cosMax`, density 1/(2 pi (1 - cosMax)).
[[nodiscard]] inline glm::vec3 sampleCone(float u1, float u2, float cosMax)
{
    const float z = 1.0f - u1 * (1.0f - cosMax), r = std::sqrt(glm::max(0.0f, 1.0f - z * z));
    return {r * circlePoint(u2), z};
}

/// Barycentric weights (of vertices 1 and 2) of a uniform point in a triangle.
[[nodiscard]] inline glm::vec2 sampleTriangle(float u1, float u2)
{
    const float s = std::sqrt(u1);
    return {1.0f - s, s * u2};
}

} // namespace lightloom
