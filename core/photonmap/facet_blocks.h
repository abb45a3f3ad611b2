// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/photonmap/disc_moments.h"
#include "core/photonmap/screens.h"
#include "core/trace/reached_facet.h"
#include <array>
#include <span>
#include <vector>

namespace lightloom {

/// Up to eight facets as patches: each stands for a square of its area and spread around its centroid, and counts by
/// how far that lies within a ball. Eight at once on whatever vectors the machine has, with the same bits.
struct alignas(32) FacetBlock {
    static constexpr std::size_t kCount = 8;
    float x[kCount] = {}, y[kCount] = {}, z[kCount] = {};    ///< centroid, scene space
    float nx[kCount] = {}, ny[kCount] = {}, nz[kCount] = {}; ///< normal
    float area[kCount] = {};                                 ///< m2; unused places have none
    float spread[kCount] = {};                               ///< m2: variance along one axis of its plane
    float slope[kCount] = {};                                ///< 1/m: of its share over the distance from the border
    float reach[kCount] = {};                                ///< m: of its farthest corner from the centroid

    FacetBlock() = default;
    explicit FacetBlock(std::span<const ReachedFacet> facets); ///< at most kCount
};

/// What a kernel's screens leave of a block's facets that face within `leastCosine` of `normal`.
struct FacetsSeen {
    alignas(32) float share[FacetBlock::kCount]; ///< exact where 0 or 1; of small facets by how far their centroid lies
                                                 ///< within the screen, never 0 where a corner may be seen
    unsigned cut = 0;                            ///< bits of larger ones that are perhaps hidden in part; share 0
    unsigned touched = 0;                        ///< bits of those that are hidden, perhaps or in part
    FacetsSeen(const FacetBlock& block, Screens screens, glm::vec3 centre, glm::vec3 normal, float leastCosine,
               float small);
    /// Leaves of a copy of the block what is seen.
    void keepSeen(FacetBlock& block) const
    {
        for (std::size_t i = 0; i < FacetBlock::kCount; ++i) block.area[i] *= share[i];
    }

private:
    static void find(FacetsSeen& seen, const FacetBlock& block, Screens screens, glm::vec3 centre, glm::vec3 normal,
                     float leastCosine, float small);
};

/// Sums of the moments of many blocks within several radii around one centre.
class BlockSums {
public:
    static constexpr std::size_t kMostRadii = 24;

    /// `normal` unit; `tangent` and `bitangent` complete its frame. Distances along the normal count `stretch` times.
    /// Facets with a reach below `small` count as patches.
    BlockSums(glm::vec3 centre, glm::vec3 normal, glm::vec3 tangent, glm::vec3 bitangent, float stretch,
              float leastCosine, float small, std::span<const float> radii);
    /// Adds the small ones. Writes the numbers, beginning with `first`, of those that are too large for that and may
    /// lie within the largest radius to `large`, which has room for eight; returns how many.
    [[nodiscard]] std::size_t add(const FacetBlock& block, std::uint32_t first, std::uint32_t* large)
    {
        return add(place_, block, radii_.data(), radii_.size(), sums_.data(), first, large);
    }
    /// What was added, within radius number `j`; coordinates along tangent and bitangent, from the centre.
    [[nodiscard]] AreaMoments sum(std::size_t j) const;

private:
    static constexpr std::size_t kMoments = 6;
    struct Place {
        float centre[3], normal[3], tangent[3], bitangent[3];
        float stretch; // squared, less 1
        float leastCosine, small, largest;
    };
    static std::size_t add(const Place& place, const FacetBlock& block, const float* radii, std::size_t count,
                           float* sums, std::uint32_t first, std::uint32_t* large);
    Place place_;
    std::span<const float> radii_;
    alignas(32) std::array<float, kMostRadii * kMoments * FacetBlock::kCount> sums_; // as many as there are radii
};

} // namespace lightloom
