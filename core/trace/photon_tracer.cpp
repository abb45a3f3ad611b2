// SPDX-License-Identifier: Apache-2.0
#include "core/trace/photon_tracer.h"
#include "core/base/units.h"
#include "core/trace/cosine_draws.h"
#include "core/trace/medium.h"
#include <array>
#include <atomic>
#include <bit>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint64_t kBlock = 4096; ///< photons per block; part of the result's definition by the order it makes

/// What one block of photons adds; blocks are joined in their order.
struct BlockResult {
    RawVector<Photon> photons;
    std::uint64_t rays = 0, caustic = 0, cutOff = 0;
    Ledger ledger;
};

/// What all photons of a block work on.
struct Block {
    const RayScene& rays;
    const LightSampler& lights;
    const PhotonJob& job;
    std::uint64_t streamKey; ///< Rng::streamKey of the group
    BlockResult& out;
};

/// How a photon leaves a lamp or a surface. Most directions come from a cosine, and those are left to be drawn
/// together.
struct Departure {
    Ray ray;
    bool isUnaimed = false; ///< ray.travel is to be drawn from the cosine around `side` with `aim`
    glm::vec3 side{0.0f};
    glm::vec2 aim{0.0f};
};

/// One photon under way.
class PhotonPath {
public:
    /// False: no photon leaves the lamps under this number.
    bool start(Block& block, std::uint64_t number, Departure& away)
    {
        rng_ = Rng(block.streamKey, number);
        EmittedPhoton photon;
        if (!block.lights.launch(block.job.group, rng_, photon)) return false;
        first_ = flux_ = photon.flux * (1.0f / static_cast<float>(block.job.count));
        away = {{photon.position, photon.travel}, photon.isUnaimed, photon.side, photon.aim};
        medium_ = Medium();
        bounce_ = 0;
        hasDiffused_ = hasMirrored_ = false;
        return true;
    }

    void escape(Block& block) const { end(block.out.ledger, &Ledger::escaped); }

    /// Takes the photon from a hit onward. False: it ended here.
    bool meet(Block& block, const Hit& hit, glm::vec3 travel, Departure& away)
    {
        const InstanceLook& look = block.rays.look(hit.instance);
        if (look.isMatte && medium_.isAir()) return meetMatte(block, hit, look.front.diffuse, travel, away);
        const Surface surface = surfaceAt(block.rays, hit);
        if (medium_.absorbs(hit, surface) && !thin(medium_.transmittance(hit, surface), 1.0f, rng_.uniform()))
            return absorbed(block);
        const glm::vec3 normal = hit.facing(), back = -travel;
        if (!arrive(block, hit, normal, back)) return false;
        const auto [u1, u2] = rng_.uniformPair();
        const auto [u3, survive] = rng_.uniformPair();
        Scatter next;
        if (!scatter(surface, normal, back, {u1, u2, u3}, next)) return absorbed(block);
        if (!thin(next.weight, clearChance(surface, bounce_), survive)) return absorbed(block);
        (next.isSpecular ? hasMirrored_ : hasDiffused_) = true;
        medium_.cross(hit, surface, next);
        away = {{block.rays.leave(hit.position, next.side(normal)), next.away}};
        ++bounce_;
        return true;
    }

private:
    /// The same where the surface is diffuse and nothing else, as most are.
    bool meetMatte(Block& block, const Hit& hit, glm::vec3 diffuse, glm::vec3 travel, Departure& away)
    {
        const glm::vec3 normal = hit.facing(), back = -travel;
        if (!arrive(block, hit, normal, back)) return false;
        const auto [u1, u2] = rng_.uniformPair();
        const bool isLit = glm::dot(normal, back) > 0.0f; // not so for triangles without area
        if (!isLit || !thin(diffuse, 1.0f, rng_.uniform())) return absorbed(block);
        hasDiffused_ = true;
        away = {{block.rays.leave(hit.position, normal), travel}, true, normal, {u1, u2}};
        ++bounce_;
        return true;
    }

    /// Stores the photon if it is to be. False: its path is as long as it may be.
    bool arrive(Block& block, const Hit& hit, glm::vec3 normal, glm::vec3 back)
    {
        // the first diffuse hit is direct light, computed exactly elsewhere, unless a mirror or glass was on the way
        if (bounce_ > 0) {
            block.out.photons.push_back({hit.position, back, flux_, normal});
            if (hasMirrored_ && !hasDiffused_) ++block.out.caustic;
        }
        if (bounce_ + 1 < block.job.pathDepth) return true;
        ++block.out.cutOff;
        end(block.out.ledger, &Ledger::terminated);
        return false;
    }

    /// Roulette: the photon lives with the chance of the largest channel of `weight`, at most `most`. False: it ended.
    bool thin(glm::vec3 weight, float most, float survive)
    {
        const float chance = glm::min(most, maxChannel(weight));
        if (!(survive < chance)) return false;
        flux_ *= weight / chance;
        return true;
    }

    bool absorbed(Block& block)
    {
        flux_ = glm::vec3(0.0f);
        end(block.out.ledger, &Ledger::absorbed);
        return false;
    }

    /// What is left of the photon goes to `where`; what it lost on its way was absorbed (or, where a weight was above 1
    /// in a channel, given back from what other paths lost: the sum stays exact).
    void end(Ledger& ledger, glm::dvec3 Ledger::*where) const
    {
        ledger.emitted += glm::dvec3(first_);
        ledger.absorbed += glm::dvec3(first_) - glm::dvec3(flux_);
        ledger.*where += glm::dvec3(flux_);
    }

    Rng rng_{0, 0};
    glm::vec3 first_{0.0f}, flux_{0.0f}; ///< lumen, at the lamp and now
    Medium medium_;
    int bounce_ = 0;
    bool hasDiffused_ = false, hasMirrored_ = false; ///< what the path has met
};

void traceOneByOne(Block& block, std::uint64_t number, std::uint64_t end)
{
    PhotonPath photon;
    for (; number < end; ++number) {
        Departure away;
        bool lives = photon.start(block, number, away);
        while (lives) {
            glm::vec3 travel = away.ray.travel;
            if (away.isUnaimed) travel = Frame(away.side).toWorld(sampleCosineHemisphere(away.aim.x, away.aim.y));
            Hit hit;
            ++block.out.rays;
            lives = block.rays.intersect(away.ray.origin, travel, std::numeric_limits<float>::infinity(), hit);
            if (!lives)
                photon.escape(block);
            else
                lives = photon.meet(block, hit, travel, away);
        }
    }
}

/// Eight photons of a block under way at a time; where one ends the next starts, so that directions are drawn and rays
/// traced eight at once as long as there are as many.
class Wave {
public:
    Wave(Block& block, std::uint64_t number, std::uint64_t end) : block_(block), next_(number), end_(end) {}

    void trace()
    {
        for (std::size_t lane = 0; lane < kWidth; ++lane) startIn(lane);
        while (alive_ != 0) {
            aim();
            block_.out.rays += static_cast<std::uint64_t>(std::popcount(alive_));
            const unsigned met = block_.rays.intersect(rays_, alive_, hits_);
            for (unsigned rest = alive_; rest != 0; rest &= rest - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
                const bool isHit = (met >> lane & 1u) != 0;
                if (!isHit) photons_[lane].escape(block_);
                if (isHit && photons_[lane].meet(block_, hits_[lane], rays_[lane].travel, away_))
                    depart(lane);
                else
                    startIn(lane);
            }
        }
    }

private:
    static constexpr std::size_t kWidth = RayScene::kTogether;
    static_assert(kWidth == CosineDraws::kCount);

    void startIn(std::size_t lane)
    {
        alive_ &= ~(1u << lane);
        while (next_ < end_) {
            if (!photons_[lane].start(block_, next_++, away_)) continue;
            alive_ |= 1u << lane;
            return depart(lane);
        }
    }

    void depart(std::size_t lane)
    {
        rays_[lane] = away_.ray;
        if (!away_.isUnaimed) return;
        unaimed_ |= 1u << lane;
        draws_.ask(lane, away_.side, away_.aim);
    }

    void aim()
    {
        if (unaimed_ == 0) return;
        draws_.draw();
        for (; unaimed_ != 0; unaimed_ &= unaimed_ - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(unaimed_));
            rays_[lane].travel = draws_.drawn(lane);
        }
    }

    Block& block_;
    std::uint64_t next_, end_;
    unsigned alive_ = 0, unaimed_ = 0; // bits of lanes
    std::array<PhotonPath, kWidth> photons_;
    std::array<Ray, kWidth> rays_;
    std::array<Hit, kWidth> hits_;
    CosineDraws draws_;
    Departure away_;
};

/// Null: stopped.
std::shared_ptr<const PhotonPaths> join(const PhotonJob& job, std::vector<BlockResult>& blocks, Workers& workers,
                                        const std::stop_token& stop)
{
    auto paths = std::make_shared<PhotonPaths>();
    paths->group = job.group;
    paths->shot = job.count;
    std::vector<std::size_t> first;
    std::size_t stored = 0;
    for (const BlockResult& block : blocks) {
        first.push_back(stored);
        stored += block.photons.size();
        paths->rays += block.rays;
        paths->caustic += block.caustic;
        paths->cutOff += block.cutOff;
        paths->ledger += block.ledger;
    }
    paths->photons.resize(stored);
    const bool all = workers.run(blocks.size(), stop, [&](std::size_t b) {
        std::ranges::copy(blocks[b].photons, paths->photons.begin() + static_cast<std::ptrdiff_t>(first[b]));
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
    const std::uint64_t streamKey = Rng::streamKey(job.seed, stream);
    PhotonJob shot = job;
    if (lights.groupFlux(job.group) == glm::vec3(0.0f)) shot.count = 0;
    std::vector<BlockResult> blocks(static_cast<std::size_t>((shot.count + kBlock - 1) / kBlock));
    std::atomic<std::uint64_t> done = 0;
    const bool all = workers.run(blocks.size(), stop, [&](std::size_t b) {
        const std::uint64_t first = b * kBlock, end = std::min(shot.count, first + kBlock);
        blocks[b].photons.reserve(2 * static_cast<std::size_t>(end - first));
        Block block{rays, lights, shot, streamKey, blocks[b]};
        shot.oneByOne ? traceOneByOne(block, first, end) : Wave(block, first, end).trace();
        const std::uint64_t sum = done.fetch_add(end - first) + (end - first);
        if (blockDone) blockDone(sum, shot.count);
    });
    return all ? join(shot, blocks, workers, stop) : nullptr;
}

} // namespace lightloom
