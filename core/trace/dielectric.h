// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"

/// What smooth glass does to light. Fluxes: reflected + through + absorbed = 1; luminance also scales with the square
/// of the index (Scatter::radianceScale). Indices are real: what glass absorbs, it absorbs on the way through.
namespace lightloom {

/// The clear part of a surface at one point.
struct Glass {
    float share = 0.0f;         ///< of the surface, (1 - metallic) transmission; 0: nothing gets through
    float eta = 1.0f;           ///< index behind the side that was hit over the index before it; 0: nothing gets in
    bool isThin = false;        ///< a pane: both borders at once, straight through
    glm::vec3 tint{0.0f};       ///< what a pass lets through: across one border, or through a pane's inside; 0 .. 1
    glm::vec3 absorption{0.0f}; ///< 1/m inside of the body; 0 for a pane
};

/// The share of unpolarised light that a border reflects (Fresnel), exact. `cosine` of the angle to the normal, 0 .. 1;
/// `eta` index beyond over index before. 1 under total reflection and where eta is not a positive number.
[[nodiscard]] float fresnelDielectric(float cosine, float eta);

/// Shares of light that arrives at `cosine` to the normal, times `glass.share`, per channel.
struct GlassShares {
    glm::vec3 reflected{0.0f}, through{0.0f};
};
/// A body's border: F and (1 - F) tint. A pane: its two borders and all the passes between them (geometric series),
/// F + (1-F)^2 F t^2 / (1 - F^2 t^2) and (1-F)^2 t / (1 - F^2 t^2).
[[nodiscard]] GlassShares glassShares(const Glass& glass, float cosine);

/// Direction after a border, in a frame with z along the normal of the side that was hit: `toEye` unit, z > 0; the
/// result unit, z <= 0. Only where fresnelDielectric is below 1.
[[nodiscard]] glm::vec3 refracted(glm::vec3 toEye, float eta);

/// Absorption (1/m) of a solid glass: Beer's law makes white light `attenuationColor` after `attenuationDistance`. A
/// channel of 0 counts as 1e-30, so that all stays finite.
[[nodiscard]] glm::vec3 absorptionOf(const Material& material);

} // namespace lightloom
