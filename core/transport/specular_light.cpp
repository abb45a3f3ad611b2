// SPDX-License-Identifier: Apache-2.0
#include "core/transport/specular_light.h"
#include "core/base/units.h"
#include "core/trace/medium.h"
#include <algorithm>
#include <atomic>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint64_t kBlock = 8192;
constexpr int kMostMirrors = 4096; ///< a safety net behind roulette

/// A photon where it arrives.
struct Arrival {
    std::uint32_t entry;
    glm::vec3 flux; // lm
};

/// Follows photons of one light group.
class SpecularPhotons {
public:
    SpecularPhotons(const LightSampler& lights, const SurfaceVoxels& voxels, int group, std::uint64_t seed)
        : lights_(lights), rays_(*lights.rays()), voxels_(voxels), group_(group),
          streamKey_(Rng::streamKey(seed, hashName("specular light") ^
                                              rays_.scene().groups[static_cast<std::size_t>(group)].key()))
    {
    }

    /// Adds where photon `number` arrives after mirrors and glass alone: everything that it meets then.
    void follow(std::uint64_t number, std::vector<Arrival>& arrivals) const
    {
        Rng rng(streamKey_, number);
        EmittedPhoton photon;
        if (!lights_.emit(group_, rng, photon)) return;
        glm::vec3 origin = photon.position, travel = photon.travel, flux = photon.flux;
        Medium medium;
        for (int met = 0; met < kMostMirrors; ++met) {
            Hit hit;
            if (!rays_.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) return;
            if (met == 0 && rays_.look(hit.instance).isMatte) return; // nearly all: that is direct light
            const Surface surface = surfaceAt(rays_, hit);
            if (medium.absorbs(hit, surface)) flux *= medium.transmittance(hit, surface);
            const glm::vec3 n = hit.facing();
            const std::uint32_t entry = met > 0 ? voxels_.entryAt(hit.position, n) : SurfaceVoxels::kNoEntry;
            if (entry != SurfaceVoxels::kNoEntry) arrivals.push_back({entry, flux});
            Scatter next;
            const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
            if (!scatter(surface, n, -travel, u, next) || !next.isMirror) return; // bounces carry the rest
            flux *= next.weight;
            const float chance = std::min(Surface::maxChannel3(next.weight), clearChance(surface, met));
            if (chance < 1.0f) {
                if (!(rng.uniform() < chance)) return;
                flux /= chance;
            }
            medium.cross(hit, surface, next);
            origin = rays_.leave(hit.position, next.side(n));
            travel = next.away;
        }
    }

private:
    const LightSampler& lights_;
    const RayScene& rays_;
    const SurfaceVoxels& voxels_;
    int group_;
    std::uint64_t streamKey_;
};

} // namespace

EntryValues specularLight(const LightSampler& lights, const SurfaceVoxels& voxels, std::span<const int> groups,
                          std::uint64_t photons, std::uint64_t seed, Workers& workers, const std::stop_token& stop,
                          std::uint64_t* caught, const std::function<void(double)>& progress)
{
    const std::size_t channels = 3 * groups.size(), blocks = static_cast<std::size_t>((photons + kBlock - 1) / kBlock);
    EntryValues lux{static_cast<int>(channels), std::vector<float>(channels * voxels.entries.size(), 0.0f)};
    if (caught) *caught = 0;
    std::atomic<std::size_t> done = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const SpecularPhotons of(lights, voxels, groups[g], seed);
        std::vector<std::vector<Arrival>> arrivals(blocks);
        const bool whole = workers.run(blocks, stop, [&](std::size_t b) {
            const std::uint64_t first = b * kBlock, end = std::min(photons, first + kBlock);
            for (std::uint64_t i = first; i < end; ++i) of.follow(i, arrivals[b]);
            if (progress) progress(static_cast<double>(++done) / static_cast<double>(blocks * groups.size()));
        });
        if (!whole || stop.stop_requested()) return {};
        for (const std::vector<Arrival>& block : arrivals) { // in their order: the same bits on any threads
            if (caught) *caught += block.size();
            for (const Arrival& arrival : block) {
                const float share = 1.0f / (static_cast<float>(photons) * voxels.entries[arrival.entry].area);
                for (std::size_t c = 0; c < 3; ++c)
                    lux.values[arrival.entry * channels + 3 * g + c] += share * arrival.flux[static_cast<int>(c)];
            }
        }
    }
    return lux;
}

} // namespace lightloom
