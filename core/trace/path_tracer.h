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

/// Radiance (cd/m2) that arrives at `origin` from direction -`travel` along one path: emission included only when
/// `withEmission` (the first segment), next event estimation with multiple importance sampling further on.
[[nodiscard]] glm::vec3 tracePath(const RayScene& rays, const LightSampler& lights, const Mix& mix, glm::vec3 origin,
                                  glm::vec3 travel, bool withEmission, int pathDepth, Rng& rng);

struct ReferenceJob {
    std::uint64_t seed = 1;
    int paths = 1024;      ///< most paths per probe; rounded up to whole batches of 64
    float targetError = 0; ///< stop a probe when its standard error is below this fraction of the mean over all probes
    int pathDepth = 64;
    int directSamples = 64;
};
struct ProbePoint {
    glm::vec3 position, normal; ///< scene space; normal unit
    std::uint64_t stream = 0;   ///< key of the point's own random numbers
};

/// Path-traced illuminance at probes: the judge of all caches. Shares the scene and Embree with them and nothing else.
/// Stratified cosine-distributed first segment, next event estimation with MIS, roulette after the third bounce
/// (METHODS section 7). Standard errors from batches. The same bits on any number of threads. On a stop, what is
/// finished is returned and `finished` tells how many points are.
struct ReferenceResult {
    std::vector<ProbeLight> probes;
    std::size_t finished = 0;
    std::uint64_t paths = 0;
};
[[nodiscard]] ReferenceResult referenceIlluminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                                   const std::vector<ProbePoint>& points, const ReferenceJob& job,
                                                   Workers& workers, const std::stop_token& stop,
                                                   const std::function<void(double fraction)>& progress = {});

} // namespace lightloom
