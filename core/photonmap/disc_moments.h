// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <glm/glm.hpp>
#include <span>

namespace lightloom {

/// Integrals over a piece of flat surface in two coordinates x = (x, y): of 1, of x, and of x times x transposed.
struct AreaMoments {
    double area = 0.0;     ///< m2
    glm::dvec2 first{0.0}; ///< m3
    double xx = 0.0, xy = 0.0, yy = 0.0;

    AreaMoments& operator+=(const AreaMoments& o)
    {
        area += o.area, first += o.first;
        xx += o.xx, xy += o.xy, yy += o.yy;
        return *this;
    }
    [[nodiscard]] AreaMoments scaled(double by) const { return {by * area, by * first, by * xx, by * xy, by * yy}; }
    /// The same surface in coordinates turn * x + shift; the area stays.
    [[nodiscard]] AreaMoments moved(const glm::dmat2& turn, glm::dvec2 shift) const;
};

/// Of a triangle that has `area` (its own, or what it stands for).
[[nodiscard]] AreaMoments momentsOfTriangle(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, double area);

/// Of the whole disc around the origin.
[[nodiscard]] AreaMoments momentsOfDisc(double radius);

/// Of the part of a convex polygon (corners counter-clockwise) within `radius` of the origin; exact.
[[nodiscard]] AreaMoments momentsInDisc(std::span<const glm::dvec2> corners, double radius);

} // namespace lightloom
