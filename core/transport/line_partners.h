// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/voxel_lines.h"

namespace lightloom {

inline constexpr float kAlongSurface = 1e-4f; ///< cosine below which a line neither meets a surface nor leaves it

/// What the surface sees along discrete lines of one direction, both ways in one pass, O(voxels). An entry that faces
/// along +direction looks that way, one that faces along -direction the other way: each has one partner, the entry that
/// it takes light from, or none.
///
/// A wall is one or two voxels thick along a line and would hide itself from the light: entries that face along the
/// line wait until an entry faces them, which sees the last of them; so do those that follow it within two slices, the
/// next steps of the same wall. Entries see each other if each lies before the other's plane: the far side of a slab
/// thinner than a voxel is passed over while the line is about that plane. Within a voxel this makes corners that are
/// open inwards see themselves; all else that faces back in a voxel comes before what faces forth. A voxel at an edge
/// that is open outwards is passed by on some lines, as often as its surface leaves room there. Where several entries
/// of a voxel could answer, one is drawn by how much of it is seen: area times cosine
/// (docs/methods/voxel-lightcuts.md).
class LinePartners {
public:
    static constexpr std::uint32_t kNothing = 0xFFFFFFFFu;
    /// Both must outlive this.
    LinePartners(const SurfaceVoxels& voxels, const VoxelOrders& orders);

    /// Partners by entry, valid until the next call. `number` of the direction: draws depend on it and the voxel alone.
    std::span<std::uint32_t> find(const LineDirection& direction, std::uint32_t number);

private:
    /// Entries of one voxel, a bit each.
    using Members = std::uint32_t;
    static_assert(kMostOrientations <= 32);
    struct Line {
        std::uint32_t waiting = kNothing; // the last entry that waits
        std::uint32_t emitter = kNothing; // voxel that those who faced it last saw
        Members emitters = 0;             // of it
        std::int32_t closedAt = 0;        // slice
        std::uint32_t stamp = 0;          // of the direction; an older one: a line without voxels so far
    };
    struct Waiting {
        std::uint32_t before, voxel; // the entry that waits since before it; where it is
        Members together;            // those of its voxel that wait
        std::int32_t slice;
    };
    struct Faces {
        Members forth = 0, back = 0;
    };
    [[nodiscard]] Faces facesOf(std::uint32_t voxel) const;
    [[nodiscard]] Members seeing(std::uint32_t entry, std::uint32_t voxel, Members among) const;
    [[nodiscard]] std::uint32_t pick(std::uint32_t voxel, Members among) const;
    [[nodiscard]] bool endsAt(std::uint32_t waiting, std::uint32_t facing, std::int32_t slice) const;
    Faces joinCorners(std::uint32_t voxel, const Faces& faces);
    [[nodiscard]] bool passes(std::uint32_t voxel, float covered, float enough) const;
    [[nodiscard]] Faces passedBy(std::uint32_t voxel, const Faces& faces) const;
    void wait(Line& line, const VoxelPlace& place, Members members, bool isPassed);
    void close(Line& line, const VoxelPlace& place, Members facing, Members takers, bool isPassed);
    void walkOne(Line& line, const VoxelPlace& place, std::uint32_t entry);
    void walkSeveral(Line& line, const VoxelPlace& place);
    template<class Do>
    void forEach(std::uint32_t voxel, Members members, Do what) const;

    const SurfaceVoxels& voxels_;
    const VoxelOrders& orders_;
    glm::vec3 along_{0.0f};
    float perSlice_ = 1.0f; // cells along the line
    float tube_ = 1.0f;     // m2: cross-section of the space that belongs to a line
    std::uint32_t number_ = 0, stamp_ = 0;
    std::vector<Line> lines_;
    std::vector<Waiting> waiting_;        // by entry
    std::vector<float> cosines_;          // by entry
    std::vector<std::uint32_t> partners_; // by entry
};

} // namespace lightloom
