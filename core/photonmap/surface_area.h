// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/photonmap/box_groups.h"
#include "core/photonmap/facet_blocks.h"
#include "core/photonmap/screens.h"
#include "core/trace/light_reach.h"
#include <array>

namespace lightloom {

/// Which surface counts: what a photon gather takes (GatherQuery), for one centre and any radius.
struct KernelPlace {
    glm::vec3 centre{0.0f}, normal{0.0f, 1.0f, 0.0f};
    float stretch = 1.0f;     ///< of distances along the normal
    float leastCosine = 0.5f; ///< between the surface's normal and `normal`
    Screens screens{};        ///< surface that they hide does not count
};

/// The scene's reached surface in blocks of eight facets that lie together, to ask how much lies under a gather kernel.
/// Density estimation divides by this: pi r^2 is wrong by half at every edge (METHODS section 2). Any thread may ask.
class SurfaceArea {
public:
    /// O(n log n). Null: stopped.
    static std::shared_ptr<const SurfaceArea> build(const LightReach& reach, const std::stop_token& stop = {});

    static constexpr std::size_t kMostRadii = BlockSums::kMostRadii; ///< that one query may ask for

    /// Of the reached surface within each of `radii` (rising, metres) of the kernel's centre. Exact, each facet's plane
    /// is cut by the ball in a disc, but for facets smaller than half the smallest radius: they count by how far their
    /// centroid lies within (FacetBlock), which is right to .3 % of a kernel's area on average. Coordinates are metres
    /// from the centre along `Frame(normal)`'s tangent and bitangent. `out` is as long as `radii`. O(log n + triangles
    /// in the kernel), hardly more for many radii than for one.
    void under(const KernelPlace& place, std::span<const float> radii, std::span<AreaMoments> out) const;
    /// Area alone, m2.
    [[nodiscard]] double under(const KernelPlace& place, float radius) const;

    /// Whether the place's screens hide any surface that would count within `radius`.
    [[nodiscard]] bool isAnyHidden(const KernelPlace& place, float radius) const;

    [[nodiscard]] double total() const { return total_; } ///< of all reached sides, m2

private:
    explicit SurfaceArea(const LightReach& reach);
    void order(std::uint32_t first, std::uint32_t last, const std::stop_token& stop);
    [[nodiscard]] bool mayHide(const KernelPlace& place, std::size_t block) const;

    std::vector<ReachedFacet> facets_; // ordered so that eight by eight lie together
    std::vector<FacetBlock> blocks_;
    BoxGroups boxes_; // of the blocks
    double total_ = 0.0;
};

} // namespace lightloom
