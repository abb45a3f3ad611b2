// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <glm/glm.hpp>

namespace lightloom {

/// A direction in 8 + 8 bits (paper, figure 8): theta = acos(z) in 255 steps of the half turn, high byte; phi in 256
/// steps of the whole turn, low byte. Rounded, phi wraps; worst error .79 degrees.
[[nodiscard]] std::uint16_t packDirection(glm::vec3 unit);
[[nodiscard]] glm::vec3 unpackDirection(std::uint16_t packed);

} // namespace lightloom
