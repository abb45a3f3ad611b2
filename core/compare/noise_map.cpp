// SPDX-License-Identifier: Apache-2.0
#include "core/compare/noise_map.h"
#include "core/bake/view_eye.h"
#include "core/base/units.h"
#include <limits>

namespace lightloom {
namespace {

constexpr int kMostMirrors = 8;

struct Seen {
    float noise = 0.0f; ///< lux
    float light = 0.0f; ///< lux; 0 where there is no answer
};

Seen along(const RayScene& rays, const IndirectField& field, glm::vec3 origin, glm::vec3 travel)
{
    for (int bounce = 0; bounce < kMostMirrors; ++bounce) {
        Hit hit;
        if (!rays.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) return {};
        const glm::vec3 n = hit.facing();
        const Surface surface = surfaceAt(rays, hit);
        if (surface.diffuse != glm::vec3(0.0f)) {
            return {field.noise(hit.position, n).value_or(0.0f), luminance(field.irradiance(hit.position, n))};
        }
        Scatter next;
        if (!scatter(surface, n, -travel, glm::vec3(0.5f), next) || !next.isMirror) return {};
        origin = rays.leave(hit.position, next.side(n));
        travel = next.away;
    }
    return {};
}

} // namespace

ScalarImage noiseMap(const RayScene& rays, const IndirectField& field, const Camera& camera, int width, int height,
                     Workers& workers, const std::stop_token& stop)
{
    const ViewJob job{camera, width, height};
    const Lens lens(job);
    const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
    ScalarImage map{width, height, std::vector<float>(columns * rows, 0.0f)};
    std::vector<double> light(rows, 0.0);
    std::vector<std::size_t> answers(rows, 0);
    const bool isWhole = workers.run(rows, stop, [&](std::size_t y) {
        for (std::size_t x = 0; x < columns; ++x) {
            glm::vec3 origin, travel;
            lens.ray(static_cast<int>(x), static_cast<int>(y), glm::vec2(0.5f), origin, travel);
            const Seen seen = along(rays, field, origin, travel);
            map.values[y * columns + x] = seen.noise;
            light[y] += static_cast<double>(seen.light);
            answers[y] += seen.light > 0.0f ? 1 : 0;
        }
    });
    if (!isWhole) return {};
    double sum = 0.0, count = 0.0;
    for (std::size_t y = 0; y < rows; ++y) sum += light[y], count += static_cast<double>(answers[y]);
    const float scale = sum > 0.0 ? static_cast<float>(count / sum) : 0.0f;
    for (float& value : map.values) value *= scale;
    return map;
}

} // namespace lightloom
