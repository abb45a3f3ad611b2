// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/trace/light_sampler.h"
#include "core/trace/material.h"

namespace lightloom {

/// Direct and indirect illuminance at a point with standard errors, lux per channel.
struct ProbeLight {
    glm::vec3 direct{0.0f}, indirect{0.0f};
    glm::vec3 directError{0.0f}, indirectError{0.0f}; ///< standard errors of the means
};

/// Radiance (cd/m2) that arrives at `origin` from direction -`travel` along one path: what the first surface emits
/// included only when `withEmission`; further on next event estimation with multiple importance sampling. Unbiased up
/// to `pathDepth` surfaces. Caustics of punctual lights are out of its reach.
[[nodiscard]] glm::vec3 tracePath(const RayScene& rays, const LightSampler& lights, const Mix& mix, glm::vec3 origin,
                                  glm::vec3 travel, bool withEmission, int pathDepth, Rng& rng);

struct ReferenceJob {
    std::uint64_t seed = 1;
    int paths = 1024;       ///< most paths per probe; rounded up to whole batches of 64, at least two
    float targetError = 0;  ///< stop a probe when the luminances of its standard errors, direct and indirect each, are
                            ///< at most this fraction of their means over all probes; 0: use all paths
    int pathDepth = 1024;   ///< surfaces per path. A safety net far behind the roulette: a shorter one loses light
    int directSamples = 64; ///< shadow rays per batch, shared by the surface emitters; at least one each
};
struct ProbePoint {
    glm::vec3 position, normal; ///< scene space; normal unit
    std::uint64_t stream = 0;   ///< key of the point's own random numbers
};

struct ReferenceResult {
    std::vector<ProbeLight> probes;
    std::size_t finished = 0;
    std::uint64_t paths = 0;      ///< traced, over all probes
    std::uint64_t leastPaths = 0; ///< at the probe that got fewest
};

/// Path-traced illuminance at probes: the judge of all caches. Shares the scene, the emitters and Embree with them and
/// no approximation. Cosine-distributed first directions, jittered 8 x 8 per batch; next event estimation and lobe
/// sampling joined by the balance heuristic, for direct light too; roulette after the third bounce; no clamp.
/// "Direct" comes straight from an emitter, "indirect" is the rest, lamps seen in mirrors included.
/// Standard errors from the spread of batches: with few batches they are rough themselves. The same bits on any number
/// of threads. On a stop `finished` tells how many of the first probes are as good as was asked; later ones hold what
/// their batches so far say, or zero.
[[nodiscard]] ReferenceResult referenceIlluminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                                   const std::vector<ProbePoint>& points, const ReferenceJob& job,
                                                   Workers& workers, const std::stop_token& stop,
                                                   const std::function<void(double fraction)>& progress = {});

} // namespace lightloom
