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
/// next steps of the same wall (docs/methods/voxel-lightcuts.md). In a voxel where entries of both kinds stand before
/// each other's plane, a corner that is open inwards, these see each other and the line ends there; in any other the
/// ones that face back come first. Where several entries of a voxel could answer, one is drawn by how much of it is
/// seen: area times cosine.
class LinePartners {
public:
    static constexpr std::uint32_t kNothing = 0xFFFFFFFFu;
    /// Both must outlive this.
    LinePartners(const SurfaceVoxels& voxels, const VoxelOrders& orders) : voxels_(voxels), orders_(orders) {}

    /// Partners by entry, valid until the next call. `number` of the direction: draws depend on it and the voxel alone.
    std::span<std::uint32_t> find(const LineDirection& direction, std::uint32_t number);

private:
    struct Line {
        std::uint32_t firstWaiting = kNothing; // entries, chained by `nextWaiting_`
        std::uint32_t lastWaiting = kNothing;  // voxel
        std::uint32_t emitter = kNothing;      // voxel that those who faced it last saw
        std::int32_t closedAt = 0;             // slice
        std::uint32_t stamp = 0;               // of the direction; an older one: a line without voxels so far
    };
    struct Faces {
        bool forth = false, back = false, areConcave = false;
    };
    [[nodiscard]] Faces facesOf(std::uint32_t voxel, glm::vec3 along) const;
    [[nodiscard]] std::uint32_t pick(std::uint32_t voxel, glm::vec3 towards) const;
    void wait(Line& line, std::uint32_t voxel, glm::vec3 along);
    void close(Line& line, std::uint32_t voxel, std::int32_t slice, glm::vec3 along);

    const SurfaceVoxels& voxels_;
    const VoxelOrders& orders_;
    std::uint32_t number_ = 0, stamp_ = 0;
    std::vector<Line> lines_;
    std::vector<std::uint32_t> nextWaiting_, partners_; // by entry
};

} // namespace lightloom
