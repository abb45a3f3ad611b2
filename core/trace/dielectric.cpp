// SPDX-License-Identifier: Apache-2.0
#include "core/trace/dielectric.h"
#include <cmath>
#include <limits>

namespace lightloom {

float fresnelDielectric(float cosine, float eta)
{
    if (!(eta > 0.0f) || !(eta < std::numeric_limits<float>::infinity())) return 1.0f;
    if (eta == 1.0f) return 0.0f; // no border at all, grazing rays included
    const float c = glm::clamp(cosine, 0.0f, 1.0f);
    const float sine2 = (1.0f - c) * (1.0f + c) / (eta * eta);
    if (!(sine2 < 1.0f)) return 1.0f;
    const float beyond = std::sqrt(1.0f - sine2);
    const float across = (c - eta * beyond) / (c + eta * beyond), along = (eta * c - beyond) / (eta * c + beyond);
    return glm::min(1.0f, 0.5f * (across * across + along * along));
}

GlassShares glassShares(const Glass& glass, float cosine)
{
    const float f = fresnelDielectric(cosine, glass.eta);
    if (!glass.isThin) return {glm::vec3(glass.share * f), glass.share * (1.0f - f) * glass.tint};
    if (!(f < 1.0f)) return {glm::vec3(glass.share), glm::vec3(0.0f)};
    const glm::vec3 inside = f * glass.tint, once = (1.0f - f) * (1.0f - f) * glass.tint;
    const glm::vec3 through = once / (1.0f - inside * inside);
    return {glass.share * (f + through * inside), glass.share * through};
}

glm::vec3 refracted(glm::vec3 toEye, float eta)
{
    const float x = -toEye.x / eta, y = -toEye.y / eta;
    return {x, y, -std::sqrt(glm::max(0.0f, 1.0f - x * x - y * y))};
}

glm::vec3 absorptionOf(const Material& material)
{
    if (!(material.attenuationDistance > 0.0f)) return glm::vec3(0.0f);
    glm::vec3 absorption;
    for (int c = 0; c < 3; ++c) {
        const float left = glm::clamp(material.attenuationColor[c], 1e-30f, 1.0f);
        absorption[c] = glm::min(-std::log(left) / material.attenuationDistance, 1e30f);
    }
    return absorption;
}

} // namespace lightloom
