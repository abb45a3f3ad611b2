// SPDX-License-Identifier: Apache-2.0
#include "core/trace/emission_mean.h"
#include "core/trace/material.h"
#include <cmath>

namespace lightloom {
namespace {

/// Texels of the emission texture that a triangle covers.
double texelsOn(const RayScene& rays, std::uint32_t triangle)
{
    const Texture& texture = rays.material(triangle).emissionTexture;
    const SceneTriangle& t = rays.triangle(triangle);
    const Scene& scene = rays.scene();
    const Mesh& mesh = scene.meshes[static_cast<std::size_t>(scene.instances[t.instance].mesh)];
    const auto& uv = mesh.uv[texture.uvSet == 1 ? 1 : 0];
    if (!texture.isSet() || uv.empty()) return 0.0;
    const Image& image = scene.images[static_cast<std::size_t>(texture.image)];
    const glm::uvec3 v = mesh.triangles[t.indexInMesh];
    const glm::dvec2 size = glm::dvec2(texture.scale) * glm::dvec2(image.width, image.height);
    const glm::dvec2 e1 = glm::dvec2(uv[v.y] - uv[v.x]) * size, e2 = glm::dvec2(uv[v.z] - uv[v.x]) * size;
    const double texels = 0.5 * std::abs(e1.x * e2.y - e1.y * e2.x);
    return std::isfinite(texels) ? texels : 0.0;
}

} // namespace

glm::dvec3 meanEmission(const RayScene& rays, std::uint32_t triangle, double most)
{
    const double texels = texelsOn(rays, triangle);
    if (texels == 0.0) return glm::dvec3(emissionAt(rays, triangle, glm::vec2(1.0f / 3.0f)));
    const int n = static_cast<int>(std::ceil(std::sqrt(glm::clamp(32.0 * texels, 4.0, most))));
    const float step = 1.0f / static_cast<float>(n);
    glm::dvec3 sum(0.0);
    for (int i = 0; i < n; ++i) {
        for (int j = 0; i + j < n; ++j) {
            const glm::vec2 cell(static_cast<float>(i), static_cast<float>(j));
            sum += glm::dvec3(emissionAt(rays, triangle, (cell + 1.0f / 3.0f) * step));
            if (i + j + 1 < n) sum += glm::dvec3(emissionAt(rays, triangle, (cell + 2.0f / 3.0f) * step));
        }
    }
    return sum / (static_cast<double>(n) * n);
}

} // namespace lightloom
