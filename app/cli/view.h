// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "app/cli/methods.h"
#include "core/bake/render_view.h"

/// What render and compare share: which picture of a scene is meant.
namespace lightloom::cli {

/// The scene's camera of that name or number (from 0); the first without a name. A scene without cameras is seen from
/// the front, with a warning.
[[nodiscard]] Result<Camera> cameraNamed(const Context& context, const Scene& scene, const std::string& name,
                                         float aspect);

/// The picture as the lighting's parameters ask for it.
[[nodiscard]] ViewJob viewJob(const Lighting& lighting, const Camera& camera, int width, int height);

} // namespace lightloom::cli
