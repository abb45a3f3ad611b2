// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/chain_slots.h"
#include "core/transport/partner_finder.h"

namespace lightloom {

/// The papers' walk (2006; 2009, section 2) with the rule that keeps a wall from hiding itself and no other: voxels of
/// one entry each that face along the line wait, the next one that faces them ends all their ways and sees the last of
/// them; those that face back within two slices after it, the next steps of the same wall, see what it sees. Nothing
/// is drawn, planes and what surface covers of a line do not count, and where lines leave a room they stay without
/// partner (docs/methods/voxel-lightcuts.md, Who sees whom).
class ChainPartners final : public PartnerFinder {
public:
    /// Both must outlive this; `orders` for VoxelLines::paper, one entry a voxel.
    ChainPartners(const SurfaceVoxels& voxels, const VoxelOrders& orders);
    std::span<std::uint32_t> find(const LineDirection& direction, std::uint32_t number) override;

private:
    const SurfaceVoxels& voxels_;
    const VoxelOrders& orders_;
    std::vector<ChainLine> lines_;
    std::vector<std::int32_t> found_, ends_; // by slot, as ChainSlots has them
    std::vector<std::uint32_t> partners_;    // by entry
};

} // namespace lightloom
