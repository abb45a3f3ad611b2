// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/cell_orientations.h"
#include "core/trace/light_reach.h"

namespace lightloom {

inline constexpr int kMostVoxels = 1024; ///< along a side

/// `cells` cubic cells along the longest side of a scene's bound, padded by a thousandth. The lattice may reach
/// further: its side is a power of two, which the clipping wants. A `shift` of part of a cell moves it towards the low
/// corner along all axes, with cells larger by 1 / (cells - 1), so that the first `cells` still cover the scene.
[[nodiscard]] CellLattice voxelLattice(const Bounds& bounds, int cells, float shift);

/// The cells that surface passes through (Chatelier and Malgouyres 2006), each with one entry per orientation of the
/// surface inside, exactly clipped. Voxel v owns entries [firstEntry[v], firstEntry[v + 1]), largest first; entry e is
/// made of pieces [firstPiece[e], firstPiece[e + 1]).
struct SurfaceVoxels {
    CellLattice lattice;
    int cells = 0;                  ///< along each side, at most kMostVoxels: all voxels lie within
    std::vector<glm::ivec3> voxels; ///< cells, in the order of their Morton codes
    std::vector<std::uint32_t> firstEntry;
    std::vector<Orientation> entries;
    std::vector<std::uint32_t> firstPiece;
    std::vector<CellPiece> pieces; ///< facets count in the reach that they were built from
    /// A point of entry `e`, uniform by area for uniform `u`; the facet it lies on.
    [[nodiscard]] glm::vec3 pointOn(std::size_t e, glm::vec3 u, const LightReach& reach, std::uint32_t& facet) const;
    /// The voxel that holds a point of the surface that faces `normal`; voxels.size() if none does. O(log voxels).
    [[nodiscard]] std::size_t voxelAt(glm::vec3 p, glm::vec3 normal) const;
    /// Of that voxel, the entry that faces `normal` most; kNoEntry if none faces it at all.
    [[nodiscard]] std::uint32_t entryAt(glm::vec3 p, glm::vec3 normal) const;
    static constexpr std::uint32_t kNoEntry = 0xFFFFFFFFu;
    /// Of voxel `v`, all its entries' pieces.
    [[nodiscard]] std::span<const CellPiece> piecesOf(std::size_t v) const
    {
        const std::uint32_t first = firstPiece[firstEntry[v]];
        return std::span(pieces).subspan(first, firstPiece[firstEntry[v + 1]] - first);
    }
    [[nodiscard]] float cellSize() const { return lattice.cellSize(); }
    [[nodiscard]] std::size_t memoryBytes() const;
};

/// Of the surface that light can reach: what it cannot reach neither gives nor takes any. `cells` from 1 to
/// kMostVoxels. The same on any number of threads. Null: stopped.
[[nodiscard]] std::shared_ptr<const SurfaceVoxels> voxelise(const Bounds& bounds, const LightReach& reach, int cells,
                                                            float shift, Workers& workers, const std::stop_token& stop);

/// The same, to the bit, as `voxelise` of a scene that was edited, from the voxels `before` of its surface
/// `reachBefore`: surface that has come, gone or moved is cut up, and cells that it touches are made anew; all else is
/// copied. Finds by itself what differs, light that now reaches further included. `clipped`, where given: how many
/// facets were cut up. Where the scene's bound is another one everything is made anew.
[[nodiscard]] std::shared_ptr<const SurfaceVoxels>
revoxelise(const SurfaceVoxels& before, const LightReach& reachBefore, const Bounds& bounds, const LightReach& reach,
           int cells, float shift, Workers& workers, const std::stop_token& stop, std::size_t* clipped = nullptr);

/// The papers' form: one entry per voxel, with the mean normal of its surface (of two sheets back to back, the larger
/// one's). A wall thinner than a voxel leaks in it.
[[nodiscard]] SurfaceVoxels withMeanNormals(const SurfaceVoxels& voxels);

} // namespace lightloom
