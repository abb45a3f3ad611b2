// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/light_sampler.h"
#include "core/trace/material.h"

namespace lightloom {

/// Direct illuminance (lux per channel) on a surface at exactly `p` with unit normal `n`, all groups weighted by `mix`
/// (empty: all 1). Only shadow rays start a step off `p` along `n`, so `p` may lie on a surface or hang in mid-air.
/// Punctual lights: one shadow ray, exact. Surfaces: `samples` low-discrepancy shadow rays each, shifted at random by
/// `rng`; 0: they are left out. If `squaredError` is given it gets the variance of the result, taken as if the samples
/// were independent, which they beat.
[[nodiscard]] glm::vec3 directIlluminance(const RayScene& rays, const LightSampler& lights, const Mix& mix, glm::vec3 p,
                                          glm::vec3 n, int samples, Rng& rng, glm::vec3* squaredError = nullptr);

/// Whether light of one sample of `emitter`, at `u` of the unit square, falls on `p`, which is moved off its surface
/// already, from before `n`.
[[nodiscard]] bool isLit(const RayScene& rays, const LightSampler& lights, int emitter, glm::vec3 p, glm::vec3 n,
                         glm::vec2 u);

/// Radiance (cd/m2) of the glossy metallic part of `surface` towards `toEye` from the same lights; the diffuse part and
/// mirrors left out (a mirror's ray is the caller's to follow). Half of the effort goes to the lobe, half to the
/// lights, joined by the balance heuristic: no fireflies from narrow lobes or near lamps.
[[nodiscard]] glm::vec3 directGlossy(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                     const Surface& surface, glm::vec3 p, glm::vec3 n, glm::vec3 toEye, int samples,
                                     Rng& rng);

} // namespace lightloom
