// SPDX-License-Identifier: Apache-2.0
#include "core/trace/final_gather.h"
#include "core/base/low_discrepancy.h"
#include "core/base/sampling.h"
#include "core/trace/medium.h"
#include <limits>

namespace lightloom {
namespace {

constexpr int kSureBounces = 3;  ///< after these, roulette
constexpr int kMostBounces = 32; ///< between facing mirrors, say

/// One gather ray and whatever it has to follow: mirrors, glass and gloss always, matt surfaces where the cache has
/// nothing.
class GatherRay {
public:
    GatherRay(const RayScene& rays, const LightSampler& lights, const Mix& mix, const CachedIndirect& cached,
              int directSamples, Rng& rng)
        : rays_(rays), lights_(lights), mix_(mix), cached_(cached), directSamples_(directSamples), rng_(rng)
    {
    }

    glm::vec3 radiance(glm::vec3 origin, glm::vec3 travel)
    {
        glm::vec3 light(0.0f), throughput(1.0f);
        bool seesLamps = false; // only a mirror or glass: other light from lamps is taken at the hit before
        Medium medium;
        for (int bounce = 1;; ++bounce) {
            Hit hit;
            if (!rays_.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) return light;
            const Surface surface = surfaceAt(rays_, hit);
            if (medium.absorbs(hit, surface)) throughput *= medium.transmittance(hit, surface);
            const int e = seesLamps ? lights_.emitterOf(hit.triangle) : -1;
            if (e >= 0) {
                const int group = lights_.emitters()[static_cast<std::size_t>(e)].group;
                light += throughput * surface.emission * gainOf(mix_, group);
            }
            const glm::vec3 n = hit.facing();
            bool isCached = false;
            light += throughput * leaving(surface, hit.position, n, -travel, isCached);
            if (bounce >= kMostBounces || !goOn(surface, n, -travel, isCached, bounce, throughput)) return light;
            seesLamps = next_.isMirror;
            travel = next_.away;
            medium.cross(hit, surface, next_);
            origin = rays_.leave(hit.position, next_.side(n));
        }
    }

private:
    glm::vec3 leaving(const Surface& surface, glm::vec3 p, glm::vec3 n, glm::vec3 toEye, bool& isCached)
    {
        glm::vec3 light = directGlossy(rays_, lights_, mix_, surface, p, n, toEye, directSamples_, rng_);
        glm::vec3 indirect(0.0f);
        isCached = cached_ && cached_(p, n, indirect);
        if (surface.diffuse != glm::vec3(0.0f)) {
            const glm::vec3 direct = directIlluminance(rays_, lights_, mix_, p, n, directSamples_, rng_);
            light += surface.diffuse / kPi * (direct + (isCached ? indirect : glm::vec3(0.0f)));
        }
        return light;
    }

    bool goOn(Surface surface, glm::vec3 n, glm::vec3 toEye, bool isCached, int bounce, glm::vec3& throughput)
    {
        if (isCached) surface.diffuse = glm::vec3(0.0f);
        const glm::vec3 u(rng_.uniform(), rng_.uniform(), rng_.uniform());
        if (!scatter(surface, n, toEye, u, next_)) return false;
        throughput *= next_.radianceWeight();
        if (bounce < kSureBounces) return true;
        const float chance = glm::min(1.0f, maxChannel(next_.weight));
        if (!(rng_.uniform() < chance)) return false;
        throughput /= chance;
        return true;
    }

    const RayScene& rays_;
    const LightSampler& lights_;
    const Mix& mix_;
    const CachedIndirect& cached_;
    int directSamples_;
    Rng& rng_;
    Scatter next_;
};

} // namespace

glm::vec3 gatherIndirect(const RayScene& rays, const LightSampler& lights, const Mix& mix, const CachedIndirect& cached,
                         glm::vec3 p, glm::vec3 n, int count, int directSamples, Rng& rng)
{
    if (count < 1) return glm::vec3(0.0f);
    GatherRay ray(rays, lights, mix, cached, directSamples, rng);
    const ShiftedPoints points(count, rng);
    const Frame frame(n);
    const glm::vec3 start = rays.leave(p, n);
    glm::dvec3 sum(0.0);
    for (int i = 0; i < count; ++i) {
        const glm::vec2 u = points[i];
        sum += glm::dvec3(ray.radiance(start, frame.toWorld(sampleCosineHemisphere(u.x, u.y))));
    }
    return glm::vec3(sum * (static_cast<double>(kPi) / count));
}

} // namespace lightloom
