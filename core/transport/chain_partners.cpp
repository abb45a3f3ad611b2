// SPDX-License-Identifier: Apache-2.0
#include "core/transport/chain_partners.h"
#include <cassert>

namespace lightloom {

ChainPartners::ChainPartners(const SurfaceVoxels& voxels, const VoxelOrders& orders)
    : voxels_(voxels), orders_(orders), found_(voxels.entries.size() + WalkOrder::kSpare),
      ends_(voxels.entries.size() + WalkOrder::kSpare + 1), partners_(voxels.entries.size())
{
    assert(voxels.entries.size() == voxels.voxels.size() && orders.lines() == VoxelLines::paper);
}

std::span<std::uint32_t> ChainPartners::find(const LineDirection& direction, std::uint32_t)
{
    const WalkOrder& order = orders_.along(direction.major);
    const LineNumbers numbers(direction, voxels_.cells);
    lines_.assign(numbers.count(), kNewLine);
    const ChainSlots slots{order.x.data(),
                           order.y.data(),
                           order.z.data(),
                           order.uv.data(),
                           reinterpret_cast<const std::int32_t*>(order.entry.data()),
                           found_.data(),
                           ends_.data(),
                           lines_.data()};
    ChainWalk walk;
    walk.along = direction.unit, walk.width = numbers.width();
    walk.unused = static_cast<std::int32_t>(ends_.size() - 1);
    for (int slice = 0; slice < voxels_.cells; ++slice) {
        walk.slice = slice, walk.offset = numbers.offset(slice);
        const auto at = static_cast<std::size_t>(slice);
        walkChains(slots, order.firstSlot[at], order.firstSlot[at + 1], walk);
    }
    chainsToEntries(slots, partners_.size(), partners_.data());
    return partners_;
}

} // namespace lightloom
