// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"
#include <optional>

namespace lightloom {

/// Two faces that turn their backs to each other, with nothing between.
struct ThinWall {
    float thickness = 0.0f; ///< metres, along the normal of the first face
    glm::vec3 at{0.0f};     ///< on the first face, scene space
};

struct ThinWallSearch {
    std::optional<ThinWall> thinnest;
    int samples = 0; ///< rays sent; 0: the scene has too many triangles to look
};

/// The thinnest wall met by rays that go straight into the model from `samples` points, area-uniform over all faces.
/// A wall is what ends at a face turned the other way within 26 degrees, with both faces in the open: where bodies
/// stand in each other there is none, nor where a sheet has nothing behind. The same scene gives the same answer; work
/// is capped by counts (4 million triangles, 50 million triangle tests), about half a second at most. Not every thin
/// place is found: one that covers a share a of the surface is missed with probability (1 - a)^samples.
[[nodiscard]] ThinWallSearch findThinWalls(const Scene& scene, int samples = 4096);

} // namespace lightloom
