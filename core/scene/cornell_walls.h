// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene_builder.h"

/// What the Cornell box and the figure scene share.
namespace lightloom {

struct CornellMaterials {
    int white, red, green, lamp;
    std::uint64_t triangles; ///< of walls and lamp together
};
/// Floor, walls, ceiling and the lamp in it.
CornellMaterials addCornellWalls(SceneBuilder& builder);
void addCornellCameras(SceneBuilder& builder);

} // namespace lightloom
