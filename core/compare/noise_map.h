// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/render_view.h"
#include "core/compare/image_error.h"

namespace lightloom {

/// Where in a picture a bake is noisy, by its own account: `IndirectField::noise` at the surface that the middle of
/// each pixel sees, over the mean illuminance of all pixels with an answer, as fractions. Mirrors are followed. Black
/// (0) where the field has no answer, cannot tell, or nothing is seen; all 0 without light. The same on any number of
/// threads; empty after a stop.
[[nodiscard]] ScalarImage noiseMap(const RayScene& rays, const IndirectField& field, const Camera& camera, int width,
                                   int height, Workers& workers, const std::stop_token& stop);

} // namespace lightloom
