// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/indirect_field.h"
#include "core/trace/light_reach.h"
#include <span>

namespace lightloom {

/// Noise that a bake itself states, in the units of relRMSE: sqrt(mean(noise^2)) / mean(E), luminances at `points`.
/// Known without any reference; what is biased alike everywhere (blur) is not in it. Nothing if the method cannot tell
/// or has no light anywhere. Points without an answer count as dark and free of noise.
[[nodiscard]] std::optional<double> statedNoise(const IndirectField& field, std::span<const SurfacePoint> points);

} // namespace lightloom
