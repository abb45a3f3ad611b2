// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/atlas/lscm.h"

namespace lightloom {

/// The border of a surface: closed loops of vertices, the surface on their left.
struct SurfaceBorder {
    bool isManifold = true; ///< no edge has three triangles, or two that disagree on their front
    bool isPinched = false; ///< the border passes a vertex twice
    std::vector<std::vector<std::uint32_t>> loops;
    std::size_t edges = 0; ///< of the whole surface
    /// One loop and the Euler characteristic of a disc.
    [[nodiscard]] bool isDisc(const SurfaceMesh& mesh) const
    {
        return isManifold && !isPinched && loops.size() == 1 &&
               mesh.positions.size() + mesh.triangles.size() == edges + 1;
    }
};
[[nodiscard]] SurfaceBorder borderOf(const SurfaceMesh& mesh);

/// True if the flattened border loops neither cross themselves nor each other and exactly one of them runs around the
/// rest. With no triangle turned over, the map then covers no point of the plane twice.
[[nodiscard]] bool isSimple(const SurfaceBorder& border, const std::vector<glm::dvec2>& map);

/// How a map stretches its triangles, weighted by their area on the surface; the map scaled so that areas agree.
struct Stretch {
    double area = 0.0;                        ///< m2
    double anisotropySum = 0.0;               ///< area times largest over smallest singular value
    double worstAnisotropy = 1.0;             ///< of any triangle
    double leastScale = 1.0, mostScale = 1.0; ///< linear, of any triangle in any direction; 1 is true to scale
    double strayArea = 0.0;                   ///< m2 of triangles scaled by more than kStrayScale one way or the other
    bool folds = false;                       ///< a triangle is turned over or has no area
    [[nodiscard]] double meanAnisotropy() const { return area > 0.0 ? anisotropySum / area : 1.0; }
    void add(const Stretch& other);
};
inline constexpr double kStrayScale = 1.4;
[[nodiscard]] Stretch stretchOf(const SurfaceMesh& mesh, const std::vector<glm::dvec2>& map);

} // namespace lightloom
