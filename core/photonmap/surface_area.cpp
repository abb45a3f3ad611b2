// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/surface_area.h"
#include "core/base/ordering.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

/// Signed area of the disc of squared radius `r2` around the origin cut with the triangle (origin, a, b).
double sectorOrTriangle(glm::dvec2 a, glm::dvec2 b, double r2)
{
    const auto cross = [](glm::dvec2 u, glm::dvec2 v) { return u.x * v.y - u.y * v.x; };
    const auto sector = [&](glm::dvec2 u, glm::dvec2 v) { return 0.5 * r2 * std::atan2(cross(u, v), glm::dot(u, v)); };
    const auto triangle = [&](glm::dvec2 u, glm::dvec2 v) { return 0.5 * cross(u, v); };
    const glm::dvec2 d = b - a;
    const double dd = glm::dot(d, d);
    if (!(dd > 0.0)) return 0.0;
    // where the line a + t d meets the circle
    const double half = glm::dot(a, d) / dd, gap = half * half - (glm::dot(a, a) - r2) / dd;
    if (!(gap > 0.0)) return sector(a, b);
    const double root = std::sqrt(gap);
    const double enter = std::max(0.0, -half - root), leave = std::min(1.0, -half + root);
    if (enter >= leave) return sector(a, b);
    const glm::dvec2 p = a + enter * d, q = a + leave * d;
    double area = triangle(p, q);
    if (enter > 0.0) area += sector(a, p);
    if (leave < 1.0) area += sector(q, b);
    return area;
}

/// Moves along the normal are stretched: turns an ellipsoid around `centre` into a ball.
glm::dvec3 stretched(glm::vec3 p, glm::vec3 centre, glm::vec3 normal, double stretch)
{
    const glm::dvec3 d = glm::dvec3(p) - glm::dvec3(centre), n(normal);
    return d + n * ((stretch - 1.0) * glm::dot(n, d));
}

} // namespace

double triangleAreaInBall(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::dvec3 centre, double radius)
{
    a -= centre, b -= centre, c -= centre;
    const glm::dvec3 across = glm::cross(b - a, c - a);
    const double twice = glm::length(across);
    if (!(twice > 0.0)) return 0.0;
    const double r2 = radius * radius;
    if (glm::dot(a, a) <= r2 && glm::dot(b, b) <= r2 && glm::dot(c, c) <= r2) return 0.5 * twice;
    const glm::dvec3 n = across / twice;
    const double height = glm::dot(a, n), disc2 = r2 - height * height;
    if (!(disc2 > 0.0)) return 0.0;
    const glm::dvec3 u = glm::normalize(b - a), v = glm::cross(n, u);
    const auto flat = [&](glm::dvec3 p) { return glm::dvec2(glm::dot(p, u), glm::dot(p, v)); };
    const glm::dvec2 fa = flat(a), fb = flat(b), fc = flat(c);
    const double area =
        sectorOrTriangle(fa, fb, disc2) + sectorOrTriangle(fb, fc, disc2) + sectorOrTriangle(fc, fa, disc2);
    return std::clamp(area, 0.0, 0.5 * twice);
}

SurfaceArea::SurfaceArea(const LightReach& reach) : facets_(reach.facets()), total_(reach.area()) {}

std::shared_ptr<const SurfaceArea> SurfaceArea::build(const LightReach& reach, const std::stop_token& stop)
{
    const std::shared_ptr<SurfaceArea> made(new SurfaceArea(reach));
    const auto count = static_cast<std::uint32_t>(made->facets_.size());
    if (count > 0) made->split(0, count, stop);
    if (stop.stop_requested()) return nullptr;
    return made;
}

std::uint32_t SurfaceArea::split(std::uint32_t first, std::uint32_t last, const std::stop_token& stop)
{
    constexpr std::uint32_t kLeaf = 4, kLong = 16'384; // a long list looks at the stop
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low), lowCentre(low), highCentre(high);
    for (std::uint32_t i = first; i < last; ++i) {
        const ReachedFacet& f = facets_[i];
        low = glm::min(low, glm::min(f.a, glm::min(f.b, f.c)));
        high = glm::max(high, glm::max(f.a, glm::max(f.b, f.c)));
        const glm::vec3 centre = (f.a + f.b + f.c) / 3.0f;
        lowCentre = glm::min(lowCentre, centre);
        highCentre = glm::max(highCentre, centre);
    }
    const auto node = static_cast<std::uint32_t>(boxes_.size());
    boxes_.push_back({low, high, first, last - first});
    if (last - first <= kLeaf || (last - first > kLong && stop.stop_requested())) return node;

    const glm::vec3 size = highCentre - lowCentre;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const std::uint32_t middle = first + (last - first) / 2;
    const auto isBefore = [axis](const ReachedFacet& a, const ReachedFacet& b) {
        return a.a[axis] + a.b[axis] + a.c[axis] < b.a[axis] + b.b[axis] + b.c[axis];
    };
    const auto at = [this](std::uint32_t i) { return facets_.begin() + i; };
    if (!selectNth(at(first), at(middle), at(last), isBefore, stop)) return node;
    split(first, middle, stop);
    const std::uint32_t right = split(middle, last, stop);
    boxes_[node].first = right;
    boxes_[node].count = 0;
    return node;
}

double SurfaceArea::under(glm::vec3 centre, glm::vec3 normal, float radius, float stretch, float leastCosine) const
{
    if (boxes_.empty()) return 0.0;
    double sum = 0.0;
    const float r2 = radius * radius;
    std::uint32_t stack[64];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const std::uint32_t node = stack[--depth];
        const Box& box = boxes_[node];
        // the ellipsoid lies within the ball
        const glm::vec3 gap = glm::max(glm::max(box.low - centre, centre - box.high), glm::vec3(0.0f));
        if (glm::dot(gap, gap) > r2) continue;
        if (box.count == 0) {
            stack[depth++] = box.first;
            stack[depth++] = node + 1;
            continue;
        }
        for (std::uint32_t i = box.first; i < box.first + box.count; ++i) {
            const ReachedFacet& f = facets_[i];
            if (!(glm::dot(f.normal, normal) > leastCosine)) continue;
            if (stretch == 1.0f) {
                sum += triangleAreaInBall(f.a, f.b, f.c, centre, radius);
                continue;
            }
            const glm::dvec3 a = stretched(f.a, centre, normal, stretch), b = stretched(f.b, centre, normal, stretch),
                             c = stretched(f.c, centre, normal, stretch);
            const double grown = glm::length(glm::cross(b - a, c - a));
            const double real =
                glm::length(glm::cross(glm::dvec3(f.b) - glm::dvec3(f.a), glm::dvec3(f.c) - glm::dvec3(f.a)));
            if (grown > 0.0) sum += triangleAreaInBall(a, b, c, glm::dvec3(0.0), radius) * (real / grown);
        }
    }
    return sum;
}

} // namespace lightloom
