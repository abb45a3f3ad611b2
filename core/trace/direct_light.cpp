// SPDX-License-Identifier: Apache-2.0
#include "core/trace/direct_light.h"
#include "core/base/low_discrepancy.h"
#include "core/base/units.h"
#include <limits>

namespace lightloom {
namespace {

/// Mean and spread of what the samples of one emitter say.
struct SampleSum {
    glm::dvec3 sum{0.0}, squares{0.0};
    void add(glm::vec3 v)
    {
        const glm::dvec3 d(v);
        sum += d;
        squares += d * d;
    }
    [[nodiscard]] glm::dvec3 varianceOfMean(int count) const
    {
        if (count < 2) return sum * sum; // one sample says nothing of its spread: as large as itself
        const double n = count;
        return glm::max(glm::dvec3(0.0), squares - sum * sum / n) / (n * (n - 1.0));
    }
};

/// Samples each lamp that is on, as seen from `p`: `done(emitter, found, count)` gets the sum of `value(sample,
/// cosine)` over those of `count` samples that nothing blocks. A surface has `samples` of them, other lamps one.
template<class Value, class Done>
void sampleLamps(const RayScene& rays, const LightSampler& lights, const Mix& mix, glm::vec3 p, glm::vec3 n,
                 int samples, Rng& rng, Value value, Done done)
{
    const glm::vec3 start = rays.leave(p, n);
    for (std::size_t e = 0; e < lights.emitters().size(); ++e) {
        const Emitter& emitter = lights.emitters()[e];
        const glm::vec3 gain = gainOf(mix, emitter.group);
        const int count = emitter.kind == Emitter::Kind::surface ? samples : 1;
        if (gain == glm::vec3(0.0f) || count < 1) continue;
        SampleSum found;
        const ShiftedPoints points(count, rng);
        for (int i = 0; i < count; ++i) {
            LightSample s;
            if (!lights.sample(static_cast<int>(e), p, points[i], s)) continue;
            const float cosine = glm::dot(n, s.toLight);
            if (!(cosine > 0.0f) || rays.isBlocked(start, s.end)) continue;
            found.add(gain * value(s, cosine));
        }
        done(emitter, found, count);
    }
}

/// Glossy light by sampling the lobe: what its rays find of surface emitters, weighted against light sampling.
glm::vec3 glossyFromLobe(const RayScene& rays, const LightSampler& lights, const Mix& mix, const Surface& glossy,
                         glm::vec3 p, glm::vec3 n, glm::vec3 toEye, int samples, Rng& rng)
{
    glm::vec3 sum(0.0f);
    const ShiftedPoints points(samples, rng);
    const glm::vec3 start = rays.leave(p, n);
    for (int i = 0; i < samples; ++i) {
        Scatter away;
        Hit hit;
        const glm::vec2 u = points[i];
        if (!scatter(glossy, n, toEye, {u.x, u.y, 0.0f}, away)) continue;
        if (!rays.intersect(start, away.away, std::numeric_limits<float>::infinity(), hit)) continue;
        const int e = lights.emitterOf(hit.triangle);
        if (e < 0) continue;
        const glm::vec3 emission = surfaceAt(rays, hit).emission;
        const glm::vec3 gain = gainOf(mix, lights.emitters()[static_cast<std::size_t>(e)].group);
        sum += away.weight * emission * gain * (away.pdf / (away.pdf + lights.pdf(p, hit)));
    }
    return sum / static_cast<float>(samples);
}

} // namespace

bool isLit(const RayScene& rays, const LightSampler& lights, int emitter, glm::vec3 p, glm::vec3 n, glm::vec2 u)
{
    LightSample light;
    return lights.sample(emitter, p, u, light) && glm::dot(light.toLight, n) > 0.0f && !rays.isBlocked(p, light.end);
}

glm::vec3 directIlluminance(const RayScene& rays, const LightSampler& lights, const Mix& mix, glm::vec3 p, glm::vec3 n,
                            int samples, Rng& rng, glm::vec3* squaredError)
{
    glm::dvec3 total(0.0), variance(0.0);
    sampleLamps(
        rays, lights, mix, p, n, samples, rng,
        [](const LightSample& s, float cosine) {
            return s.isPunctual() ? s.illuminance * cosine : s.radiance * (cosine / s.pdf);
        },
        [&](const Emitter& emitter, const SampleSum& found, int count) {
            total += found.sum / static_cast<double>(count);
            if (emitter.kind == Emitter::Kind::surface) variance += found.varianceOfMean(count);
        });
    if (squaredError) *squaredError = glm::vec3(variance);
    return glm::vec3(total);
}

glm::vec3 directGlossy(const RayScene& rays, const LightSampler& lights, const Mix& mix, const Surface& surface,
                       glm::vec3 p, glm::vec3 n, glm::vec3 toEye, int samples, Rng& rng)
{
    if (!surface.hasSpecular() || surface.isMirror()) return glm::vec3(0.0f);
    Surface glossy = surface;
    glossy.diffuse = glm::vec3(0.0f);
    glossy.glass = Glass{};
    glm::dvec3 total(0.0);
    bool anySurface = false;
    sampleLamps(
        rays, lights, mix, p, n, samples, rng,
        [&](const LightSample& s, float cosine) {
            const glm::vec3 reflected = brdf(glossy, n, s.toLight, toEye) * cosine;
            if (s.isPunctual()) return reflected * s.illuminance;
            return reflected * s.radiance / (s.pdf + scatterPdf(glossy, n, s.toLight, toEye));
        },
        [&](const Emitter& emitter, const SampleSum& found, int count) {
            total += found.sum / static_cast<double>(count);
            anySurface |= emitter.kind == Emitter::Kind::surface;
        });
    if (anySurface) {
        total += glm::dvec3(glossyFromLobe(rays, lights, mix, glossy, p, n, toEye, glm::max(1, samples), rng));
    }
    return glm::vec3(total);
}

} // namespace lightloom
