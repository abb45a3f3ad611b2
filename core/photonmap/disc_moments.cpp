// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/disc_moments.h"

#include "core/base/wide_vectors.h"
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace lightloom {
namespace {

using Doubles4 = double __attribute__((vector_size(32)));
using Longs4 = std::int64_t __attribute__((vector_size(32)));

// vectors are handed over by reference: by value depends on the machine

[[gnu::always_inline]] inline void takeRoot(Doubles4& x)
{
    for (std::size_t i = 0; i < 4; ++i) x[i] = std::sqrt(x[i]);
}

[[gnu::always_inline]] inline double sumOf(const Doubles4& s) { return (s[0] + s[2]) + (s[1] + s[3]); }

/// Angles from 0 to pi with these sines (not negative) and cosines.
[[gnu::always_inline]] inline void findAngles(const Doubles4& sine, const Doubles4& cosine, Doubles4& out)
{
    // the tangent of half the angle, or its cotangent: from 0 to 1, as the tangent k of a known angle and a small rest
    const Doubles4 whole = 1.0 + (cosine < 0.0 ? -cosine : cosine), zero{};
    const Longs4 isMiddle = sine > 0.25 * whole, isLarge = sine > 0.75 * whole;
    const Doubles4 k = isLarge ? zero + 1.0 : isMiddle ? zero + 0.5 : zero;
    const Doubles4 known = isLarge ? zero + 0.25 * std::numbers::pi : isMiddle ? zero + 0.46364760900080611621 : zero;
    const Doubles4 t = (sine - k * whole) / (whole + k * sine); // at most 1/4
    const Doubles4 x = t * t, x2 = x * x, x4 = x2 * x2;
    const Doubles4 low = (1.0 - 1.0 / 3 * x) + x2 * (1.0 / 5 - 1.0 / 7 * x);
    const Doubles4 high = (1.0 / 9 - 1.0 / 11 * x) + x2 * (1.0 / 13 - 1.0 / 15 * x) + x4 * (1.0 / 17 - 1.0 / 19 * x);
    const Doubles4 angle = 2.0 * (known + t * (low + x4 * high)); // exact to 2e-14
    out = cosine < 0.0 ? std::numbers::pi - angle : angle;
}

/// Four corners from the one numbered `first` on, the last one again where there are no more. One at the origin is
/// taken to lie a little beside it: there it has no direction.
[[gnu::always_inline]] inline void fourCorners(std::span<const glm::dvec2> corners, std::size_t first, double radius,
                                               Doubles4& x, Doubles4& y)
{
    const std::size_t last = corners.size() - 1;
    const glm::dvec2 &a = corners[std::min(first, last)], &b = corners[std::min(first + 1, last)],
                     &c = corners[std::min(first + 2, last)], &d = corners[std::min(first + 3, last)];
    x = Doubles4{a.x, b.x, c.x, d.x}, y = Doubles4{a.y, b.y, c.y, d.y};
    const Doubles4 zero{}, near = zero + 1e-12 * radius;
    const Longs4 isThere = x * x + y * y > near * near;
    x = isThere ? x : near, y = isThere ? y : zero;
}

/// What edges take from the disc, four at a time, added to area, first x and y, xx, xy, yy of `sums`: the triangle
/// (origin, a, b) within it less the sector, signed; nothing where an edge from a to b does not meet it. Gives how
/// often the edges turn around the origin.
LIGHTLOOM_WIDE_VECTORS std::int64_t takenByEdges(std::span<const glm::dvec2> corners, double r, double* sums)
{
    Doubles4 ax, ay, bx, by; // edges go from a to b
    fourCorners(corners, corners.size() - 1, r, bx, by);
    Longs4 turns{};
    Doubles4 all[6] = {};
    for (std::size_t i = 0; i < corners.size(); i += 4) {
        const Doubles4 beforeX = bx, beforeY = by;
        fourCorners(corners, i, r, bx, by);
        ax = __builtin_shuffle(beforeX, bx, Longs4{3, 4, 5, 6}),
        ay = __builtin_shuffle(beforeY, by, Longs4{3, 4, 5, 6});
        // how often the way from a to b turns around the origin, by where it crosses the x axis right of it: exactly
        // the angles that sectors are given, summed over the polygon, whatever rounding says of an edge through the
        // origin. What lies on the axis counts as below it
        const Doubles4 across = ax * by - ay * bx;
        const Longs4 isLeft = (across > 0.0) | ((across == 0.0) & (bx > ax)); // the origin, of the way
        turns += ((ay <= 0.0) & (by > 0.0) & isLeft & 1) - ((ay > 0.0) & (by <= 0.0) & ~isLeft & 1);

        // where the line a + t d meets the circle: dd t^2 + 2 along t + outside = 0
        const Doubles4 dx = bx - ax, dy = by - ay, dd = dx * dx + dy * dy, along = ax * dx + ay * dy, zero{};
        const Doubles4 outside = ax * ax + ay * ay - r * r, gap = along * along - dd * outside;
        Doubles4 root = gap > 0.0 ? gap : zero;
        takeRoot(root);
        const Doubles4 in = -along - root, out = -along + root;
        const Doubles4 enter = in > 0.0 ? in : zero, leave = out < dd ? out : dd;
        const Longs4 meets = (gap > 0.0) & (enter < leave);
        if ((meets[0] | meets[1] | meets[2] | meets[3]) == 0) continue;
        const Doubles4 perLength = 1.0 / dd, begin = enter * perLength, end = leave * perLength;
        const Doubles4 px = ax + begin * dx, py = ay + begin * dy;
        const Longs4 leaves = out < dd; // if it does not, exactly b: it may lie near the origin
        const Doubles4 qx = leaves ? ax + end * dx : bx, qy = leaves ? ay + end * dy : by;

        Doubles4 atP = px * px + py * py, atQ = qx * qx + qy * qy, angle;
        takeRoot(atP), takeRoot(atQ);
        const Doubles4 both = 1.0 / (atP * atQ), toP = both * atQ, toQ = both * atP; // divisions are what costs here
        const Doubles4 ux = px * toP, uy = py * toP, vx = qx * toQ, vy = qy * toQ, turned = ux * vy - uy * vx;
        findAngles(turned < 0.0 ? -turned : turned, ux * vx + uy * vy, angle);
        const Doubles4 turn = isLeft ? angle : -angle;
        const double r2 = r * r, r3 = r2 * r / 3.0, r4 = r2 * r2 / 4.0;
        const Doubles4 doubled = 0.5 * (vx * vy - ux * uy); // (sin 2v - sin 2u) / 4

        const Doubles4 area = 0.5 * (px * qy - py * qx), third = 1.0 / 3 * area, part = 1.0 / 12 * area;
        const Doubles4 sx = px + qx, sy = py + qy;
        const auto add = [&](std::size_t moment, const Doubles4& value) { all[moment] += meets ? value : zero; };
        add(0, area - 0.5 * r2 * turn);
        add(1, third * sx - r3 * (vy - uy));
        add(2, third * sy - r3 * (ux - vx));
        add(3, part * (px * px + qx * qx + sx * sx) - r4 * (0.5 * turn + doubled));
        add(4, part * (px * py + qx * qy + sx * sy) - 0.5 * r4 * (vy * vy - uy * uy));
        add(5, part * (py * py + qy * qy + sy * sy) - r4 * (0.5 * turn - doubled));
    }
    for (std::size_t m = 0; m < 6; ++m) sums[m] = sumOf(all[m]);
    return (turns[0] + turns[2]) + (turns[1] + turns[3]);
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

AreaMoments momentsInDisc(std::span<const glm::dvec2> corners, double radius)
{
    assert(!corners.empty());
    // sectors of all edges together are the disc, or nothing if it lies outside: only edges that meet it count
    std::array<double, 6> m;
    const std::int64_t turns = takenByEdges(corners, radius, m.data());
    AreaMoments sum{m[0], {m[1], m[2]}, m[3], m[4], m[5]};
    if (turns != 0) sum += momentsOfDisc(radius).scaled(static_cast<double>(turns));
    return sum.area > 0.0 ? sum : AreaMoments{}; // rounding
}

} // namespace lightloom
