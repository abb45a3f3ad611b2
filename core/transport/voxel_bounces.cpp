// SPDX-License-Identifier: Apache-2.0
#include "core/transport/voxel_bounces.h"
#include "core/transport/light_strip.h"
#include <algorithm>
#include <cassert>
#include <cmath>

namespace lightloom {
namespace {

constexpr std::size_t kMostBytes = std::size_t(256) << 20; ///< of strips that bounce together, and of blocks walked

/// Carries the light of strips from entry to entry.
class Bouncer {
public:
    Bouncer(const RayScene& rays, const SurfaceVoxels& voxels, const VoxelOrders& orders, const BounceParams& params,
            const PartnerTable* stored, Workers& workers, const std::stop_token& stop)
        : rays_(rays), voxels_(voxels), order_(*orders.rows()), directions_(directionSet(params.directions)),
          params_(params), stored_(stored), walker_(rays, voxels, orders, directions_), workers_(workers), stop_(stop)
    {
        assert(!stored || stored->entries() == voxels.entries.size());
        assert(params.order == VoxelBounces::halving || (stored && stored->directions() >= params.directions));
    }

    /// How many strips bounce together: one, where no line is walked.
    [[nodiscard]] std::size_t together() const
    {
        if (stored_ && stored_->directions() >= params_.directions) return 1;
        return std::max<std::size_t>(1, kMostBytes / LightStrip::bytesFor(voxels_.entries.size()));
    }

    /// All bounces of the strips; how many there were. 0: stopped. `done` is told the share after each.
    template<class Done>
    [[nodiscard]] int bounce(std::span<LightStrip> strips, Done done)
    {
        const bool inTurn = params_.order == VoxelBounces::gaussSeidel;
        const std::size_t least = std::min(directions_.size(), static_cast<std::size_t>(params_.leastDirections));
        std::size_t directions = directions_.size();
        for (int bounce = 1;; ++bounce) {
            for (LightStrip& strip : strips) strip.beginBounce(directions, !inTurn || bounce == 1);
            if (!(inTurn ? carryInTurn(strips, directions, bounce == 1) : carry(strips, directions, all()))) return 0;
            bool areDone = true;
            for (LightStrip& strip : strips)
                areDone &= strip.endBounce(params_.leastGain, params_.seriesOff, bounce >= params_.mostBounces);
            if (areDone) return bounce;
            done(1.0 - std::ldexp(1.0, -bounce)); // each costs half of the one before
            directions = std::max(least, directions / 2);
        }
    }

private:
    struct Part { // of the rows: from the first to before the end
        std::size_t first, end;
    };
    [[nodiscard]] Part all() const { return {0, voxels_.entries.size()}; }

    /// What arrives at a part of the rows along the first `count` directions. False: stopped.
    [[nodiscard]] bool carry(std::span<LightStrip> strips, std::size_t count, Part part)
    {
        return gather(strips, count, part) && arrive(strips, part);
    }
    /// One part after the other, each from what those before it have taken in by then. False: stopped.
    [[nodiscard]] bool carryInTurn(std::span<LightStrip> strips, std::size_t count, bool isFirst)
    {
        const std::size_t entries = voxels_.entries.size();
        for (std::size_t p = 0; p < kBounceParts; ++p) {
            const Part part{entries * p / kBounceParts, entries * (p + 1) / kBounceParts};
            if (!carry(strips, count, part)) return false;
            for (LightStrip& strip : strips) strip.passOn(part.first, part.end, isFirst);
        }
        return true;
    }

    [[nodiscard]] bool gather(std::span<LightStrip> strips, std::size_t count, Part part)
    {
        const std::span<const LineDirection> set = std::span(directions_).first(count);
        const std::size_t blocks = (count + PartnerBlock::kDirections - 1) / PartnerBlock::kDirections;
        for (std::size_t first = 0, end = 0; first < blocks; first = end) {
            std::vector<const PartnerBlock*> rows;
            std::vector<PartnerBlock> walked;
            while (end < blocks && isStored(end, count)) rows.push_back(&stored_->block(end++));
            if (rows.empty()) {
                end = std::min(blocks, first + blocksAtOnce());
                if (!walk(first, end, walked)) return false;
                for (const PartnerBlock& block : walked) rows.push_back(&block);
            }
            if (!gatherBlocks(strips, set, first, rows, part)) return false;
        }
        return true;
    }
    [[nodiscard]] bool isStored(std::size_t block, std::size_t count) const
    {
        const std::size_t end = std::min(count, (block + 1) * PartnerBlock::kDirections);
        return stored_ && static_cast<std::size_t>(stored_->directions()) >= end;
    }
    [[nodiscard]] std::size_t blocksAtOnce() const
    {
        const std::size_t most = kMostBytes / std::max<std::size_t>(1, PartnerBlock::bytesFor(voxels_.entries.size()));
        return std::clamp<std::size_t>(most, 1, static_cast<std::size_t>(workers_.threadCount()));
    }
    [[nodiscard]] bool walk(std::size_t first, std::size_t end, std::vector<PartnerBlock>& walked)
    {
        for (std::size_t b = first; b < end; ++b) walked.emplace_back();
        return workers_.run(end - first, stop_, [&](std::size_t i) { walked[i] = walker_.walk(first + i); });
    }
    [[nodiscard]] bool gatherBlocks(std::span<LightStrip> strips, std::span<const LineDirection> set, std::size_t first,
                                    std::span<const PartnerBlock* const> blocks, Part part)
    {
        std::vector<BlockDirections> directions;
        for (std::size_t b = 0; b < blocks.size(); ++b) directions.emplace_back(set, first + b);
        return forRows(strips, part, [&](LightStrip& strip, std::size_t from, std::size_t to) {
            strip.gather(blocks, directions, from, to);
        });
    }
    [[nodiscard]] bool arrive(std::span<LightStrip> strips, Part part)
    {
        return forRows(strips, part, [&](LightStrip& strip, std::size_t from, std::size_t to) {
            strip.arrive(rays_, voxels_, from, to);
        });
    }
    /// Calls `body` for some rows of a part of a strip after the other. False: stopped.
    template<class Body>
    [[nodiscard]] bool forRows(std::span<LightStrip> strips, Part part, const Body& body)
    {
        const std::size_t together = params_.order == VoxelBounces::gaussSeidel ? 256 : 1024; // sums stay in the cache
        const std::size_t jobs = (part.end - part.first + together - 1) / together;
        return workers_.run(jobs * strips.size(), stop_, [&](std::size_t job) {
            const std::size_t from = part.first + job % jobs * together;
            body(strips[job / jobs], from, std::min(part.end, from + together));
        });
    }

    const RayScene& rays_;
    const SurfaceVoxels& voxels_;
    const RowOrder& order_;
    std::vector<LineDirection> directions_;
    BounceParams params_;
    const PartnerTable* stored_;
    BlockWalker walker_;
    Workers& workers_;
    const std::stop_token& stop_;
};

} // namespace

EntryValues bounceLight(const RayScene& rays, const SurfaceVoxels& voxels, const VoxelOrders& orders,
                        const EntryValues& radiosity, std::span<const glm::vec3> albedo, const BounceParams& params,
                        Workers& workers, const std::stop_token& stop, int* bounces, const PartnerTable* stored,
                        const std::function<void(double)>& progress)
{
    assert(radiosity.entries() == voxels.entries.size() && albedo.size() == voxels.entries.size());
    Bouncer bouncer(rays, voxels, orders, params, stored, workers, stop);
    EntryValues lux{radiosity.channels, std::vector<float>(radiosity.values.size())};
    const auto channels = static_cast<std::size_t>(radiosity.channels);
    int most = 0;
    for (std::size_t first = 0; first < channels;) {
        std::vector<LightStrip> strips;
        const auto begun = static_cast<double>(first);
        for (; first < channels && strips.size() < bouncer.together(); first += LightStrip::kMostChannels)
            strips.emplace_back(*orders.rows(), albedo, radiosity, first);
        const auto ended = static_cast<double>(std::min(first, channels));
        const int taken = bouncer.bounce(strips, [&](double part) {
            if (progress) progress((begun + part * (ended - begun)) / static_cast<double>(channels));
        });
        if (taken == 0) return {};
        most = std::max(most, taken);
        for (const LightStrip& strip : strips) strip.writeTo(lux);
    }
    if (bounces) *bounces = most;
    return lux;
}

} // namespace lightloom
