// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lightloom {

/// The cones of a KHR_lights_punctual spot: 1 inside the inner one, 0 outside the outer one, the square of a ramp in
/// the cosine between. Kept as 1 - cos, by the half angle: narrow spots would lose the difference to rounding.
class SpotCone {
public:
    SpotCone() = default;
    explicit SpotCone(const PunctualLight& light)
        : inner_(oneMinusCos(std::min(light.innerCone, light.outerCone))), outer_(oneMinusCos(light.outerCone))
    {
    }
    /// At a direction `cosAngle` off the axis.
    [[nodiscard]] float falloff(float cosAngle) const
    {
        const double off = 1.0 - static_cast<double>(cosAngle);
        if (off <= inner_) return 1.0f;
        if (off >= outer_) return 0.0f; // also when the cones coincide: no rim to divide by
        const double t = (outer_ - off) / rim();
        return static_cast<float>(t * t);
    }
    /// Integral of the fall-off over the sphere, sr: the inner cap, and the rim's squared ramp in the cosine.
    [[nodiscard]] double solidAngle() const { return 2.0 * std::numbers::pi * (inner_ + rim() / 3.0); }
    /// A direction around +z in proportion to the fall-off; `u1`, `u2` uniform in [0,1).
    [[nodiscard]] glm::vec3 sample(double u1, double u2) const
    {
        const double total = inner_ + rim() / 3.0, at = u1 * total;
        double off = at;
        if (at > inner_) off = outer_ - rim() * std::cbrt((total - at) / (rim() / 3.0));
        const double r = std::sqrt(std::max(0.0, off * (2.0 - off))), phi = 2.0 * std::numbers::pi * u2;
        return {static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
                static_cast<float>(1.0 - off)};
    }

private:
    [[nodiscard]] double rim() const { return outer_ - inner_; }
    static double oneMinusCos(float angle)
    {
        const double s = std::sin(0.5 * glm::clamp(static_cast<double>(angle), 0.0, std::numbers::pi));
        return 2.0 * s * s;
    }

    double inner_ = 0.0, outer_ = 0.0;
};

} // namespace lightloom
