// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/atlas/atlas.h"

namespace lightloom {

/// The scene with vertices split where the atlas has seams, one mesh per instance, and where each vertex lies in it.
struct UnwrappedScene {
    Scene scene;
    std::vector<std::vector<glm::vec2>> uv; ///< by mesh and vertex, (0,0) at the top left
};

/// Triangles of which both sides have a place appear twice, once turned over, and their material becomes single-sided;
/// where only one side has a place both show it; where none has, the black corner.
[[nodiscard]] UnwrappedScene unwrappedScene(const RayScene& rays, const Atlas& atlas);

} // namespace lightloom
