// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/caustic_lamps.h"
#include "core/trace/emitter_choice.h"
#include "core/trace/material.h"

namespace lightloom {

/// Unidirectional paths with next event estimation; the balance heuristic joins lamps and lobes (Veach 1997). Unbiased
/// up to the given number of surfaces, but for light of point, spot and directional lamps that meets a mirror or glass
/// first: no path finds it. With `byPhotons` the light of those lamps that does so is left to photons altogether.
/// Built for one mix, then only read. Keeps references.
class PathWalk {
public:
    PathWalk(const RayScene& rays, const LightSampler& lights, const Mix& mix, const CausticLamps* byPhotons = nullptr);

    /// cd/m2 that `hit` emits towards the ray that came along.
    [[nodiscard]] glm::vec3 emitted(const Hit& hit, const Surface& surface) const;

    /// cd/m2 that `hit` sends back along `travel` of what it gets, as it arrives at the ray's origin; what it emits
    /// itself is left out.
    [[nodiscard]] glm::vec3 reflected(Hit hit, Surface surface, glm::vec3 travel, int pathDepth, Rng& rng) const;

    /// Radiance (cd/m2) that arrives at `origin` from direction -`travel` along one path: what the first surface emits
    /// included only when `withEmission`.
    [[nodiscard]] glm::vec3 radiance(glm::vec3 origin, glm::vec3 travel, bool withEmission, int pathDepth,
                                     Rng& rng) const;

private:
    [[nodiscard]] glm::vec3 fromLamps(const Surface& surface, glm::vec3 p, glm::vec3 n, glm::vec3 toEye,
                                      Rng& rng) const;
    [[nodiscard]] float lobeShare(const Scatter& lobe, glm::vec3 from, const Hit& hit) const;

    const RayScene& rays_;
    const LightSampler& lights_;
    const Mix& mix_;
    EmitterChoice choice_;
    const CausticLamps* byPhotons_;
};

} // namespace lightloom
