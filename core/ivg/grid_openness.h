// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/ivg/grid_lattice.h"
#include "core/trace/light_reach.h"
#include <array>
#include <memory>

namespace lightloom {

inline constexpr float kLeastOpen = 0.15f; ///< share of a face or cell; what is left of less is mostly rounding

/// What walls leave of a grid: which vertices lie where light can be, how much of the faces and cells around them is
/// joined to them, and how far they see along the axes. Depends on the scene's surface and its reach, not on photons.
///
/// A face is the rectangle around a vertex that faces an axis, from half a cell before to half a cell behind, cut off
/// at the grid's border. Its open part is what can be gone to from the vertex along one tangential axis, then along the
/// other; a cell's likewise along all three. Photons elsewhere in it belong to another room, or pass behind a column.
struct GridOpenness {
    static constexpr int kParts = 8; ///< of a face along each axis, in `faceParts`
    static constexpr float kSightUnits = 255.0f / 2.0f;

    std::vector<std::uint8_t> isOpen; ///< by vertex: 0 behind a wall, 1 in the open
    std::vector<glm::vec3> faceShare; ///< by vertex and axis: open share of the face, 0 to 1
    std::vector<float> cellShare;     ///< by vertex: open share of the cell
    /// By vertex and axis: bit u + 8 v is set where that 64th of a full face is open at least in part.
    std::vector<std::array<std::uint64_t, 3>> faceParts;
    std::vector<std::uint64_t> cellParts; ///< by vertex: bit x + 4 y + 16 z, of 4^3 parts of a full cell
    /// By vertex, along -x +x -y +y -z +z: how far the next surface is, in kSightUnits per cell; 255: that far or more.
    std::vector<std::array<std::uint8_t, 6>> sight;
    std::size_t nearVertices = 0; ///< that have surface within half a cell: rays were needed for their faces

    /// As if there was nothing in the grid.
    [[nodiscard]] static GridOpenness everything(const GridLattice& lattice);
    static constexpr std::size_t kBytesPerVertex = sizeof(std::uint8_t) + sizeof(glm::vec3) + sizeof(float) +
                                                   sizeof(std::array<std::uint64_t, 3>) + sizeof(std::uint64_t) +
                                                   sizeof(std::array<std::uint8_t, 6>);
    [[nodiscard]] std::size_t memoryBytes() const { return isOpen.size() * kBytesPerVertex; }
};

/// A vertex lies behind a wall if 4 of 14 rays from it meet sides of surface that light cannot reach, or as many as
/// meet sides that it can (beyond an edge of a closed room most rays meet nothing at all). Rays for faces and cells are
/// spent only where surface is near. Null: stopped.
[[nodiscard]] std::shared_ptr<const GridOpenness> findOpenness(const RayScene& rays, const LightReach& reach,
                                                               const GridLattice& lattice, Workers& workers,
                                                               const std::stop_token& stop);

} // namespace lightloom
