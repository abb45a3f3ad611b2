// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/light_reach.h"

namespace lightloom {

/// Area of the part of triangle (a, b, c) inside the ball around `centre`: exact (the ball cuts the plane in a disc).
[[nodiscard]] double triangleAreaInBall(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 centre, double radius);

/// The scene's reached surface as a bounding-volume tree, to ask how much of it lies under a gather kernel. Density
/// estimation divides by this: pi r^2 is wrong by half at every edge (METHODS section 2). Any thread may ask.
class SurfaceArea {
public:
    /// O(n log n). Null: stopped.
    static std::shared_ptr<const SurfaceArea> build(const LightReach& reach, const std::stop_token& stop = {});

    /// Area (m2) of the reached sides within `radius` of `centre` (distances along `normal` stretched by `stretch`, as
    /// in GatherQuery) whose normal's cosine with `normal` is above `leastCosine`. O(log n + triangles in the kernel).
    [[nodiscard]] double under(glm::vec3 centre, glm::vec3 normal, float radius, float stretch,
                               float leastCosine) const;

    [[nodiscard]] double total() const { return total_; } ///< of all reached sides, m2

private:
    struct Box {
        glm::vec3 low, high;
        std::uint32_t first, count; // facets; count 0: inner node, `first` is the right child, the left one follows
    };
    explicit SurfaceArea(const LightReach& reach);
    std::uint32_t split(std::uint32_t first, std::uint32_t last, const std::stop_token& stop);

    std::vector<ReachedFacet> facets_; // in the tree's order
    std::vector<Box> boxes_;
    double total_ = 0.0;
};

} // namespace lightloom
