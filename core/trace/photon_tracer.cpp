// SPDX-License-Identifier: Apache-2.0
#include "core/trace/photon_tracer.h"
#include "core/base/units.h"
#include "core/trace/medium.h"
#include <atomic>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint64_t kBlock = 4096; ///< photons per block; part of the result's definition only through sums' order

/// What one block of photons adds; blocks are joined in their order.
struct BlockResult {
    std::vector<Photon> photons;
    std::uint64_t rays = 0, caustic = 0, cutOff = 0;
    Ledger ledger;
};

class PhotonWalk {
public:
    PhotonWalk(const RayScene& rays, const LightSampler& lights, const PhotonJob& job, std::uint64_t stream,
               BlockResult& out)
        : rays_(rays), lights_(lights), job_(job), stream_(stream), out_(out)
    {
    }

    void shoot(std::uint64_t number)
    {
        Rng rng(job_.seed, stream_, number);
        EmittedPhoton photon;
        if (!lights_.emit(job_.group, rng, photon)) return;
        flux_ = photon.flux / static_cast<float>(job_.count);
        out_.ledger.emitted += glm::dvec3(flux_);
        glm::vec3 origin = photon.position, travel = photon.travel;
        bool diffused = false, specular = false; // what the path has met
        Medium medium;
        for (int bounce = 0;; ++bounce) {
            Hit hit;
            ++out_.rays;
            if (!rays_.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) {
                out_.ledger.escaped += glm::dvec3(flux_);
                return;
            }
            const glm::vec3 normal = hit.facing();
            const Surface surface = surfaceAt(rays_, hit);
            if (medium.absorbs(hit, surface) && !pass(medium.transmittance(hit, surface), rng)) return;
            // the first diffuse hit is direct light, computed exactly elsewhere, unless a mirror or glass was on the
            // way
            if (bounce > 0) {
                out_.photons.push_back({hit.position, -travel, flux_, normal});
                if (specular && !diffused) ++out_.caustic;
            }
            if (bounce + 1 >= job_.pathDepth) {
                ++out_.cutOff;
                out_.ledger.terminated += glm::dvec3(flux_);
                return;
            }
            Scatter next;
            if (!goOn(surface, normal, -travel, bounce, rng, next)) return;
            (next.isSpecular ? specular : diffused) = true;
            medium.cross(hit, surface, next);
            origin = rays_.leave(hit.position, next.side(normal));
            travel = next.away;
        }
    }

private:
    /// Roulette on the largest channel of the scattering weight; what does not go on is absorbed. False: it ended.
    bool goOn(const Surface& surface, glm::vec3 normal, glm::vec3 toEye, int bounce, Rng& rng, Scatter& next)
    {
        const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
        const float survive = rng.uniform();
        if (!scatter(surface, normal, toEye, u, next)) {
            out_.ledger.absorbed += glm::dvec3(flux_);
            return false;
        }
        return thin(next.weight, clearChance(surface, bounce), survive);
    }

    /// The same for what glass on the way lets pass.
    bool pass(glm::vec3 transmittance, Rng& rng) { return thin(transmittance, 1.0f, rng.uniform()); }

    bool thin(glm::vec3 weight, float most, float survive)
    {
        const glm::vec3 before = flux_;
        const float chance = glm::min(most, maxChannel(weight));
        if (!(survive < chance)) {
            out_.ledger.absorbed += glm::dvec3(before);
            return false;
        }
        flux_ = before * (weight / chance);
        // a weight above 1 in a channel (lobe choice, glass) gives back here what other paths lost: the sum stays exact
        out_.ledger.absorbed += glm::dvec3(before) - glm::dvec3(flux_);
        return true;
    }

    const RayScene& rays_;
    const LightSampler& lights_;
    const PhotonJob& job_;
    std::uint64_t stream_;
    BlockResult& out_;
    glm::vec3 flux_{0.0f};
};

/// Null: stopped.
std::shared_ptr<const PhotonPaths> join(const PhotonJob& job, std::vector<BlockResult>& blocks,
                                        const std::stop_token& stop)
{
    auto paths = std::make_shared<PhotonPaths>();
    paths->group = job.group;
    paths->shot = job.count;
    std::size_t stored = 0;
    for (const BlockResult& block : blocks) stored += block.photons.size();
    paths->photons.reserve(stored);
    for (BlockResult& block : blocks) {
        if (stop.stop_requested()) return nullptr;
        paths->photons.insert(paths->photons.end(), block.photons.begin(), block.photons.end());
        std::vector<Photon>().swap(block.photons);
        paths->rays += block.rays;
        paths->caustic += block.caustic;
        paths->cutOff += block.cutOff;
        paths->ledger += block.ledger;
    }
    return paths;
}

} // namespace

std::shared_ptr<const PhotonPaths> tracePhotons(const RayScene& rays, const LightSampler& lights, const PhotonJob& job,
                                                Workers& workers, const std::stop_token& stop,
                                                const std::function<void(std::uint64_t, std::uint64_t)>& blockDone)
{
    const std::uint64_t stream = rays.scene().groups[static_cast<std::size_t>(job.group)].key();
    const std::uint64_t count = lights.groupFlux(job.group) == glm::vec3(0.0f) ? 0 : job.count;
    std::vector<BlockResult> blocks(static_cast<std::size_t>((count + kBlock - 1) / kBlock));
    std::atomic<std::uint64_t> done = 0;
    const bool all = workers.run(blocks.size(), stop, [&](std::size_t b) {
        PhotonWalk walk(rays, lights, job, stream, blocks[b]);
        const std::uint64_t first = b * kBlock, end = std::min(count, first + kBlock);
        blocks[b].photons.reserve(static_cast<std::size_t>(end - first));
        for (std::uint64_t i = first; i < end; ++i) walk.shoot(i);
        const std::uint64_t sum = done.fetch_add(end - first) + (end - first);
        if (blockDone) blockDone(sum, count);
    });
    if (!all) return nullptr;
    PhotonJob shot = job;
    shot.count = count;
    return join(shot, blocks, stop);
}

} // namespace lightloom
