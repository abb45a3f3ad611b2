// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/ray_scene.h"

namespace lightloom {

/// The surface at a hit. A black metal reflects nothing at any angle. Needs texture coordinates for a texture to count.
[[nodiscard]] Surface surfaceAt(const RayScene& rays, const Hit& hit);

/// The looks of all instances, in their order.
[[nodiscard]] std::vector<InstanceLook> instanceLooks(const Scene& scene);

/// Emission at barycentric (b1, b2) of a triangle seen from its front, cd/m2.
[[nodiscard]] glm::vec3 emissionAt(const RayScene& rays, std::uint32_t triangle, glm::vec2 barycentric);

/// Texture lookup with the sampler's wrap and filter; `uv` before the texture's transform. Values in [0,1];
/// sRGB decoded if `srgb` (before filtering).
[[nodiscard]] glm::vec4 sampleTexture(const Scene& scene, const Texture& texture, glm::vec2 uv, bool srgb);

/// The chance of going on after `bounces` surfaces, at most: light that is trapped in clear glass by total reflection
/// would go round for ever. Mild, because light that leaks out slowly comes back the heavier. 1 elsewhere.
[[nodiscard]] inline float clearChance(const Surface& surface, int bounces)
{
    return surface.glass.share > 0.0f && bounces >= 64 ? 0.97f : 1.0f;
}

/// One scattered direction.
struct Scatter {
    glm::vec3 away{0.0f};   ///< unit, leaves the surface: to the other side if `isThrough`
    glm::vec3 weight{0.0f}; ///< brdf * cos / pdf of the whole mixture; a mirror's or glass's share / chance of its lobe
    float pdf = 0.0f;       ///< per solid angle, of the whole mixture; 0 for a mirror and glass
    bool isMirror = false;  ///< a delta lobe, a mirror's or glass's: next event estimation cannot see it
    bool isSpecular = false; ///< the metallic lobe was taken (a mirror's or GGX's), or glass
    bool isThrough = false;  ///< into or out of glass
    /// Light that comes back along the way it went is brighter by this on the eye's side of a border, 1 / eta^2: a
    /// pencil of rays narrows in glass. Flux, and with it `weight`, knows nothing of that.
    float radianceScale = 1.0f;
    [[nodiscard]] glm::vec3 radianceWeight() const { return weight * radianceScale; } ///< for paths from the eye
    /// Normal of the side that the path leaves from; `n` is that of the side it came to.
    [[nodiscard]] glm::vec3 side(glm::vec3 n) const { return isThrough ? -n : n; }
};

/// BRDF (1/sr, without cosine) for unit `toLight`, `toEye` and the unit normal `n` on their side; mirrors and glass
/// give 0.
[[nodiscard]] glm::vec3 brdf(const Surface& surface, glm::vec3 n, glm::vec3 toLight, glm::vec3 toEye);
/// Density (1/sr) with which `scatter` picks `away`; mirrors and glass count 0.
[[nodiscard]] float scatterPdf(const Surface& surface, glm::vec3 n, glm::vec3 away, glm::vec3 toEye);
/// Picks a direction: glass, specular or diffuse lobe by what they would send on; Fresnel's share, visible-normal GGX
/// (Heitz 2018) or cosine within. `u` three uniform numbers. False: nothing goes on there.
[[nodiscard]] bool scatter(const Surface& surface, glm::vec3 n, glm::vec3 toEye, glm::vec3 u, Scatter& out);

} // namespace lightloom
