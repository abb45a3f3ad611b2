// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/units.h"
#include <cmath>
#include <limits>

namespace lightloom {

/// A small surface that sends light out evenly (Lambert), taken for a disc. `normal` unit, area m2.
struct DiscLight {
    glm::vec3 position;
    float area;
    glm::vec3 normal;
};

/// Where light is told apart by its distance: what comes from nearer is left to rays that look for themselves, what
/// comes from further to discs. In between both count, in shares that add up to 1, so that nothing jumps where a disc
/// crosses the border. Without a width everything belongs to discs. Metres; `outer` at most twice `inner`, which
/// ClusterBound relies on.
struct NearRange {
    float inner = 0.0f, outer = 0.0f;
    [[nodiscard]] bool isEmpty() const { return outer <= 0.0f; }
    [[nodiscard]] float shareOfRays(float distance) const
    {
        if (distance >= outer) return 0.0f;
        return distance <= inner ? 1.0f : (outer - distance) / (outer - inner);
    }
    [[nodiscard]] float shareOfDiscs(float distance) const { return 1.0f - shareOfRays(distance); }
};

/// A place that receives light: a point of a surface and its normal (unit).
struct Receiver {
    glm::vec3 position, normal;
};

/// Illuminance (lux) at the receiver per lumen of a flat piece of surface that nothing hides: cos cos' / (pi r^2 + k
/// area), times the share that `near` leaves to discs. What the piece sends as a whole differs from what its middle
/// would by area / r^2 times a factor of the angles, k = 3 cos'^2 - 1 + (n.n') cos' / cos: the mean over a square to
/// second order; 1 for a disc seen along its axis, where the form is exact. `leastK` keeps it from below; where it is
/// negative the piece counts twice at most.
[[nodiscard]] inline float pieceTransfer(const Receiver& at, const DiscLight& light, const NearRange& near,
                                         float leastK)
{
    const glm::vec3 to = light.position - at.position;
    const float squared = to.x * to.x + to.y * to.y + to.z * to.z;
    const float here = glm::dot(at.normal, to), there = -glm::dot(light.normal, to);
    if (!(here > 0.0f) || !(there > 0.0f) || !(squared > 0.0f)) return 0.0f;
    const float ratio = there / glm::max(here, 1e-6f * there); // cos' / cos
    const float k = 3.0f * there * there / squared - 1.0f + glm::dot(at.normal, light.normal) * ratio;
    const float sphere = kPi * squared;
    float spread = glm::max(k, leastK) * light.area;
    if (spread < 0.0f) { // 1 - x in place of 1 / (1 + x)
        const float gain = glm::min(-spread, sphere);
        spread = -sphere * gain / (sphere + gain);
    }
    const float share = near.isEmpty() ? 1.0f : near.shareOfDiscs(std::sqrt(squared));
    return share * (here * there / squared) / (sphere + spread);
}

/// The same of a single light. k is kept at 0 and above, and at 1 where no near rays keep r from 0, so that nothing
/// grows beyond bounds (METHODS section 5: no singularity, no clamp). In furnaces beside edges k = 1 lost up to 1.8 %,
/// k = 0 was 1.2 % too bright, this is within .8 %.
[[nodiscard]] inline float discTransfer(const Receiver& at, const DiscLight& light, const NearRange& near)
{
    return pieceTransfer(at, light, near, near.isEmpty() ? 1.0f : 0.0f);
}

/// The same of a cluster of lights that are all in view, by its mean (LightTree::mean).
[[nodiscard]] inline float meanTransfer(const Receiver& at, const DiscLight& mean, const NearRange& near)
{
    return pieceTransfer(at, mean, near, -std::numeric_limits<float>::infinity());
}

} // namespace lightloom
