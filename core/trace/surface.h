// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/dielectric.h"

namespace lightloom {

/// What a surface does with light at one point, textures looked up. The diffuse part is diffuse / pi on both sides.
struct Surface {
    glm::vec3 diffuse{0.0f};  ///< (1 - metallic) (1 - transmission) baseColor, each channel at most kLargestAlbedo
    glm::vec3 specular{0.0f}; ///< F0 of the metallic part, metallic x baseColor
    float grazing =
        kLargestAlbedo;       ///< what the metallic part reflects at grazing angles (Schlick's F90): metallic x .99
    float roughness = 1.0f;   ///< GGX alpha = roughness^2
    glm::vec3 emission{0.0f}; ///< cd/m2 towards the side that was hit; zero behind a single-sided emitter
    Glass glass;              ///< as met from the side that was hit
    [[nodiscard]] bool isMirror() const { return roughness < kMirrorRoughness && maxChannel3(specular) > 0.0f; }
    [[nodiscard]] bool hasSpecular() const { return maxChannel3(specular) > 0.0f; } ///< a metallic part
    /// Rays go on from here to what is seen in the metal or through the glass.
    [[nodiscard]] bool isSeenInto() const { return hasSpecular() || glass.share > 0.0f; }
    static float maxChannel3(glm::vec3 v) { return glm::max(v.x, glm::max(v.y, v.z)); }
};

/// An instance whose surface is the same everywhere (`isPlain`): no textures, no colours at vertices. `front` and
/// `back` are what a ray meets that comes from there.
struct InstanceLook {
    bool isPlain = false;
    bool isMatte = false; ///< plain, and diffuse on both sides, nothing else
    Surface front, back;
    float survival = 0.0f; ///< chance of roulette that a photon goes on from a matte surface: its largest channel
    glm::vec3 kept{0.0f};  ///< of the flux of one that does: diffuse / survival; 0 on black
};

} // namespace lightloom
