// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <glm/glm.hpp>

namespace lightloom {

/// Neutral greys, because the colour of light is judged beside them; one accent for what is active. Text contrast is
/// above 4.5:1 in both.
enum class Theme { dark, light };

/// Sets style and palette of the whole application.
void applyTheme(Theme theme);
/// Behind the scene in the viewport, as shown.
[[nodiscard]] glm::vec3 viewportBackground(Theme theme);

} // namespace lightloom
