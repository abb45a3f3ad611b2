// SPDX-License-Identifier: Apache-2.0
#include "core/trace/photon_tracer.h"
#include "core/base/sampling.h"
#include "core/trace/photon_joiner.h"
#include "core/trace/photon_wave.h"
#include <atomic>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint64_t kBlock = 4096; ///< photons per block; part of the result's definition by the order it makes

void traceOneByOne(PhotonBlock& block, std::uint64_t number, std::uint64_t end)
{
    PhotonPath photon;
    for (; number < end; ++number) {
        Departure away;
        bool lives = photon.start(block, number, away);
        if (!lives) continue;
        while (lives) {
            glm::vec3 travel = away.ray.travel;
            if (away.isUnaimed) travel = Frame(away.side).toWorld(sampleCosineHemisphere(away.aim.x, away.aim.y));
            Hit hit;
            ++block.rayCount;
            lives = block.rays.intersect(away.ray.origin, travel, std::numeric_limits<float>::infinity(), hit);
            block.makeRoom(1);
            if (!lives)
                photon.escape();
            else
                lives = photon.meet(block, hit, travel, away);
        }
        photon.close(block.ledger);
    }
}

} // namespace

std::shared_ptr<const PhotonPaths> tracePhotons(const RayScene& rays, const LightSampler& lights, const PhotonJob& job,
                                                Workers& workers, const std::stop_token& stop,
                                                const std::function<void(std::uint64_t, std::uint64_t)>& blockDone)
{
    const std::uint64_t stream = rays.scene().groups[static_cast<std::size_t>(job.group)].key();
    const std::uint64_t streamKey = Rng::streamKey(job.seed, stream);
    PhotonJob shot = job;
    if (lights.groupFlux(job.group) == glm::vec3(0.0f)) shot.count = 0;
    const auto blocks = static_cast<std::size_t>((shot.count + kBlock - 1) / kBlock);
    PhotonJoiner joiner(shot, blocks);
    std::atomic<std::uint64_t> done = 0;
    const bool all = workers.run(blocks, stop, [&](std::size_t b) {
        const std::uint64_t first = b * kBlock, end = std::min(shot.count, first + kBlock);
        PhotonBlock block{rays, lights, shot, streamKey, 1.0f / static_cast<float>(shot.count), joiner.memory()};
        block.makeRoom(static_cast<std::size_t>(end - first));
        shot.oneByOne ? traceOneByOne(block, first, end) : PhotonWave(block, first, end).trace();
        joiner.add(b, std::move(block));
        const std::uint64_t sum = done.fetch_add(end - first) + (end - first);
        if (blockDone) blockDone(sum, shot.count);
    });
    return all ? joiner.finish() : nullptr;
}

} // namespace lightloom
