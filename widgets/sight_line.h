// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <glm/glm.hpp>
#include <optional>

namespace lightloom {

/// A line of sight through the picture.
struct SightLine {
    glm::vec3 eye{0.0f}, along{0.0f, 0.0f, -1.0f}; ///< scene space, unit
};

/// How far along the axis (unit) through `p` its point nearest to the line of sight lies. Nothing: they run alike.
[[nodiscard]] std::optional<float> alongAxis(glm::vec3 p, glm::vec3 axis, const SightLine& sight);

/// Where the line of sight meets the plane through `p` across `n` (unit). Nothing: behind the eye, or they run alike.
[[nodiscard]] std::optional<glm::vec3> onPlane(glm::vec3 p, glm::vec3 n, const SightLine& sight);

} // namespace lightloom
