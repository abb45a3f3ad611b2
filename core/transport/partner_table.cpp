// SPDX-License-Identifier: Apache-2.0
#include "core/transport/partner_table.h"
#include "core/transport/chain_partners.h"
#include <algorithm>
#include <atomic>
#include <cassert>

namespace lightloom {
namespace {

constexpr std::size_t kMostNarrow = 65'535; // entries; their number stands for nothing

std::size_t blocksFor(int directions)
{
    return (static_cast<std::size_t>(directions) + PartnerBlock::kDirections - 1) / PartnerBlock::kDirections;
}

} // namespace

std::unique_ptr<PartnerFinder> partnerFinder(const SurfaceVoxels& voxels, const VoxelOrders& orders)
{
    if (orders.lines() == VoxelLines::paper) return std::make_unique<ChainPartners>(voxels, orders);
    return std::make_unique<LinePartners>(voxels, orders);
}

PartnerBlock::PartnerBlock(std::size_t entries)
{
    const std::size_t count = entries * kDirections;
    if (entries <= kMostNarrow)
        narrow_ = std::make_unique_for_overwrite<std::uint16_t[]>(count);
    else
        wide_ = std::make_unique_for_overwrite<std::uint32_t[]>(count);
}

PartnerBlock::PartnerBlock(const RowOrder& order, std::span<const std::uint32_t> found) : PartnerBlock(order.size())
{
    const std::size_t entries = order.size();
    assert(found.size() == entries * kDirections);
    const auto turn = [&]<class Number>(Number* rows) {
        for (std::size_t r = 0; r < entries; ++r, rows += kDirections) {
            for (std::size_t i = 0; i < kDirections; ++i) {
                const std::size_t partner = found[i * entries + order.entryOf[r]];
                rows[i] = static_cast<Number>(order.rowOf[std::min(partner, entries)]);
            }
        }
    };
    narrow_ ? turn(narrow_.get()) : turn(wide_.get());
}

std::size_t PartnerBlock::bytesFor(std::size_t entries)
{
    return entries * kDirections * (entries <= kMostNarrow ? sizeof(std::uint16_t) : sizeof(std::uint32_t));
}

std::uint32_t PartnerBlock::partner(std::size_t row, std::size_t direction) const
{
    const std::size_t at = row * kDirections + direction;
    return narrow_ ? narrow_[at] : wide_[at];
}

std::unique_ptr<PartnerFinder> BlockWalker::takeFinder()
{
    const std::scoped_lock lock(mutex_);
    if (idle_.empty()) return partnerFinder(voxels_, orders_);
    std::unique_ptr<PartnerFinder> finder = std::move(idle_.back());
    idle_.pop_back();
    return finder;
}

PartnerBlock BlockWalker::walk(std::size_t block)
{
    const std::size_t entries = voxels_.entries.size(), first = block * PartnerBlock::kDirections;
    std::vector<std::uint32_t> found(entries * PartnerBlock::kDirections, PartnerFinder::kNothing);
    std::unique_ptr<PartnerFinder> finder = takeFinder();
    for (std::size_t i = 0; i < PartnerBlock::kDirections && first + i < directions_.size(); ++i) {
        const LineDirection& direction = directions_[first + i];
        const std::span<std::uint32_t> partners = finder->find(direction, static_cast<std::uint32_t>(first + i));
        if (orders_.lines() == VoxelLines::covered) exact_.complete(direction, partners);
        std::ranges::copy(partners, found.begin() + static_cast<std::ptrdiff_t>(i * entries));
    }
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(finder));
    return {*orders_.rows(), found};
}

std::size_t PartnerTable::bytesFor(std::size_t entries, int directions)
{
    return blocksFor(directions) * PartnerBlock::bytesFor(entries);
}

std::shared_ptr<const PartnerTable> PartnerTable::make(const RayScene& rays, const SurfaceVoxels& voxels,
                                                       const VoxelOrders& orders, int directions, std::size_t mostBytes,
                                                       Workers& workers, const std::stop_token& stop,
                                                       const std::function<void(double)>& progress)
{
    assert(directions >= 1 && directions <= kMostDirections);
    const std::size_t entries = voxels.entries.size();
    while (directions > 0 && bytesFor(entries, directions) > mostBytes)
        directions = static_cast<int>((blocksFor(directions) - 1) * PartnerBlock::kDirections);
    const std::shared_ptr<PartnerTable> table(new PartnerTable(orders.rows(), directions));
    const std::vector<LineDirection> set = directions > 0 ? directionSet(directions) : std::vector<LineDirection>{};
    BlockWalker walker(rays, voxels, orders, set);
    for (std::size_t b = 0; b < blocksFor(directions); ++b) table->blocks_.emplace_back();
    std::atomic<std::size_t> done = 0;
    const bool all = workers.run(table->blocks_.size(), stop, [&](std::size_t b) {
        table->blocks_[b] = walker.walk(b);
        if (progress) progress(static_cast<double>(++done) / static_cast<double>(table->blocks_.size()));
    });
    return all && !stop.stop_requested() ? table : nullptr;
}

std::uint32_t PartnerTable::partner(std::size_t entry, std::size_t direction) const
{
    const std::uint32_t row = blocks_[direction / PartnerBlock::kDirections].partner(
        order_->rowOf[entry], direction % PartnerBlock::kDirections);
    return row < entries() ? order_->entryOf[row] : row;
}

} // namespace lightloom
