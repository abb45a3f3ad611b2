// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <glm/glm.hpp>
#include <numbers>

namespace lightloom {

inline constexpr float kPi = std::numbers::pi_v<float>;

/// Luminance weights of linear Rec.709 channels.
inline constexpr float kLumaR = 0.2126f, kLumaG = 0.7152f, kLumaB = 0.0722f;

[[nodiscard]] inline float luminance(glm::vec3 c) { return kLumaR * c.x + kLumaG * c.y + kLumaB * c.z; }

[[nodiscard]] inline float maxChannel(glm::vec3 c) { return glm::max(c.x, glm::max(c.y, c.z)); }

[[nodiscard]] inline bool isFinite(glm::vec3 v)
{
    // a sum is finite only if its terms are, or two infinities met, which gives NaN: not finite either
    const float probe = (v.x - v.x) + (v.y - v.y) + (v.z - v.z);
    return probe == 0.0f;
}

} // namespace lightloom
