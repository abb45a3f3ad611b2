// SPDX-License-Identifier: Apache-2.0
#include "core/trace/lamp_light.h"
#include "core/base/hash.h"
#include "core/trace/direct_light.h"
#include <algorithm>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint32_t kOutsidePhotons = 32'768; ///< most elements are found by them, those behind glass too
constexpr std::uint64_t kTries = 16;              ///< points of an element that ask every lamp
constexpr std::size_t kBlock = 64;
constexpr float kFar = std::numeric_limits<float>::infinity();

} // namespace

LampLight::LampLight(const RayScene& rays, const SideElements& elements, const Scene& scene, const LightSampler& lights,
                     int group)
    : rays_(rays), elements_(elements), lights_(lights), group_(group),
      stream_(scene.groups[static_cast<std::size_t>(group)].key() ^ hashName("light reach"))
{
}

void LampLight::firstHits(std::uint64_t first, std::uint64_t end,
                          const std::function<void(const OpenPoint&, Rng&)>& use) const
{
    for (std::uint64_t i = first; i < end; ++i) {
        Rng rng(0, stream_, i);
        EmittedPhoton photon;
        Hit hit;
        if (!lights_.emit(group_, rng, photon) || !rays_.intersect(photon.position, photon.travel, kFar, hit)) continue;
        use(openPointAt(rays_, elements_, hit), rng);
    }
}

/// Photons alone would not do: in the open, elements see nothing lit but the lamp, and there may be more of them than
/// photons.
bool LampLight::findOutside(std::vector<std::uint8_t> known, Workers& workers, const std::stop_token& stop,
                            std::vector<OpenPoint>& points) const
{
    const bool shot =
        collectPoints(kOutsidePhotons / kBlock, workers, stop, points, [&](std::size_t block, auto& found) {
            firstHits(block * kBlock, (block + 1) * kBlock, [&](const OpenPoint& hit, Rng&) {
                if (!known[hit.element]) found.push_back(hit);
            });
        });
    if (!shot) return false;
    for (const OpenPoint& point : points) known[point.element] = 1;
    return collectPoints((known.size() + kBlock - 1) / kBlock, workers, stop, points,
                         [&](std::size_t block, auto& found) {
                             const std::size_t end = std::min(known.size(), (block + 1) * kBlock);
                             for (std::size_t e = block * kBlock; e < end && !stop.stop_requested(); ++e) {
                                 if (!known[e]) findLit(static_cast<std::uint32_t>(e), found);
                             }
                         });
}

void LampLight::findLit(std::uint32_t element, std::vector<OpenPoint>& found) const
{
    for (std::uint64_t i = 0; i < kTries; ++i) {
        Rng rng(i, hashName("lit by a lamp"), element);
        OpenPoint here{glm::vec3(0.0f), glm::vec3(0.0f), element};
        if (!elements_.sample(element, rng, here.p, here.n)) continue;
        here.p = rays_.leave(here.p, here.n);
        for (const int emitter : lights_.inGroup(group_)) {
            const float u1 = rng.uniform(), u2 = rng.uniform();
            if (!isLit(rays_, lights_, emitter, here.p, here.n, {u1, u2})) continue;
            found.push_back(here);
            return;
        }
    }
}

} // namespace lightloom
