// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/light_reach.h"
#include "core/voxel/voxel_field.h"
#include <optional>

namespace lightloom {

/// What of a scene is too fine for a bake's voxels, as far as that can be told without baking again.
struct VoxelAdvice {
    float cellSize = 0.0f; ///< metres
    /// Share of the reached surface that stands nearer than two voxels before other surface: such gaps close up.
    double inGaps = 0.0;
    struct Gap {
        glm::vec3 at{0.0f}; ///< scene space
        float width = 0.0f; ///< metres
    };
    std::optional<Gap> gap; ///< one of them, of middling width; nothing: there are none
    /// A light group that is on: as how many equal entries those count that send its first light on
    /// ((sum f)^2 / sum f^2, METHODS 6), and whether so few send it that they are connected by shadow rays.
    struct Lamp {
        int group = 0;
        double emitters = 0.0;
        bool isConnected = false;
    };
    std::vector<Lamp> lamps; ///< those that light anything
};

/// `points` of the reached surface (samplePoints): a ray from each. `directions` of the bake. Milliseconds; any thread.
[[nodiscard]] VoxelAdvice voxelAdvice(const RayScene& rays, std::span<const SurfacePoint> points,
                                      const VoxelField& field, int directions);

/// What a designer should know of it, a sentence each; nothing: nothing. Lamps by their labels, places in the file's
/// frame.
[[nodiscard]] std::vector<std::string> adviceLines(const VoxelAdvice& advice, const Scene& scene);

} // namespace lightloom
