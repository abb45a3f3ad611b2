// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/light_sampler.h"
#include "core/trace/material.h"

namespace lightloom {

/// Exact direct illuminance (lux per channel) on a surface at `p` (as given: not moved) with unit normal `n`, all
/// groups weighted by `mix` (empty: all 1). Punctual lights: one shadow ray. Surfaces: `samples` stratified shadow
/// rays each. Random numbers come from `rng`. If `squaredError` is given it gets the variance of the result.
[[nodiscard]] glm::vec3 directIlluminance(const RayScene& rays, const LightSampler& lights, const Mix& mix, glm::vec3 p,
                                          glm::vec3 n, int samples, Rng& rng, glm::vec3* squaredError = nullptr);

/// Radiance (cd/m2) of the glossy metallic part of `surface` towards `toEye` from the same lights; diffuse left out.
[[nodiscard]] glm::vec3 directGlossy(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                     const Surface& surface, glm::vec3 p, glm::vec3 n, glm::vec3 toEye, int samples,
                                     Rng& rng);

} // namespace lightloom
