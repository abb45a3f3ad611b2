// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/atlas/atlas.h"
#include "core/base/image.h"
#include "core/field/indirect_field.h"
#include "core/trace/light_sampler.h"

namespace lightloom {

/// Direct light in a lightmap, if it is wanted.
struct DirectInLightmap {
    const LightSampler* lights = nullptr; ///< null: indirect light alone
    int samples = 16;                     ///< shadow rays per texel and glowing surface
    std::uint64_t seed = 1;
    Mix mix{}; ///< of the lamps
};

/// Illuminance (lux per channel) of every texel of the atlas under the field's own mix. Texels that show no surface,
/// and those where the field knows nothing (half under a block, say), continue their chart from its nearest texels.
/// Texels of no chart are black. The same bits on any number of threads; nothing if stopped. `progress` from 0 to 1, on
/// any worker.
[[nodiscard]] std::optional<FloatImage> bakeLightmap(const RayScene& rays, const Atlas& atlas,
                                                     const IndirectField* field, const DirectInLightmap& direct,
                                                     Workers& workers, const std::stop_token& stop,
                                                     const std::function<void(double)>& progress = {});

/// Fills texels that are not `known` from their neighbours that have the same owner, ring by ring; a ring's texel is
/// the mean of its neighbours in earlier ones. What no known texel of its owner reaches stays as it is.
void dilate(const Atlas& atlas, std::vector<std::uint8_t> known, FloatImage& image);

} // namespace lightloom
