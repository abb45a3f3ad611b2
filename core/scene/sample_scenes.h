// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/scene/scene.h"
#include <array>
#include <optional>
#include <string_view>

/// The scenes in sample_scenes/ as functions: each shows one thing (sample_scenes/README.md says which), with named
/// cameras, named lamps and an exposure that suits it. Deterministic: no random numbers, the same bytes every time.
namespace lightloom {

/// The Cornell box with its published measured geometry in metres (0.556 wide), front open to black; x grows to the
/// left as seen from the camera, the lamp is flush in the ceiling, faces down and reflects nothing.
[[nodiscard]] Scene cornellBox();

} // namespace lightloom
