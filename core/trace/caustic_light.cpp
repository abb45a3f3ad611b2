// SPDX-License-Identifier: Apache-2.0
#include "core/trace/caustic_light.h"
#include "core/base/units.h"
#include "core/trace/medium.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint64_t kStream = hashName("caustic photons"), kBlock = 4096;
constexpr double kShrink = 2.0 / 3.0; ///< alpha of Knaus and Zwicker: noise and bias fall alike

/// One photon of the light that paths leave out.
class CausticWalk {
public:
    CausticWalk(const RayScene& rays, const CausticLamps& lamps, const CausticJob& job, const CausticDiscs& discs,
                float radius)
        : rays_(rays), lamps_(lamps), job_(job), discs_(discs), sink_(glm::max(4.0f * rays.offset(), 0.05f * radius)),
          beyond_(4.0f * rays.scene().bounds.diagonal())
    {
    }
    void shoot(std::uint64_t number) const
    {
        Rng rng(job_.seed, kStream, number);
        EmittedPhoton photon;
        if (!lamps_.emit(rng, photon)) return;
        glm::vec3 flux = photon.flux / static_cast<float>(job_.photons), origin = photon.position,
                  travel = photon.travel;
        Medium medium;
        for (int bounce = 0; bounce < job_.pathDepth; ++bounce) {
            Hit hit;
            const bool isHit = rays_.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit);
            const Surface surface = isHit ? surfaceAt(rays_, hit) : Surface{};
            if (isHit && medium.absorbs(hit, surface)) flux *= medium.transmittance(hit, surface);
            if (bounce > 0) send(origin, travel, isHit ? &hit : nullptr, flux);
            if (!isHit) return;
            const glm::vec3 n = hit.facing();
            Scatter next;
            const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
            if (!scatter(surface, n, -travel, u, next)) return;
            if (bounce == 0 && !next.isMirror) return; // a path finds this one
            const float chance = glm::min(clearChance(surface, bounce), maxChannel(next.weight));
            if (!(rng.uniform() < chance)) return;
            flux *= next.weight / chance;
            medium.cross(hit, surface, next);
            origin = rays_.leave(hit.position, next.side(n));
            travel = next.away;
        }
    }

private:
    void send(glm::vec3 origin, glm::vec3 travel, const Hit* hit, glm::vec3 flux) const
    {
        if (!hit) {
            discs_.send(origin, origin + beyond_ * travel, 0.0f, flux);
            return;
        }
        // so deep that discs lying on a slightly hollow surface are reached
        const float cosine = glm::max(0.05f, -glm::dot(travel, hit->facing()));
        discs_.send(origin, hit->position, sink_ / cosine, flux);
    }

    const RayScene& rays_;
    const CausticLamps& lamps_;
    const CausticJob& job_;
    const CausticDiscs& discs_;
    float sink_, beyond_;
};

} // namespace

float causticRadius(const RayScene& rays, std::uint64_t number)
{
    double squared = 1.0;
    for (std::uint64_t k = 1; k <= number; ++k)
        squared *= (static_cast<double>(k) + kShrink) / (static_cast<double>(k) + 1.0);
    return 0.01f * rays.scene().bounds.diagonal() * static_cast<float>(std::sqrt(squared));
}

glm::dvec3 CausticSums::mean() const { return {illuminance[0].mean(), illuminance[1].mean(), illuminance[2].mean()}; }
glm::dvec3 CausticSums::standardError() const
{
    return {illuminance[0].standardError(), illuminance[1].standardError(), illuminance[2].standardError()};
}
double CausticSums::blurBound() const
{
    const auto [least, most] = std::ranges::minmax(partSums);
    return (most - least) / std::max(1.0, static_cast<double>(illuminance[0].count()));
}

bool shootCaustics(const RayScene& rays, const CausticLamps& lamps, const CausticJob& job, std::uint64_t number,
                   const CausticDiscs& discs, float radius, Workers& workers, const std::stop_token& stop)
{
    const CausticWalk walk(rays, lamps, job, discs, radius);
    return workers.run(static_cast<std::size_t>((job.photons + kBlock - 1) / kBlock), stop, [&](std::size_t block) {
        const std::uint64_t first = block * kBlock, end = std::min(job.photons, first + kBlock);
        for (std::uint64_t i = first; i < end; ++i) walk.shoot(number * job.photons + i);
    });
}

bool addCausticRound(const RayScene& rays, const CausticLamps& lamps, const CausticJob& job, std::uint64_t number,
                     const std::vector<CatchPoint>& points, std::vector<CausticSums>& sums, Workers& workers,
                     const std::stop_token& stop)
{
    const float radius = causticRadius(rays, number);
    std::vector<CatchPoint> now = points;
    for (CatchPoint& p : now) p.radius = glm::min(p.radius, radius);
    const CausticDiscs discs(rays, now, lamps.flux());
    if (!shootCaustics(rays, lamps, job, number, discs, radius, workers, stop)) return false;
    for (std::size_t i = 0; i < now.size(); ++i) {
        const glm::dvec3 lux = discs.illuminance(i);
        for (int c = 0; c < 3; ++c) sums[i].illuminance[static_cast<std::size_t>(c)].add(lux[c]);
        const auto parts = discs.parts(i);
        for (std::size_t k = 0; k < parts.size(); ++k) sums[i].partSums[k] += parts[k];
        sums[i].radiusSum += static_cast<double>(now[i].radius);
    }
    return true;
}

} // namespace lightloom
