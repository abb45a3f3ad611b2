// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/atlas/atlas.h"

namespace lightloom {

/// An atlas of `size` texels a side from the scene's own second UV set (TEXCOORD_1) for `sides` (rising). Every mesh
/// must have one, within 0..1 and without overlap, instances of one mesh included. A back shares its front's place: the
/// front counts where light reaches both. What lookups read beyond mip 0 is the set's own affair: texels within
/// kPadding of a face are filled. Errors name the first mesh that does not fit; cancelled.
[[nodiscard]] Result<std::shared_ptr<Atlas>>
atlasFromSceneUv(const RayScene& rays, const std::vector<std::uint32_t>& sides, int size, const std::stop_token& stop);

} // namespace lightloom
