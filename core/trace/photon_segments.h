// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/photon_tracer.h"
#include <limits>
#include <span>

namespace lightloom {

/// A straight part of a photon's way that carries indirect light: behind its first surface, as for stored photons.
struct PhotonSegment {
    static constexpr float kEndless = std::numeric_limits<float>::infinity();
    static constexpr std::uint32_t kNowhere = ~std::uint32_t{0};
    glm::vec3 from;                    ///< scene space
    glm::vec3 travel;                  ///< unit
    glm::vec3 flux;                    ///< lumen per channel, divided by the number shot
    float length;                      ///< metres; kEndless: it left the scene
    std::uint32_t triangle = kNowhere; ///< on which it ends
};

/// What one block of photons left behind.
struct SegmentBlock {
    RawVector<PhotonSegment> segments; ///< in an order that is always the same
    PhotonPaths counts;                ///< without photons; `shot` is the block's own
    std::uint64_t stored = 0;          ///< photons that a photon map would keep
};

inline constexpr std::uint64_t kSegmentBlock = 4096; ///< photons per block
[[nodiscard]] inline std::uint64_t segmentBlocks(std::uint64_t photons)
{
    return (photons + kSegmentBlock - 1) / kSegmentBlock;
}

/// Shoots the photons of blocks `first`, `first + 1`, ... of a job, one for each of `blocks`, and lists their indirect
/// segments there; memory that `blocks` hold is used again. The photons are those of `tracePhotons`: the same on any
/// number of threads, whichever blocks are asked for together. False: stopped, `blocks` are of no use.
[[nodiscard]] bool traceSegments(const RayScene& rays, const LightSampler& lights, const PhotonJob& job,
                                 std::uint64_t first, std::span<SegmentBlock> blocks, Workers& workers,
                                 const std::stop_token& stop);

} // namespace lightloom
