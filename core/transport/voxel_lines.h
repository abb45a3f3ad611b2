// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/direction_set.h"
#include "core/transport/surface_voxels.h"
#include <array>

namespace lightloom {

/// Where a voxel lies for lines that follow one axis most: its coordinate along it, and those along the next two axes.
struct VoxelPlace {
    std::uint16_t slice, u, v;
    std::uint32_t voxel;
};

/// Voxels in three lexicographic orders, one per axis (that axis first): voxels of any line that follows an axis most
/// come one after the other in its order. Sorted once, by radix, O(voxels).
class VoxelOrders {
public:
    explicit VoxelOrders(const SurfaceVoxels& voxels);
    [[nodiscard]] std::span<const VoxelPlace> along(int axis) const { return orders_[static_cast<std::size_t>(axis)]; }

private:
    std::array<std::vector<VoxelPlace>, 3> orders_;
};

/// The partition of a cube of cells into discrete lines of one direction (Debled-Rennesson 1995; papers of 2006 and
/// 2009, section 2): cell (x, y, z) lies on line (y + floor(-b x / a + 1/2), z + floor(-c x / a + 1/2)) of direction
/// (a, b, c), a the largest component. Each cell is on exactly one line.
class LineNumbers {
public:
    /// `cells` along each side, at most kMostVoxels: then no number passes 4 kMostVoxels^2.
    LineNumbers(const LineDirection& direction, int cells);
    /// From 0 to count() - 1.
    [[nodiscard]] std::uint32_t of(const VoxelPlace& place) const
    {
        return place.u * width_ + place.v + offsets_[place.slice];
    }
    [[nodiscard]] std::uint32_t count() const { return count_; }

private:
    std::uint32_t width_ = 0, count_ = 0;
    std::vector<std::uint32_t> offsets_; // by slice
};

} // namespace lightloom
