// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/params/voxel_choices.h"
#include "core/transport/direction_set.h"
#include "core/transport/row_order.h"
#include "core/transport/surface_bend.h"
#include <array>

namespace lightloom {

/// Where a voxel lies for lines that follow one axis most: its coordinate along it, and those along the next two axes.
struct VoxelPlace {
    std::uint16_t slice, u, v;
    std::uint32_t voxel;
};

/// Where an entry lies, in cells from the corner of the lattice.
struct alignas(32) Plane {
    glm::vec3 centroid;
    float place; ///< of the centroid along the normal
    glm::vec3 normal;
    float slice;
    /// How far another one's centroid lies before this plane.
    [[nodiscard]] float before(const Plane& other) const { return glm::dot(other.centroid, normal) - place; }
};

/// The entries of all voxels in the order in which a walk meets them, field by field, each in a slot of its own. Slice
/// after slice; a line has one voxel in a slice at most, so that the order within one is free: voxels of one entry come
/// first, by what they face, as walls do that are walked alike, those about which surface does not bend before the
/// others; then those of several, the entries of each together.
struct WalkOrder {
    static constexpr std::size_t kSpare = 8;               ///< slots at the end of each field that hold nothing
    static constexpr std::uint32_t kNoEntry = 0xFFFFFFFFu; ///< what these have as entry
    std::vector<VoxelPlace> places;                        ///< of the voxels, in lexicographic order
    std::vector<std::uint32_t> firstSlot;                  ///< by slice; one more at the end
    std::vector<std::uint32_t> firstBent;                  ///< by slice: the first slot about which surface bends
    std::vector<std::uint32_t> firstOfSeveral;             ///< by slice: the first slot of a voxel of several entries
    std::vector<std::uint32_t> entry, voxel;               ///< by slot, as all that follows
    std::vector<std::uint32_t> uv;                         ///< u in the lower half, v in the upper
    std::vector<std::uint16_t> slice;
    std::vector<float> x, y, z;                   ///< normals
    std::vector<float> area;                      ///< m2
    std::vector<float> bend, bendX, bendY, bendZ; ///< SurfaceBend: least and most
    std::vector<std::uint32_t> edges;             ///< number of what VoxelOrders::edges holds
    std::vector<Plane> planes;
};

/// `voxels` as the walk along lines wants them: for VoxelLines::paper one entry each (`withMeanNormals`).
[[nodiscard]] std::shared_ptr<const SurfaceVoxels> voxelsFor(VoxelLines lines,
                                                             std::shared_ptr<const SurfaceVoxels> voxels);

/// Voxels in three lexicographic orders, one per axis (that axis first): voxels of any line that follows an axis most
/// come one after the other in its order. Sorted once, by radix, O(voxels).
class VoxelOrders {
public:
    /// For VoxelLines::paper slots of a slice lie in lexicographic order and hold entry, normal, u and v alone.
    explicit VoxelOrders(const SurfaceVoxels& voxels, VoxelLines lines = VoxelLines::covered);
    [[nodiscard]] VoxelLines lines() const { return lines_; }
    [[nodiscard]] const WalkOrder& along(int axis) const { return orders_[static_cast<std::size_t>(axis)]; }
    [[nodiscard]] std::span<const SurfaceBends::Edges> edges() const { return edges_; }
    /// Of the rows in which partners are stored.
    [[nodiscard]] const std::shared_ptr<const RowOrder>& rows() const { return rows_; }
    [[nodiscard]] std::size_t memoryBytes() const;

private:
    VoxelLines lines_;
    std::array<WalkOrder, 3> orders_;
    std::vector<SurfaceBends::Edges> edges_;
    std::shared_ptr<const RowOrder> rows_;
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
    /// Its two parts: a line's number is that of its place in the slice, u * width() + v, plus offset(slice).
    [[nodiscard]] std::uint32_t width() const { return width_; }
    [[nodiscard]] std::uint32_t offset(int slice) const { return offsets_[static_cast<std::size_t>(slice)]; }

private:
    std::uint32_t width_ = 0, count_ = 0;
    std::vector<std::uint32_t> offsets_; // by slice
};

} // namespace lightloom
