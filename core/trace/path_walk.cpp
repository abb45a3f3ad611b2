// SPDX-License-Identifier: Apache-2.0
#include "core/trace/path_walk.h"
#include "core/base/units.h"
#include "core/trace/medium.h"
#include <limits>

namespace lightloom {
namespace {

constexpr int kSureBounces = 3; ///< roulette from the next one on
constexpr float kFar = std::numeric_limits<float>::infinity();

} // namespace

PathWalk::PathWalk(const RayScene& rays, const LightSampler& lights, const Mix& mix, const CausticLamps* byPhotons)
    : rays_(rays), lights_(lights), mix_(mix), choice_(lights, mix), byPhotons_(byPhotons)
{
}

glm::vec3 PathWalk::emitted(const Hit& hit, const Surface& surface) const
{
    const int e = lights_.emitterOf(hit.triangle);
    if (e < 0) return glm::vec3(0.0f);
    return surface.emission * gainOf(mix_, lights_.emitters()[static_cast<std::size_t>(e)].group);
}

glm::vec3 PathWalk::reflected(Hit hit, Surface surface, glm::vec3 travel, int pathDepth, Rng& rng) const
{
    glm::vec3 light(0.0f), throughput(1.0f);
    Medium medium;
    if (medium.absorbs(hit, surface)) throughput *= medium.transmittance(hit, surface);
    for (int depth = 1;; ++depth) {
        const glm::vec3 n = hit.facing(), toEye = -travel, start = rays_.leave(hit.position, n);
        light += throughput * fromLamps(surface, start, n, toEye, rng);
        Scatter next;
        const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
        if (depth >= pathDepth || !scatter(surface, n, toEye, u, next)) return light;
        throughput *= next.radianceWeight();
        if (depth > kSureBounces) {
            // the root: paths live twice as long as the light does, which thirds the variance at albedo .8 and
            // halves variance x time there; at .5 it costs a tenth more
            const float chance = glm::min(clearChance(surface, depth), std::sqrt(maxChannel(next.weight)));
            if (!(rng.uniform() < chance)) return light;
            throughput /= chance;
        }
        travel = next.away;
        medium.cross(hit, surface, next);
        const glm::vec3 from = rays_.leave(hit.position, next.side(n));
        if (!rays_.intersect(from, travel, kFar, hit)) return light;
        surface = surfaceAt(rays_, hit);
        if (medium.absorbs(hit, surface)) throughput *= medium.transmittance(hit, surface);
        const glm::vec3 emission = emitted(hit, surface);
        if (emission != glm::vec3(0.0f)) light += throughput * emission * lobeShare(next, from, hit);
    }
}

/// One lamp, chosen by what it could give.
glm::vec3 PathWalk::fromLamps(const Surface& surface, glm::vec3 p, glm::vec3 n, glm::vec3 toEye, Rng& rng) const
{
    const float u = rng.uniform();
    const glm::vec2 where(rng.uniform(), rng.uniform());
    float chance = 0.0f;
    LightSample s;
    const int e = choice_.pick(p, u, chance);
    if (e < 0 || !lights_.sample(e, p, where, s)) return glm::vec3(0.0f);
    const float cosine = glm::dot(n, s.toLight);
    if (!(cosine > 0.0f)) return glm::vec3(0.0f);
    const glm::vec3 f = brdf(surface, n, s.toLight, toEye);
    if (f == glm::vec3(0.0f) || rays_.isBlocked(p, s.end)) return glm::vec3(0.0f);
    const glm::vec3 reflected = f * gainOf(mix_, lights_.emitters()[static_cast<std::size_t>(e)].group) * cosine;
    if (s.isPunctual()) return reflected * s.illuminance / chance;
    return reflected * s.radiance / (chance * s.pdf + scatterPdf(surface, n, s.toLight, toEye));
}

/// The lobe's weight for an emitter that its ray met by chance.
float PathWalk::lobeShare(const Scatter& lobe, glm::vec3 from, const Hit& hit) const
{
    if (lobe.isMirror) return byPhotons_ && byPhotons_->has(lights_.emitterOf(hit.triangle)) ? 0.0f : 1.0f;
    const float lamps = choice_.chance(from, lights_.emitterOf(hit.triangle)) * lights_.pdf(from, hit);
    return lobe.pdf / (lobe.pdf + lamps);
}

glm::vec3 PathWalk::radiance(glm::vec3 origin, glm::vec3 travel, bool withEmission, int pathDepth, Rng& rng) const
{
    Hit hit;
    if (!rays_.intersect(origin, travel, kFar, hit)) return glm::vec3(0.0f);
    const Surface surface = surfaceAt(rays_, hit);
    const glm::vec3 own = withEmission ? emitted(hit, surface) : glm::vec3(0.0f);
    return own + reflected(hit, surface, travel, pathDepth, rng);
}

} // namespace lightloom
