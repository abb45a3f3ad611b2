// SPDX-License-Identifier: Apache-2.0
#include "core/compare/field_noise.h"
#include "core/base/units.h"
#include <cmath>

namespace lightloom {

std::optional<double> statedNoise(const IndirectField& field, std::span<const SurfacePoint> points)
{
    double light = 0.0, variance = 0.0;
    bool known = false;
    for (const SurfacePoint& point : points) {
        const std::optional<float> noise = field.noise(point.position, point.normal);
        if (!noise) continue;
        known = true;
        variance += static_cast<double>(*noise) * static_cast<double>(*noise);
        light += static_cast<double>(luminance(field.irradiance(point.position, point.normal)));
    }
    if (!known || !(light > 0.0)) return {};
    const double count = static_cast<double>(points.size());
    return std::sqrt(variance / count) / (light / count);
}

} // namespace lightloom
