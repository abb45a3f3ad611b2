// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/trace/light_sampler.h"
#include "core/trace/reached_facet.h"

namespace lightloom {

class SideElements;

/// The surface that light can reach at all. The inside of a thick wall, the outside of a closed room and the floor
/// under a block cannot be reached; counting them would halve densities beside them and put probes into the dark.
/// Judged element by element (SideElements): reached is the space that a lamp shines into (LightSpaces). Depends on the
/// scene alone, not on which lamps are on. Without lamps everything counts as reached.
class LightReach {
public:
    static std::shared_ptr<const LightReach> find(const RayScene& rays, const LightSampler& lights, Workers& workers,
                                                  const std::stop_token& stop); ///< null: stopped
    /// The elements for which `isReached` is not 0. Null: stopped.
    static std::shared_ptr<const LightReach>
    of(const SideElements& elements, const std::vector<std::uint8_t>& isReached, const std::stop_token& stop);
    /// What counts as reached where there are no lamps, for `of`.
    [[nodiscard]] static std::vector<std::uint8_t> everything(const SideElements& elements);

    [[nodiscard]] const std::vector<ReachedFacet>& facets() const { return facets_; }
    /// The same surface in fewer facets: parts of a large triangle make up larger ones.
    [[nodiscard]] std::vector<ReachedFacet> fewerFacets() const;
    [[nodiscard]] double area() const { return area_; } ///< m2, of all facets

private:
    std::vector<ReachedFacet> facets_; // rising sides
    std::vector<ReachedFacet> joined_; // of the sides that are reached in parts, rising
    double area_ = 0.0;
};

/// A point on reached surface, for probes.
struct SurfacePoint {
    glm::vec3 position, normal; ///< normal of the side, unit
    std::uint32_t triangle;
};
/// `count` points, uniform by area over the reached facets; number i depends on (seed, i) only. Points of facets that
/// are half hidden are kept only where light arrives, straight or after some bounces: none lies in a closed void.
[[nodiscard]] std::vector<SurfacePoint> samplePoints(const RayScene& rays, const LightSampler& lights,
                                                     const LightReach& reach, std::uint64_t count, std::uint64_t seed);

} // namespace lightloom
