// SPDX-License-Identifier: Apache-2.0
#include "core/octree/entry_side.h"
#include "core/base/units.h"
#include "core/octree/vdl_codec.h"
#include "shaders/common.h"
#include <algorithm>
#include <cmath>

namespace lightloom {

std::uint16_t packSide(glm::vec3 normal, glm::vec3 towards, float least)
{
    // relative to the normal as pixels know it
    const glm::vec3 n = unpackDirection(packDirection(normal));
    const float x = glm::dot(towards, shader::sideDirection(n, 0)), y = glm::dot(towards, shader::sideDirection(n, 64));
    const auto angle = static_cast<unsigned>(std::lround(std::atan2(y, x) / (2.0f * kPi) * 256.0f)) & 255u;
    const long steps = std::lround(glm::clamp(least, -2.0f, 2.0f) * shader::kSideSteps) + 128;
    if (steps < 1) return 0;
    return static_cast<std::uint16_t>(angle << 8 | static_cast<unsigned>(std::min(steps, 255l)));
}

bool isBeyond(const OctreeEntry& entry, glm::vec3 fromMiddle)
{
    if (entry.side == 0) return false;
    const glm::vec3 n = unpackDirection(packDirection(entry.normal));
    return shader::isBeyondSide(n, entry.side >> 8u, entry.side & 255u, fromMiddle);
}

} // namespace lightloom
