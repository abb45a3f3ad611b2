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
    /// Share of it on walls, boards and columns that are thinner than a voxel and lit from behind as well, and of these
    /// where one side has ten times the light of the other: of bright light 1.6 % may get through such a wall
    /// (wallsWithinAVoxelDoNotLeak), which counts there alone.
    double onThin = 0.0, onThinBeforeDark = 0.0;
    std::optional<Gap> thin; ///< one of the latter, likewise; width is the thickness
    /// A light group that is on: as how many equal entries those count that send its first light on
    /// ((sum f)^2 / sum f^2, METHODS 6), and whether so few send it that they are connected by shadow rays.
    struct Lamp {
        int group = 0;
        double emitters = 0.0;
        bool isConnected = false;
    };
    std::vector<Lamp> lamps; ///< those that light anything
};

/// `points` of the reached surface `reach` (samplePoints): two rays from each. `directions` of the bake. Milliseconds;
/// any thread.
[[nodiscard]] VoxelAdvice voxelAdvice(const RayScene& rays, const LightReach& reach,
                                      std::span<const SurfacePoint> points, const VoxelField& field, int directions);

/// What a designer should know of it, a sentence each; nothing: nothing. Lamps by their labels, places in the file's
/// frame.
[[nodiscard]] std::vector<std::string> adviceLines(const VoxelAdvice& advice, const Scene& scene);

} // namespace lightloom
