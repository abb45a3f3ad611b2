// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/low_discrepancy.h"
#include "core/base/sampling.h"
#include "core/base/statistics.h"
#include "core/trace/light_sampler.h"
#include "core/trace/ray_scene.h"
#include "tests/scene_checks.h"
#include <QtTest>
#include <algorithm>
#include <cmath>

/// What tests of light transport share: a scene ready for rays, limits for statistics, exact formulas in double.
namespace lightloom::test {

inline constexpr double kPiD = std::numbers::pi;

/// A scene with its rays and lamps. `ok` is false (and the test fails by itself) when Embree could not build it.
struct LitScene {
    explicit LitScene(Scene built) : scene(std::make_shared<const Scene>(std::move(built)))
    {
        auto made = RayScene::build(scene);
        if (!made) qFatal("%s", made.error().message.c_str());
        rays = *made;
        lights = std::make_unique<LightSampler>(rays);
    }
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RayScene> rays;
    std::unique_ptr<LightSampler> lights;
};

/// |z| that `comparisons` true claims exceed together with a chance of 1e-6 only (Sidak).
inline double sidakLimit(int comparisons, double familyWise = 1e-6)
{
    const double each = -std::expm1(std::log1p(-familyWise) / comparisons); // 1 - (1 - a)^(1/m)
    double low = 0.0, high = 40.0;
    for (int i = 0; i < 200; ++i) {
        const double z = 0.5 * (low + high);
        (std::erfc(z / std::sqrt(2.0)) > each ? low : high) = z;
    }
    return high;
}

/// Fails with all figures unless the mean of `found` lies within `limit` standard errors of `expected`. What has no
/// spread must fit to rounding.
#define VERIFY_MEAN(found, expected, limit, what)                                                                      \
    do {                                                                                                               \
        const double error_ = std::abs((found).mean() - (expected));                                                   \
        const double allowed_ = (limit) * (found).standardError() + 1e-5 * std::abs(expected);                         \
        QVERIFY2(error_ <= allowed_, qPrintable(QString("%1: %2 +- %3 instead of %4")                                  \
                                                    .arg(what)                                                         \
                                                    .arg((found).mean(), 0, 'g', 8)                                    \
                                                    .arg((found).standardError(), 0, 'g', 3)                           \
                                                    .arg(expected, 0, 'g', 8)));                                       \
    } while (false)

/// Lambert's contour formula (1760): E / M at `p` facing `n` from a planar polygon, clipped at the horizon.
inline double configurationFactor(glm::dvec3 p, glm::dvec3 n, const std::vector<glm::dvec3>& polygon)
{
    std::vector<glm::dvec3> above;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 a = polygon[i] - p, b = polygon[(i + 1) % polygon.size()] - p;
        const double da = glm::dot(a, n), db = glm::dot(b, n);
        if (da >= 0.0) above.push_back(a);
        if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) above.push_back(a + da / (da - db) * (b - a));
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < above.size(); ++i) {
        const glm::dvec3 a = above[i], b = above[(i + 1) % above.size()], c = glm::cross(a, b);
        const double length = glm::length(c);
        if (length > 0.0) sum += std::atan2(length, glm::dot(a, b)) * glm::dot(c, n) / length;
    }
    return std::abs(sum) / (2.0 * kPiD);
}

/// Solid angle of the side of a box as seen from `p` inside: axis 0..2, at the low or the high end.
inline double boxSideSolidAngle(glm::dvec3 p, glm::dvec3 low, glm::dvec3 high, int axis, bool isHigh)
{
    const double d = isHigh ? high[axis] - p[axis] : p[axis] - low[axis];
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double sum = 0.0;
    for (const double a : {p[u] - low[u], high[u] - p[u]}) {
        for (const double b : {p[v] - low[v], high[v] - p[v]})
            sum += std::atan(a * b / (d * std::sqrt(a * a + b * b + d * d)));
    }
    return sum;
}

/// Points on the front of the instances whose node begins with `nodes`, on the surface: each uniform by area, together
/// spread evenly (a shifted Hammersley set; `number` picks the shift).
struct FacePoint {
    glm::vec3 position, normal;
};
inline std::vector<FacePoint> facePoints(const Scene& scene, int count, std::uint64_t number,
                                         const std::string& nodes = {})
{
    const std::vector<PlacedTriangle> all = triangles(scene, nodes);
    std::vector<double> sums;
    double sum = 0.0;
    for (const PlacedTriangle& t : all) sums.push_back(sum += glm::length(t.areaVector()));
    std::vector<FacePoint> points;
    Rng rng(1, hashName("face points"), number);
    const ShiftedPoints even(count, rng);
    for (int i = 0; i < count; ++i) {
        const double at = double(even[i].x) * sum;
        const auto found = std::upper_bound(sums.begin(), sums.end(), at) - sums.begin();
        const std::size_t k = std::min(static_cast<std::size_t>(found), all.size() - 1);
        const double low = k > 0 ? sums[k - 1] : 0.0, within = glm::clamp((at - low) / (sums[k] - low), 0.0, 0.999999);
        const PlacedTriangle& t = all[k];
        const glm::vec2 b = sampleTriangle(float(within), even[i].y);
        const glm::vec3 p = t.corner[0] * (1.0f - b.x - b.y) + t.corner[1] * b.x + t.corner[2] * b.y;
        points.push_back({p, glm::vec3(glm::normalize(t.areaVector()))});
    }
    return points;
}

} // namespace lightloom::test
