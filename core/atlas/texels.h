// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/ray_scene.h"
#include <array>
#include <vector>

namespace lightloom {

/// A texel of an atlas and the surface it stands for.
struct SurfaceTexel {
    std::uint32_t texel; ///< y * width + x, row 0 at the top
    glm::vec3 position;  ///< scene space, on the surface
    glm::vec3 normal;    ///< shading normal of the side that the texel belongs to, unit
};

/// A triangle's side, flat in the atlas.
struct FlatFace {
    std::uint32_t side;                ///< 2 * triangle, + 1 for its back
    std::array<glm::dvec2, 3> corners; ///< texel coordinates of the triangle's a, b and c
};

/// The texels that faces touch.
struct TouchedTexels {
    std::vector<SurfaceTexel> texels; ///< rising
    std::uint64_t covered = 0;        ///< texels with their centre on a face
    std::uint64_t overlapping = 0;    ///< texels with their centre well inside two faces
};

/// Texels within the rectangle [low, high) of an atlas `width` texels wide whose square a face touches. A texel whose
/// centre lies on no face stands for the nearest point of the nearest face, moved a twentieth of a texel inwards, so
/// that shadow rays do not start in the wall beside. The lower side wins a tie. Faces may be needles or without area.
[[nodiscard]] TouchedTexels touchedTexels(const RayScene& rays, const std::vector<FlatFace>& faces, glm::ivec2 low,
                                          glm::ivec2 high, int width);

} // namespace lightloom
