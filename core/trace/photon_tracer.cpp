// SPDX-License-Identifier: Apache-2.0
#include "core/trace/photon_tracer.h"
#include "core/base/sampling.h"
#include "core/trace/photon_wave.h"
#include <algorithm>
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

/// Null: stopped.
std::shared_ptr<const PhotonPaths> join(const PhotonJob& job, std::vector<PhotonBlock>& blocks, Workers& workers,
                                        const std::stop_token& stop)
{
    auto paths = std::make_shared<PhotonPaths>();
    paths->group = job.group;
    paths->shot = job.count;
    std::vector<std::size_t> first;
    std::size_t stored = 0;
    for (const PhotonBlock& block : blocks) {
        first.push_back(stored);
        stored += block.stored;
        paths->rays += block.rayCount;
        paths->caustic += block.caustic;
        paths->cutOff += block.cutOff;
        paths->ledger += block.ledger;
    }
    paths->photons.resize(stored);
    const bool all = workers.run(blocks.size(), stop, [&](std::size_t b) {
        std::copy_n(blocks[b].photons.begin(), blocks[b].stored,
                    paths->photons.begin() + static_cast<std::ptrdiff_t>(first[b]));
        RawVector<Photon>().swap(blocks[b].photons);
    });
    return all ? paths : nullptr;
}

} // namespace

std::shared_ptr<const PhotonPaths> tracePhotons(const RayScene& rays, const LightSampler& lights, const PhotonJob& job,
                                                Workers& workers, const std::stop_token& stop,
                                                const std::function<void(std::uint64_t, std::uint64_t)>& blockDone)
{
    const std::uint64_t stream = rays.scene().groups[static_cast<std::size_t>(job.group)].key();
    PhotonJob shot = job;
    if (lights.groupFlux(job.group) == glm::vec3(0.0f)) shot.count = 0;
    std::vector<PhotonBlock> blocks(static_cast<std::size_t>((shot.count + kBlock - 1) / kBlock),
                                    PhotonBlock{rays, lights, shot, Rng::streamKey(job.seed, stream)});
    std::atomic<std::uint64_t> done = 0;
    const bool all = workers.run(blocks.size(), stop, [&](std::size_t b) {
        const std::uint64_t first = b * kBlock, end = std::min(shot.count, first + kBlock);
        PhotonBlock& block = blocks[b];
        block.makeRoom(static_cast<std::size_t>(end - first));
        shot.oneByOne ? traceOneByOne(block, first, end) : PhotonWave(block, first, end).trace();
        const std::uint64_t sum = done.fetch_add(end - first) + (end - first);
        if (blockDone) blockDone(sum, shot.count);
    });
    return all ? join(shot, blocks, workers, stop) : nullptr;
}

} // namespace lightloom
