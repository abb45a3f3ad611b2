// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/lightcuts/disc_light.h"
#include "core/trace/ray_scene.h"
#include <vector>

namespace lightloom {

/// What surfaces near a receiver send out, for short rays that look closer than discs can. Any thread may ask.
class NearField {
public:
    virtual ~NearField() = default;
    /// Exitance (lm/m2 per channel, never negative) of the surface that a ray met, on the side it came to: the light
    /// that it reflects, direct and indirect, as discs of the same mix have it; nothing that lamps send out of
    /// themselves. `hit.position` and `hit.facing()` say where.
    [[nodiscard]] virtual glm::vec3 exitance(const Hit& hit) const = 0;
};

/// Light of one direction: for surfaces that do not reflect evenly.
struct CutLight {
    glm::vec3 toLight; ///< unit
    glm::vec3 lux;     ///< illuminance that it brings, cosine included
};

/// Illuminance (lux) at the receiver from surface within `range`, as far as it is left to rays: `count` of them,
/// stratified around the normal, the numbers from (seed, number). Where `seen` is given what they met is appended.
[[nodiscard]] glm::vec3 gatherNear(const RayScene& rays, const NearField& field, const Receiver& at,
                                   const NearRange& range, int count, std::uint64_t seed, std::uint64_t number,
                                   std::vector<CutLight>* seen = nullptr);

} // namespace lightloom
