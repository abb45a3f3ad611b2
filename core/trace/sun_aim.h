// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/rng.h"
#include "core/trace/ray_scene.h"
#include <vector>

namespace lightloom {

/// Where on the disc that covers the scene a directional light's photons start. Most of a sun's light falls on roofs
/// and goes back to the sky; what comes in through an opening carries all of a room's light. Cells of the disc are shot
/// at by the square root of the light they pass on to further surfaces (which makes the variance least), found by a few
/// rays, and one photon in seven evenly, so that nothing is missed. After the projection maps of Jensen (1996).
class SunAim {
public:
    /// Traces about 80,000 rays. `travel`: unit; the disc lies across it, 2 * radius before `centre`.
    SunAim(const RayScene& rays, glm::vec3 travel, glm::vec3 centre, float radius);

    /// A point of the disc. `weight`: how much more a photon from there counts than one shot evenly.
    [[nodiscard]] glm::vec3 pick(Rng& rng, float& weight) const;

private:
    [[nodiscard]] glm::vec3 onDisc(glm::vec2 u) const;
    [[nodiscard]] double passedOn(const RayScene& rays, std::uint32_t cell) const;

    glm::vec3 travel_, centre_;
    float radius_;
    std::vector<double> sums_; ///< chances of the cells, summed; the last is 1
};

} // namespace lightloom
