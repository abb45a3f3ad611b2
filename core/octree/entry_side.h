// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include <cstdint>

namespace lightloom {

/// The half-space that an entry answers in, in 8 + 8 bits: high byte, the direction out of the wall that ends it, in
/// the plane of the entry's surface (shaders/common_octree.glsl); low byte, least distance along it from the middle of
/// the leaf. 0: the entry answers on every side. `towards` is a unit vector across `normal`, `least` in cells. Also 0:
/// the wall is further than a lookup reaches.
[[nodiscard]] std::uint16_t packSide(glm::vec3 normal, glm::vec3 towards, float least);

/// Whether a place, in cells from the middle of the entry's leaf, is on the far side of the entry's wall.
[[nodiscard]] bool isBeyond(const OctreeEntry& entry, glm::vec3 fromMiddle);

} // namespace lightloom
