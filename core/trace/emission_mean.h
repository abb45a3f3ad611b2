// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/ray_scene.h"

namespace lightloom {

/// Mean emission of a triangle, cd/m2: exact without a texture, else at the centroids of the n^2 like triangles it
/// falls into, some four to a texel's width, at most `most` lookups. Photons look up their own point, so what this
/// misses shifts only which emitter is picked how often.
[[nodiscard]] glm::dvec3 meanEmission(const RayScene& rays, std::uint32_t triangle, double most);

} // namespace lightloom
