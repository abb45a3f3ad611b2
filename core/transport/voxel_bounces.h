// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/exact_partners.h"

namespace lightloom {

/// Values by voxel entry, `channels` of each: red, green and blue of one light group after the other.
struct EntryValues {
    int channels = 3;
    std::vector<float> values; ///< entry e, channel c: values[e * channels + c]
    [[nodiscard]] std::size_t entries() const { return values.size() / static_cast<std::size_t>(channels); }
};

struct BounceParams {
    int directions = 512;    ///< of the first bounce; each later one has half as many, at least 64
    float leastGain = .005f; ///< bounces end when one adds less than this share, in every light group
    int mostBounces = 64;    ///< what is still missing then, and after `leastGain`, is a geometric series: it is added
};

/// What light does after it first leaves the surface: carried from entry to entry along discrete lines, all light
/// groups together, one bounce after the other (the papers of 2006 and 2009, as docs/methods/voxel-lightcuts.md has
/// it). `radiosity`: lm/m2 that leave each entry at first, reflected or emitted; `albedo`: red, green and blue of each.
/// Gives the illuminance (lux) that arrives with this light and all it becomes. What an entry receives is divided by
/// the sum of cosines of all directions that it could have come from, those where nothing was found too. O(directions x
/// entries). `rays` of the same scene look where lines lose their way (ExactPartners). The same bits on any number of
/// threads. Empty: stopped. `bounces`, where given: how many there were.
[[nodiscard]] EntryValues bounceLight(const RayScene& rays, const SurfaceVoxels& voxels, const VoxelOrders& orders,
                                      const EntryValues& radiosity, std::span<const glm::vec3> albedo,
                                      const BounceParams& params, Workers& workers, const std::stop_token& stop,
                                      int* bounces = nullptr);

} // namespace lightloom
