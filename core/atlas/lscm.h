// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

namespace lightloom {

/// A triangulated surface with vertices of its own.
struct SurfaceMesh {
    std::vector<glm::dvec3> positions;
    std::vector<glm::uvec3> triangles; ///< counter-clockwise
};

/// Least squares conformal map of a disc (Levy, Petitjean, Ray, Maillot 2002): per vertex a place in the plane, up to
/// scale and turn; angles are kept as well as they can be. Two far vertices are pinned at their distance. Nothing where
/// the system cannot be solved (triangles without area alone). Sparse Cholesky (Eigen): about n^1.5.
[[nodiscard]] std::optional<std::vector<glm::dvec2>> conformalMap(const SurfaceMesh& mesh);

/// Orthogonal projection along `normal` (unit): exact for a flat surface.
[[nodiscard]] std::vector<glm::dvec2> projected(const SurfaceMesh& mesh, glm::dvec3 normal);

} // namespace lightloom
