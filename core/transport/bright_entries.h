// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/ray_scene.h"
#include "core/transport/surface_voxels.h"

namespace lightloom {

/// An entry that sends so much of all light that directions would meet it by chance only: a spot of sun, the floor
/// under a lamp. What it sends.
struct BrightEntry {
    std::uint32_t entry;
    glm::vec3 radiosity; ///< lm/m2
};

/// The brightest entries of those that send `lumen` each: the largest first, of equals the earlier one, at most
/// kMostBright. None where light is spread: where it counts as that of as many equal entries ((sum f)^2 / sum f^2,
/// METHODS 6) as there are directions, or as ten of the directions meet; nor where these few send less than half of it.
/// O(entries).
[[nodiscard]] std::vector<std::uint32_t> brightestOf(std::span<const float> lumen, std::size_t directions);
inline constexpr std::size_t kMostBright = 128;

/// Illuminance (lux) of an entry by light that comes straight from bright ones: a shadow ray each, from centroid to
/// centroid; each as a disc of its area (Piwowar and Malgouyres 2009, section 4), so that near ones stay finite.
[[nodiscard]] glm::vec3 luxFrom(std::span<const BrightEntry> bright, std::size_t entry, const RayScene& rays,
                                const SurfaceVoxels& voxels);

} // namespace lightloom
