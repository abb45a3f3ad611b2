// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/direct_light.h"
#include <functional>

namespace lightloom {

/// Cached indirect illuminance at a surface point; false where the cache keeps none.
using CachedIndirect = std::function<bool(glm::vec3 p, glm::vec3 n, glm::vec3& lux)>;

/// Indirect illuminance (lux per channel) at a point the cache does not cover (mid-air, an unbaked object): `count`
/// stratified cosine rays; a hit contributes rho/pi (direct + cached indirect), an emitter nothing of its own. A
/// specular hit (metal, glass) is followed, and so is a matt one where the cache keeps nothing. `directSamples` per hit
/// and surface emitter. `p` may lie on a surface: rays start a step off it.
[[nodiscard]] glm::vec3 gatherIndirect(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                       const CachedIndirect& cached, glm::vec3 p, glm::vec3 n, int count,
                                       int directSamples, Rng& rng);

} // namespace lightloom
