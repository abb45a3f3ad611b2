// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/transport/exact_partners.h"
#include <functional>
#include <memory>
#include <mutex>

namespace lightloom {

/// Who every entry sees in up to kDirections directions of a set that follow each other: one row per entry, in a
/// RowOrder. Partners are numbers of rows; the number of all rows stands for none. Two bytes each up to 65,535 entries,
/// else four.
class PartnerBlock {
public:
    static constexpr std::size_t kDirections = 16;
    explicit PartnerBlock(std::size_t entries = 0);
    /// From entries' partners by direction, kDirections after another: `found[i * entries + e]`, beyond all for none.
    PartnerBlock(const RowOrder& order, std::span<const std::uint32_t> found);
    [[nodiscard]] static std::size_t bytesFor(std::size_t entries);

    [[nodiscard]] std::uint32_t partner(std::size_t row, std::size_t direction) const;
    [[nodiscard]] bool isNarrow() const { return narrow_ != nullptr; } ///< two bytes each
    /// Row r is [r * kDirections, (r + 1) * kDirections), of two bytes each or of four, as `isNarrow` says.
    template<class Number>
    [[nodiscard]] const Number* rows() const
    {
        if constexpr (sizeof(Number) == 2)
            return narrow_.get();
        else
            return wide_.get();
    }

private:
    std::unique_ptr<std::uint16_t[]> narrow_;
    std::unique_ptr<std::uint32_t[]> wide_;
};

/// Walks the lines of a set of directions: partners by discrete lines, where these leave a closed room by exact rays
/// (the papers' lines, without). Any number of threads may ask for blocks.
class BlockWalker {
public:
    /// All must outlive this.
    BlockWalker(const RayScene& rays, const SurfaceVoxels& voxels, const VoxelOrders& orders,
                std::span<const LineDirection> directions)
        : voxels_(voxels), orders_(orders), exact_(rays, voxels), directions_(directions)
    {
    }
    /// Partners along directions [block * kDirections, ...) of the set, as many as it has. O(directions x entries).
    [[nodiscard]] PartnerBlock walk(std::size_t block);

private:
    [[nodiscard]] std::unique_ptr<PartnerFinder> takeFinder();

    const SurfaceVoxels& voxels_;
    const VoxelOrders& orders_;
    ExactPartners exact_;
    std::span<const LineDirection> directions_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<PartnerFinder>> idle_;
};

/// Partners of all entries along the first directions of `directionSet`, stored once per geometry: each bounce and each
/// edit of a lamp is a sum over rows then, and no line is walked again. It holds for the surface, whatever its albedo.
/// Never changes once made: any number of threads may read it.
class PartnerTable {
public:
    /// Memory that so many directions take, bytes.
    [[nodiscard]] static std::size_t bytesFor(std::size_t entries, int directions);
    /// Of as many of the directions as fit into `mostBytes`, in blocks: `bounceLight` walks along the others. Parallel
    /// over directions, the same on any number of threads, O(directions x entries). `progress` is told the share that
    /// is done, from any thread. Null: stopped.
    [[nodiscard]] static std::shared_ptr<const PartnerTable> make(const RayScene& rays, const SurfaceVoxels& voxels,
                                                                  const VoxelOrders& orders, int directions,
                                                                  std::size_t mostBytes, Workers& workers,
                                                                  const std::stop_token& stop,
                                                                  const std::function<void(double)>& progress = {});

    [[nodiscard]] int directions() const { return directions_; }
    [[nodiscard]] std::size_t entries() const { return order_->size(); }
    [[nodiscard]] std::size_t memoryBytes() const { return blocks_.size() * PartnerBlock::bytesFor(entries()); }
    /// Directions [number * PartnerBlock::kDirections, ...).
    [[nodiscard]] const PartnerBlock& block(std::size_t number) const { return blocks_[number]; }
    /// The entry that `entry` sees along a direction; the number of all entries: none.
    [[nodiscard]] std::uint32_t partner(std::size_t entry, std::size_t direction) const;

private:
    PartnerTable(std::shared_ptr<const RowOrder> order, int directions)
        : order_(std::move(order)), directions_(directions)
    {
    }

    std::shared_ptr<const RowOrder> order_;
    int directions_;
    std::vector<PartnerBlock> blocks_;
};

} // namespace lightloom
