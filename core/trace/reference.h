// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/crossed_mean.h"
#include "core/base/parallel.h"
#include "core/trace/caustic_light.h"

namespace lightloom {

/// Direct and indirect illuminance at a point with standard errors, lux per channel.
struct ProbeLight {
    glm::vec3 direct{0.0f}, indirect{0.0f};
    glm::vec3 directError{0.0f}, indirectError{0.0f}; ///< standard errors of the means
    glm::vec3 caustic{0.0f};                          ///< the part of `indirect` that photons brought
    float causticBlur = 0.0f;                         ///< bound on its blur (luminance, lux): not in the errors
};

struct ProbePoint {
    glm::vec3 position, normal; ///< scene space; normal unit
    std::uint64_t stream = 0;   ///< key of the point's own random numbers
};

struct ReferenceJob {
    std::uint64_t seed = 1;
    int paths = 1024;       ///< most paths per probe; rounded up to whole batches of 64, at least two
    float targetError = 0;  ///< trace each probe until the luminances of its standard errors, direct and indirect each,
                            ///< are expected at this fraction of their means over all probes; 0: use all paths
    int pathDepth = 1024;   ///< surfaces per path. A safety net far behind the roulette: a shorter one loses light
    int directSamples = 64; ///< shadow rays per batch, shared by the surface emitters; at least one each
    bool caustics = true;   ///< photons for small lamps by way of mirrors, one round per batch, at least 16
};

/// All that a run has found so far. Plain data: kept in files, and gone on with to the same bits.
struct ReferenceState {
    std::vector<CrossedMean<6>> probes; ///< lux: direct R G B, indirect R G B
    glm::dvec2 goal{-1.0};              ///< errors at which a probe is done, direct and indirect; negative: none yet
    std::vector<CausticSums> caustics;  ///< by probe; empty where the scene has no such light
    std::uint64_t causticRounds = 0;
};

struct ReferenceResult {
    std::vector<ProbeLight> probes;
    std::size_t finished = 0;         ///< so many of the first probes are as was asked
    std::uint64_t paths = 0;          ///< traced, over all probes
    std::uint64_t leastPaths = 0;     ///< at the probe that got fewest
    std::size_t capped = 0;           ///< probes that used all paths before they met the target
    std::uint64_t causticPhotons = 0; ///< shot by lamps that photons follow; 0: there are none, or no mirrors
    double causticRadius = 0.0;       ///< metres over which their light is averaged: mean over rounds and probes
};

/// Photons that a job without a target shoots for small lamps by way of mirrors, where there are such.
[[nodiscard]] std::uint64_t mostCausticPhotons(const ReferenceJob& job);

/// Path-traced illuminance at probes: the judge of all caches. Shares the scene, the emitters and Embree with them and
/// no approximation. Cosine-distributed first directions, jittered 8 x 8 per batch; next event estimation and lobe
/// sampling joined by the balance heuristic, for direct light too; roulette after the third bounce; no clamp.
/// "Direct" comes straight from an emitter, "indirect" is the rest, lamps seen in mirrors included. Light of punctual
/// and small lamps that meets a mirror first comes by photons (CausticLamps), averaged over small discs: its blur is
/// declared beside its standard error.
/// Standard errors from the spread of batches: with few batches they are rough themselves. With a target the number of
/// batches is chosen without bias (CrossedMean): errors then lie around the target, not all below it. The same bits on
/// any number of threads. On a stop, what the batches so far say; `finished` tells how far it came.
[[nodiscard]] ReferenceResult referenceIlluminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                                   const std::vector<ProbePoint>& points, const ReferenceJob& job,
                                                   Workers& workers, const std::stop_token& stop,
                                                   const std::function<void(double fraction)>& progress = {});

/// The same, going on from `state`: empty, or what a stopped run of this job left, or a run of another job that only
/// asked for fewer paths, both without a target. However often it was stopped, the end is the same, to the bit.
[[nodiscard]] ReferenceResult continueReference(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                                const std::vector<ProbePoint>& points, const ReferenceJob& job,
                                                ReferenceState& state, Workers& workers, const std::stop_token& stop,
                                                const std::function<void(double fraction)>& progress = {});

/// What `state` says of `job`, without tracing anything.
[[nodiscard]] ReferenceResult resultOf(const ReferenceState& state, const ReferenceJob& job);

} // namespace lightloom
