// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/atlas/atlas.h"
#include <memory>

namespace lightloom {

struct AtlasVertex {
    glm::vec3 position; ///< scene space
    glm::vec2 uv;       ///< in the atlas
};

/// An atlas as plain arrays for the GPU: the texels to be lit, and the scene's triangles with their places.
struct AtlasDraw {
    int size = 0;                              ///< texels a side
    std::vector<glm::vec4> positions, normals; ///< per texel, scene space; w of position: 1 where it shows surface
    std::vector<std::int32_t> owners;          ///< per texel: its chart, -1: none
    std::vector<AtlasVertex> vertices;         ///< three per side that is drawn, counter-clockwise as seen from it
    AtlasReport report;
};
[[nodiscard]] std::shared_ptr<const AtlasDraw> makeAtlasDraw(const RayScene& rays, const Atlas& atlas);

} // namespace lightloom
