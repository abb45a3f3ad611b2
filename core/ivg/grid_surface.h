// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/ivg/grid_lattice.h"
#include "core/trace/light_reach.h"
#include "core/trace/photon_segments.h"
#include <memory>

namespace lightloom {

/// Reached surface of one dominant direction within half a cell of a grid along each axis.
struct SurfacePatch {
    glm::vec3 position, normal; ///< means by area; normal unit
    float area;                 ///< m2, of what is in the open
};

/// The scene's reached surface within a grid, in patches: to know how bright it is itself, by the photons that land on
/// it, and not only how bright the air before it is. Any thread may ask.
class GridSurface {
public:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    /// Facets are clipped exactly (clipToCells); what lies hidden under something that stands on it is left out, by an
    /// eighth of a cell, where two rays from it both meet sides that light cannot reach. Null: stopped.
    [[nodiscard]] static std::shared_ptr<const GridSurface> build(std::shared_ptr<const RayScene> rays,
                                                                  const LightReach& reach, const GridLattice& lattice,
                                                                  Workers& workers, const std::stop_token& stop);

    [[nodiscard]] const std::vector<SurfacePatch>& patches() const { return patches_; }
    /// Where a photon's way ends; kNone: outside, on surface that light should not reach, or nowhere.
    [[nodiscard]] std::uint32_t patchOf(const PhotonSegment& way) const;
    /// About how many there will be, and bytes of each, beside eight per cell of the grid.
    [[nodiscard]] static double patchesFor(double area, double cellFace) { return 1.2 * area * 4.0 / cellFace; }
    static constexpr double kBytesPerPatch = sizeof(SurfacePatch) + 1.0;

private:
    GridSurface(std::shared_ptr<const RayScene> rays, const GridLattice& lattice);
    void index(const std::vector<std::uint64_t>& keys);
    [[nodiscard]] std::size_t blockOf(glm::uvec3 cell) const
    {
        const glm::uvec3 b = cell / 2u;
        return (static_cast<std::size_t>(b.z) * static_cast<std::size_t>(blocks_.y) + b.y) *
                   static_cast<std::size_t>(blocks_.x) +
               b.x;
    }
    [[nodiscard]] static std::uint8_t codeOf(glm::uvec3 cell, std::uint64_t direction)
    {
        const unsigned in = (cell.x & 1) + 2 * (cell.y & 1) + 4 * (cell.z & 1);
        return static_cast<std::uint8_t>(6 * in + direction);
    }

    std::shared_ptr<const RayScene> rays_;
    glm::vec3 lowest_{0.0f};                  ///< of the patches' own lattice, in grid coordinates
    glm::vec3 corner_{0.0f}, perMetre_{1.0f}; ///< the same in scene space; cells of patches per metre
    glm::ivec3 blocks_{1};                    ///< of 2 x 2 x 2 cells of patches
    std::vector<SurfacePatch> patches_;
    std::vector<std::uint8_t> codes_;          ///< by patch: its cell in its block, and its direction
    std::vector<std::uint32_t> firsts_, ends_; ///< by block, patches
};

/// What landed on a patch.
struct LandedLight {
    glm::vec3 illuminance; ///< lux per channel
    float fluxVariance;    ///< of its luminous flux, lm^2
};

/// What landed on patches, of one light group: sums in double, in the photons' order, so that they are the same bits on
/// any number of threads.
class SurfaceLight {
public:
    explicit SurfaceLight(std::shared_ptr<const GridSurface> surface)
        : surface_(std::move(surface)), flux_(surface_->patches().size(), glm::dvec4(0.0))
    {
    }
    /// False: stopped, do not use further.
    bool add(std::span<const SegmentBlock* const> blocks, Workers& workers, const std::stop_token& stop);
    static constexpr double kBytesPerPatch = sizeof(glm::dvec4), kBytesPerSegment = sizeof(std::uint32_t);
    [[nodiscard]] const GridSurface& surface() const { return *surface_; }
    /// By patch, with flux times `scale`.
    [[nodiscard]] std::vector<LandedLight> light(double scale) const;

private:
    std::shared_ptr<const GridSurface> surface_;
    std::vector<glm::dvec4> flux_;                 ///< lumen, then the sum of squared luminances
    std::vector<std::vector<std::uint32_t>> ends_; ///< of the call's blocks, by segment
};

} // namespace lightloom
