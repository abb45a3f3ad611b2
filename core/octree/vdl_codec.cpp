// SPDX-License-Identifier: Apache-2.0
#include "core/octree/vdl_codec.h"
#include "core/base/units.h"
#include <cmath>

namespace lightloom {

std::uint16_t packDirection(glm::vec3 d)
{
    const float theta = std::acos(glm::clamp(d.z, -1.0f, 1.0f));
    const float phi = std::atan2(d.y, d.x); // of (0,0): 0
    const auto high = static_cast<unsigned>(std::lround(theta / kPi * 255.0f));
    const long turn = std::lround(phi / (2.0f * kPi) * 256.0f);
    return static_cast<std::uint16_t>(high << 8 | (static_cast<unsigned>(turn) & 255u));
}

glm::vec3 unpackDirection(std::uint16_t packed)
{
    const float theta = static_cast<float>(packed >> 8) * (kPi / 255.0f);
    const float phi = static_cast<float>(packed & 255) * (2.0f * kPi / 256.0f);
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

} // namespace lightloom
