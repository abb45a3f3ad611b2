// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/voxel_lines.h"
#include <memory>

namespace lightloom {

/// Finds what the surface sees along discrete lines of one direction, both ways in one pass: an entry that faces along
/// +direction looks that way, one that faces along -direction the other way. One thread at a time.
class PartnerFinder {
public:
    static constexpr std::uint32_t kNothing = 0xFFFFFFFFu;
    virtual ~PartnerFinder() = default;
    /// Partners by entry, kNothing for none; valid until the next call. `number` of the direction: what is drawn by
    /// chance depends on it and the voxel alone. O(voxels).
    virtual std::span<std::uint32_t> find(const LineDirection& direction, std::uint32_t number) = 0;
};

/// The one that `orders` were sorted for. Both must outlive it.
[[nodiscard]] std::unique_ptr<PartnerFinder> partnerFinder(const SurfaceVoxels& voxels, const VoxelOrders& orders);

} // namespace lightloom
