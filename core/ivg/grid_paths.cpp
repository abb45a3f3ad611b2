// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_paths.h"
#include <algorithm>

namespace lightloom {
namespace {

constexpr double kRoom = 1.1; ///< blocks differ: growing would copy, and leave holes in memory

double bytesOf(const SegmentBlock& block)
{
    return static_cast<double>(sizeof(SegmentBlock) + block.segments.size() * sizeof(PhotonSegment));
}

} // namespace

PathFeed::PathFeed(const SceneProducts& scene, const PhotonJob& photons, std::string key, double mostBytes,
                   double segmentsPerPhoton, std::vector<SegmentBlock>& buffer, BakeProducts& products)
    : scene_(scene), photons_(photons), key_(std::move(key)), mostBytes_(mostBytes),
      segmentsPerPhoton_(segmentsPerPhoton), products_(products), traced_(buffer)
{
    const auto found = products.find<GridPaths>(key_);
    if (!found) return;
    for (const auto& block : found->blocks) {
        if (bytes_ + bytesOf(*block) > mostBytes_) break;
        bytes_ += bytesOf(*block);
        kept_.blocks.push_back(block);
    }
    isNew_ = kept_.blocks.size() != found->blocks.size();
}

PathFeed::~PathFeed()
{
    if (isNew_) products_.keep<GridPaths>(key_, std::make_shared<const GridPaths>(std::move(kept_)));
}

std::span<const SegmentBlock* const> PathFeed::blocks(std::uint64_t first, std::uint64_t end, BakeControl& control,
                                                      StageCost& cost)
{
    given_.clear();
    for (std::uint64_t b = first; b < std::min<std::uint64_t>(end, kept_.blocks.size()); ++b) {
        given_.push_back(kept_.blocks[b].get());
        photonsKept_ += given_.back()->counts.shot;
    }
    const std::uint64_t next = first + given_.size();
    if (next == end) return given_;
    traced_.resize(end - next);
    const double room = kRoom * segmentsPerPhoton_ * static_cast<double>(kSegmentBlock);
    for (SegmentBlock& block : traced_) block.segments.reserve(static_cast<std::size_t>(room));
    const StageClock clock("shoot", control);
    const bool all =
        traceSegments(*scene_.rays, *scene_.lights, photons_, next, traced_, control.workers(), control.stop());
    const StageCost spent = clock.stop();
    cost.wallMs += spent.wallMs, cost.cpuMs += spent.cpuMs;
    if (!all) return {};
    for (const SegmentBlock& block : traced_) {
        given_.push_back(&block);
        photonsTraced_ += block.counts.shot;
        raysTraced_ += block.counts.rays;
    }
    keep(traced_, next);
    return given_;
}

void PathFeed::keep(std::span<const SegmentBlock> traced, std::uint64_t first)
{
    if (first != kept_.blocks.size()) return; // there is a gap: the budget is used up
    for (const SegmentBlock& block : traced) {
        bytes_ += bytesOf(block);
        if (bytes_ > mostBytes_) return;
        kept_.blocks.push_back(std::make_shared<const SegmentBlock>(block)); // a copy has no room to spare
        isNew_ = true;
    }
}

} // namespace lightloom
