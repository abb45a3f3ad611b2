// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene_builder.h"
#include "core/trace/photon_tracer.h"
#include "core/trace/reference.h"
#include "tests/light_helpers.h"

/// What tests of glass share: exact formulas in double, and photons and paths counted.
namespace lightloom::test {

/// Fresnel's share, straight from the textbook.
inline double fresnelAgain(double sine, double n)
{
    const double in = std::sqrt(1.0 - sine * sine), out = std::sqrt(1.0 - sine * sine / (n * n));
    const double s = (in - n * out) / (in + n * out), p = (n * in - out) / (n * in + out);
    return 0.5 * (s * s + p * p);
}

/// What gets through two borders with all passes between them; `inside` is left of the light after one pass.
inline double slabThrough(double sine, double n, double inside = 1.0)
{
    const double f = fresnelAgain(sine, n);
    return (1.0 - f) * (1.0 - f) * inside / (1.0 - f * f * inside * inside);
}

inline ReferenceResult traceProbes(const LitScene& lit, const std::vector<ProbePoint>& probes, int paths,
                                   int pathDepth = 1024, bool caustics = true)
{
    ReferenceJob job;
    job.paths = paths;
    job.pathDepth = pathDepth;
    job.caustics = caustics;
    Workers workers(2);
    return referenceIlluminance(*lit.rays, *lit.lights, {}, probes, job, workers, {});
}

inline std::shared_ptr<const PhotonPaths> shootPhotons(const LitScene& lit, std::uint64_t count, std::uint64_t seed = 1,
                                                       int pathDepth = 64)
{
    PhotonJob job;
    job.count = count;
    job.seed = seed;
    job.pathDepth = pathDepth;
    Workers workers(2);
    return tracePhotons(*lit.rays, *lit.lights, job, workers, {});
}

/// Lumen (first channel) of the photons for which `counts`, over several seeds.
template<class Counts>
RunningMean storedFlux(const LitScene& lit, std::uint64_t count, int seeds, int pathDepth, Counts counts)
{
    RunningMean mean;
    for (int seed = 1; seed <= seeds; ++seed) {
        double sum = 0.0;
        const auto paths = shootPhotons(lit, count, std::uint64_t(seed), pathDepth);
        for (const Photon& p : paths->photons) sum += counts(p) ? double(p.flux.x) : 0.0;
        mean.add(sum);
    }
    return mean;
}

} // namespace lightloom::test
