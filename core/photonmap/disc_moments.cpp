// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/disc_moments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lightloom {
namespace {

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// Signed, of the triangle (origin, p, q).
AreaMoments triangle(glm::dvec2 p, glm::dvec2 q) { return momentsOfTriangle(glm::dvec2(0.0), p, q, 0.5 * cross(p, q)); }

/// Signed angle from p to q.
double turnFrom(glm::dvec2 p, glm::dvec2 q)
{
    const double sine = cross(p, q), cosine = glm::dot(p, q);
    if (!(std::abs(sine) < 0.2 * cosine)) return std::atan2(sine, cosine);
    const double t = sine / cosine, tt = t * t; // most turns are small: the series, exact to 1e-13
    return t * (1.0 +
                tt * (-1.0 / 3 +
                      tt * (1.0 / 5 +
                            tt * (-1.0 / 7 + tt * (1.0 / 9 + tt * (-1.0 / 11 + tt * (1.0 / 13 + tt * (-1.0 / 15))))))));
}

/// Signed, of the sector of the disc between the directions of p and q.
AreaMoments sector(glm::dvec2 p, glm::dvec2 q, double r)
{
    const double turn = turnFrom(p, q);
    const double lp = glm::length(p), lq = glm::length(q);
    if (!(lp > 0.0 && lq > 0.0)) return {};
    // sines and cosines of the two directions; double angles from them
    const glm::dvec2 a = p / lp, b = q / lq;
    const double r2 = r * r, r3 = r2 * r / 3.0, r4 = r2 * r2 / 4.0;
    const double doubled = 0.5 * (b.x * b.y - a.x * a.y); // (sin 2b - sin 2a) / 4
    return {0.5 * r2 * turn,
            {r3 * (b.y - a.y), r3 * (a.x - b.x)},
            r4 * (0.5 * turn + doubled),
            r4 * 0.5 * (b.y * b.y - a.y * a.y),
            r4 * (0.5 * turn - doubled)};
}

/// Signed, of the triangle (origin, a, b) cut with the disc.
AreaMoments cutTriangle(glm::dvec2 a, glm::dvec2 b, double r)
{
    const glm::dvec2 d = b - a;
    const double dd = glm::dot(d, d);
    if (!(dd > 0.0)) return {};
    // where the line a + t d meets the circle
    const double half = glm::dot(a, d) / dd, gap = half * half - (glm::dot(a, a) - r * r) / dd;
    if (!(gap > 0.0)) return sector(a, b, r);
    const double root = std::sqrt(gap);
    const double enter = std::max(0.0, -half - root), leave = std::min(1.0, -half + root);
    if (enter >= leave) return sector(a, b, r);
    const glm::dvec2 p = a + enter * d, q = a + leave * d;
    AreaMoments sum = triangle(p, q);
    if (enter > 0.0) sum += sector(a, p, r);
    if (leave < 1.0) sum += sector(q, b, r);
    return sum;
}

} // namespace

AreaMoments AreaMoments::moved(const glm::dmat2& turn, glm::dvec2 shift) const
{
    const glm::dvec2 t = turn * first;
    const glm::dmat2 second = turn * glm::dmat2(xx, xy, xy, yy) * glm::transpose(turn);
    return {area, t + area * shift, second[0][0] + 2.0 * t.x * shift.x + area * shift.x * shift.x,
            second[0][1] + t.x * shift.y + t.y * shift.x + area * shift.x * shift.y,
            second[1][1] + 2.0 * t.y * shift.y + area * shift.y * shift.y};
}

AreaMoments momentsOfTriangle(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, double area)
{
    const glm::dvec2 s = a + b + c;
    const double part = area / 12.0;
    return {area, (area / 3.0) * s, part * (a.x * a.x + b.x * b.x + c.x * c.x + s.x * s.x),
            part * (a.x * a.y + b.x * b.y + c.x * c.y + s.x * s.y),
            part * (a.y * a.y + b.y * b.y + c.y * c.y + s.y * s.y)};
}

AreaMoments momentsOfDisc(double radius)
{
    const double area = std::numbers::pi * radius * radius, second = 0.25 * area * radius * radius;
    return {area, glm::dvec2(0.0), second, 0.0, second};
}

double depthInside(std::span<const glm::dvec2> corners)
{
    double depth = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec2 a = corners[i], d = corners[(i + 1) % corners.size()] - a;
        const double length = glm::length(d);
        if (length > 0.0) depth = std::min(depth, cross(a, d) / length);
    }
    return depth;
}

AreaMoments momentsInDisc(std::span<const glm::dvec2> corners, double radius)
{
    AreaMoments sum;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        sum += cutTriangle(corners[i], corners[(i + 1) % corners.size()], radius);
    }
    return sum.area > 0.0 ? sum : AreaMoments{}; // rounding
}

} // namespace lightloom
