// SPDX-License-Identifier: Apache-2.0
#include "core/bake/view_eye.h"
#include "core/base/units.h"
#include "core/trace/medium.h"
#include "core/voxel/voxel_cuts.h"
#include <cmath>
#include <limits>

namespace lightloom {

namespace {
constexpr int kMostMirrors = 32; ///< between facing mirrors, say, or within a glass

const VoxelCuts* cutsOf(const IndirectField* field)
{
    const auto* cuts = dynamic_cast<const VoxelCuts*>(field);
    return cuts && cuts->show().lookup == VoxelLookup::lightcuts ? cuts : nullptr;
}
} // namespace

Eye::Eye(const RayScene& rays, const LightSampler& lights, const Mix& mix, const IndirectField* field,
         const ViewJob& job, const CausticLamps* byPhotons)
    : rays_(rays), lights_(lights), mix_(mix), field_(field), cuts_(cutsOf(field)), job_(job),
      directSamples_(share(job.directSamples)), gatherRays_(share(job.gatherRays)), paths_(rays, lights, mix, byPhotons)
{
    usesCuts_ = cuts_ && job.indirect == ViewJob::Indirect::field && job.block == 1 && !job.finalGather;
    joins_ = usesCuts_ && job.withDirect && cuts_->show().lamps > 0;
    if (field_) cached_ = [this](glm::vec3 p, glm::vec3 n, glm::vec3& lux) { return field_->lookupQuick(p, n, lux); };
}

MiddleLight Eye::middle(glm::vec3 origin, glm::vec3 travel) const
{
    MiddleLight found;
    found.isKnown = true;
    Hit hit;
    if (!rays_.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) return found;
    found.position = hit.position;
    found.normal = hit.facing();
    const Surface surface = surfaceAt(rays_, hit);
    if (cuts_ && surface.hasSpecular() && !surface.isMirror()) found.glossBy = GlossBy::rays;
    if (isLitByCut(surface)) {
        found.gloss = glossByCut(surface, found.position, found.normal, -travel);
        found.glossBy = GlossBy::cut;
    } else if (surface.diffuse == glm::vec3(0.0f)) {
        return found;
    }
    if (!cuts_) {
        found.isThere = field_->lookup(found.position, found.normal, found.lux);
        return found;
    }
    const Lightcut cut = cutAt(found.position, found.normal);
    found.isThere = true;
    found.lux = cut.illuminance - cut.fromLamps;
    found.directLux = cut.fromLamps;
    found.cutSize = cut.nodes;
    return found;
}

Radiance Eye::along(glm::vec3 origin, glm::vec3 travel, Rng& rng, const MiddleLight* middle) const
{
    Radiance seen;
    glm::vec3 throughput(1.0f);
    Medium medium;
    bool isGlossy = false; // behind a rough metal: all that follows is indirect, and lamps are already counted
    for (int bounce = 0; bounce < kMostMirrors; ++bounce) {
        Hit hit;
        if (!rays_.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) break;
        const Surface surface = surfaceAt(rays_, hit);
        if (medium.absorbs(hit, surface)) throughput *= medium.transmittance(hit, surface);
        const glm::vec3 n = hit.facing();
        const Radiance here = leaving(hit, surface, n, -travel, !isGlossy, rng, bounce == 0 ? middle : nullptr);
        seen.indirect += throughput * (isGlossy ? here.direct + here.indirect : here.indirect);
        if (!isGlossy) seen.direct += throughput * here.direct;
        seen.emitted += throughput * here.emitted;
        const bool isLit = isLitByCut(surface);
        if (isLit) {
            const bool isKnown = bounce == 0 && middle && middle->glossBy == GlossBy::cut &&
                                 middle->isFor(hit.position, n, 8.0f * rays_.offset());
            seen.indirect += throughput * (isKnown ? middle->gloss : glossByCut(surface, hit.position, n, -travel));
        }

        Scatter next;
        const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
        if (!surface.isSeenInto() && job_.indirect != ViewJob::Indirect::paths) break;
        if (!scatter(surface, n, -travel, u, next)) break;
        origin = rays_.leave(hit.position, next.side(n));
        if (job_.indirect == ViewJob::Indirect::paths && !next.isMirror) {
            seen.indirect += throughput * next.weight * paths_.radiance(origin, next.away, false, job_.pathDepth, rng);
            break;
        }
        if (!next.isSpecular || (isLit && !next.isMirror)) break; // its diffuse and wide parts were taken above
        throughput *= next.radianceWeight();
        medium.cross(hit, surface, next);
        isGlossy |= !next.isMirror;
        if (isGlossy && job_.indirect == ViewJob::Indirect::none) break;
        travel = next.away;
    }
    return seen;
}

/// `isStraight`: seen without a gloss in between, so that emission counts and what lamps send counts as direct.
Radiance Eye::leaving(const Hit& hit, const Surface& surface, glm::vec3 n, glm::vec3 toEye, bool isStraight, Rng& rng,
                      const MiddleLight* middle) const
{
    Radiance light;
    const glm::vec3 p = hit.position;
    const bool wantsDirect = job_.withDirect || !isStraight;
    const int e = isStraight && wantsDirect ? lights_.emitterOf(hit.triangle) : -1;
    if (e >= 0) {
        light.emitted = surface.emission * gainOf(mix_, lights_.emitters()[static_cast<std::size_t>(e)].group);
    }
    if (wantsDirect) {
        light.direct = light.emitted + directGlossy(rays_, lights_, mix_, surface, p, n, toEye, directSamples_, rng);
    }
    if (surface.diffuse == glm::vec3(0.0f)) return light;
    const glm::vec3 matt = surface.diffuse / kPi;
    const int samples = joins_ ? 0 : directSamples_;
    if (wantsDirect) light.direct += matt * directIlluminance(rays_, lights_, mix_, p, n, samples, rng);
    if (!field_ || job_.indirect != ViewJob::Indirect::field) return light;
    const Lux lux = fieldLux(p, n, rng, middle);
    light.direct += matt * lux.direct;
    light.indirect += matt * lux.indirect;
    return light;
}

bool Eye::isLitByCut(const Surface& surface) const
{
    constexpr float kWide = 0.5f; // roughness: lobes are at most 4 times as high as an even one
    return usesCuts_ && surface.hasSpecular() && surface.roughness >= kWide;
}

glm::vec3 Eye::glossByCut(const Surface& surface, glm::vec3 p, glm::vec3 n, glm::vec3 toEye) const
{
    Surface gloss = surface;
    gloss.diffuse = glm::vec3(0.0f);
    // a lobe's top is 1 / (4 alpha^2) of an even lobe's: a cluster may be off by as much more
    const float alpha = surface.roughness * surface.roughness;
    glm::vec3 sum(0.0f);
    for (const CutLight& light : cuts_->lightsAt(p, n, glm::min(1.0f, 4.0f * alpha * alpha)))
        sum += light.lux * brdf(gloss, n, light.toLight, toEye);
    return sum;
}

Lightcut Eye::cutAt(glm::vec3 p, glm::vec3 n) const { return joins_ ? cuts_->joinedAt(p, n) : cuts_->cutAt(p, n); }

Eye::Lux Eye::fieldLux(glm::vec3 p, glm::vec3 n, Rng& rng, const MiddleLight* middle) const
{
    if (middle && middle->isFor(p, n, 8.0f * rays_.offset())) return {middle->directLux, middle->lux};
    if (joins_) {
        const Lightcut cut = cutAt(p, n);
        return {cut.fromLamps, cut.illuminance - cut.fromLamps};
    }
    glm::vec3 lux(0.0f);
    const bool isQuick = middle && job_.block > 1;
    if (job_.finalGather || !(isQuick ? field_->lookupQuick(p, n, lux) : field_->lookup(p, n, lux)))
        lux = gatherIndirect(rays_, lights_, mix_, cached_, p, n, gatherRays_, 1, rng);
    return {glm::vec3(0.0f), lux};
}

Lens::Lens(const ViewJob& job)
    : camera_(job.camera), orientation_(glm::mat3_cast(job.camera.orientation)), width_(job.width), height_(job.height),
      tanHalf_(std::tan(0.5f * job.camera.yFov))
{
}

void Lens::ray(int x, int y, glm::vec2 within, glm::vec3& origin, glm::vec3& travel) const
{
    const auto w = static_cast<float>(width_), h = static_cast<float>(height_);
    const float right = (2.0f * (static_cast<float>(x) + within.x) / w - 1.0f) * tanHalf_ * w / h;
    const float up = (1.0f - 2.0f * (static_cast<float>(y) + within.y) / h) * tanHalf_;
    const glm::vec3 toPlane = orientation_ * glm::vec3(right, up, -1.0f);
    origin = camera_.position + toPlane * camera_.nearPlane;
    travel = glm::normalize(toPlane);
}

} // namespace lightloom
