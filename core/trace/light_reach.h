// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/trace/light_sampler.h"

namespace lightloom {

/// Which sides of which triangles light can reach at all: the inside of a thick wall, the outside of a closed room and
/// the underside of a floor cannot. Sides joined by a shared edge form one surface; a surface counts as reached when a
/// lamp sees it, or when rays that leave it meet surfaces that are reached. Depends on the scene alone, not on which
/// lamps are on. A scene without lamps counts every side as reached.
class LightReach {
public:
    static std::shared_ptr<const LightReach> find(const RayScene& rays, const LightSampler& lights, Workers& workers,
                                                  const std::stop_token& stop); ///< null: stopped
    [[nodiscard]] bool front(std::uint32_t triangle) const { return sides_[2 * triangle] != 0; }
    [[nodiscard]] bool back(std::uint32_t triangle) const { return sides_[2 * triangle + 1] != 0; }

private:
    std::vector<std::uint8_t> sides_; // front and back of each triangle
};

/// A point on a reached side, for probes.
struct SurfacePoint {
    glm::vec3 position, normal; ///< normal of the side, unit
    std::uint32_t triangle;
};
/// `count` points, uniform by area over the reached sides; number i depends on (seed, i) only.
[[nodiscard]] std::vector<SurfacePoint> samplePoints(const RayScene& rays, const LightReach& reach, std::uint64_t count,
                                                     std::uint64_t seed);

} // namespace lightloom
