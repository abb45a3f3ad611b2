// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/voxel_bounces.h"

namespace lightloom {

/// Whom the surface of voxel entries sees, by a few exact rays of each. Discrete lines lose or gain about a per cent of
/// the light at a bounce where a scene is finer than its voxels, alike over whole rooms; rays make each entry noisy
/// instead, which is no good to look at, but what many thousand entries send to a place evens out. So this is for the
/// light of discs in a cut.
class RayPartners {
public:
    /// `count` rays of each entry from points spread over its surface, distributed by the cosine. Those of entry e
    /// depend on (seed, e) alone: the same on any number of threads. 4 bytes a ray. Null: stopped.
    [[nodiscard]] static std::shared_ptr<const RayPartners> trace(const RayScene& rays, const LightReach& reach,
                                                                  const SurfaceVoxels& voxels, int count,
                                                                  std::uint64_t seed, Workers& workers,
                                                                  const std::stop_token& stop);

    /// Illuminance (lux) of `radiosity` (lm/m2 that leave each entry at first) and all it becomes, as `bounceLight` has
    /// it: the fixed point of E = mean over an entry's rays of what they meet, radiosity + albedo E. Looked for from
    /// `guess` on, each light group by itself, until a step changes the group's light by less than `leastChange`. The
    /// same bits on any number of threads. Empty: stopped.
    [[nodiscard]] EntryValues bounced(const EntryValues& radiosity, std::span<const glm::vec3> albedo,
                                      const EntryValues& guess, Workers& workers, const std::stop_token& stop,
                                      double leastChange = 1e-3) const;

    /// Of each entry, the share of its rays that begin in the open, 0 to 1: a ray that meets a side of the surface that
    /// light does not reach comes from where the entry's own surface is hidden too, in a block that stands on it or
    /// within another body. `bounced` counts these rays as dark; `ofOpen` is the light of the rest alone, 0 where there
    /// is none.
    [[nodiscard]] const std::vector<float>& open() const { return open_; }
    [[nodiscard]] EntryValues ofOpen(EntryValues bounced) const;
    [[nodiscard]] EntryValues ofAll(EntryValues ofOpen) const; ///< the other way

    [[nodiscard]] std::size_t memoryBytes() const
    {
        return met_.size() * sizeof(std::uint32_t) + 2 * open_.size() * sizeof(float);
    }

private:
    std::size_t count_ = 0;
    std::vector<float> areas_, open_; // of entries, m2; see above
    std::vector<std::uint32_t> met_;  // entry that ray i of entry e meets: [e * count_ + i]
};

} // namespace lightloom
