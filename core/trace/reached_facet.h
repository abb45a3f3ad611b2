// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <glm/glm.hpp>

namespace lightloom {

/// A piece of surface that light can reach, seen from the side it reaches: a whole triangle, or part of a large one.
struct ReachedFacet {
    glm::vec3 a, b, c;  ///< scene space
    glm::vec3 normal;   ///< geometric, unit, of that side
    std::uint32_t side; ///< 2 * triangle, + 1 for its back
};

} // namespace lightloom
