// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/lightcuts/light_tree.h"
#include "core/trace/light_sampler.h"

namespace lightloom {

/// Glowing surfaces as lights for a cut (the paper's "direct tree"): `samples` discs for each, drawn as photons are,
/// under `mix`. Point, spot and directional lights send no light evenly from a surface: they are left to whoever adds
/// exact direct light, and `hasOthers` (where given) says whether there are any that shine.
[[nodiscard]] std::shared_ptr<const LightTree> lampTree(const LightSampler& lights, const Mix& mix, int samples,
                                                        std::uint64_t seed, bool* hasOthers = nullptr);

} // namespace lightloom
