// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace lightloom {

/// A wall as a gather kernel's centre sees it: what lies within a wedge of directions and behind the wall's plane is on
/// the far side, and its light says nothing of this one. A point is hidden that is on the inner side of both `sides`
/// and further than `behind` along `away`. All from the kernel's centre, scene space. Wedges of walls do not overlap;
/// what is hidden in all directions (`beyond`) may overlap with them.
struct Screen {
    static Screen beyond(glm::vec3 away, float behind) { return {{away, away}, away, behind}; }
    [[nodiscard]] bool isInAllDirections() const { return sides[0] == away; }
    std::array<glm::vec3, 2> sides; ///< normals of planes through the centre, pointing into the wedge
    glm::vec3 away;                 ///< unit: normal of the wall, away from the centre
    float behind = 0.0f;            ///< metres along `away` from the centre

    [[nodiscard]] bool hides(glm::vec3 fromCentre) const
    {
        return glm::dot(away, fromCentre) > behind && glm::dot(sides[0], fromCentre) >= 0.0f &&
               glm::dot(sides[1], fromCentre) >= 0.0f;
    }

    /// Whether part of a box (corners from the centre) may be hidden.
    [[nodiscard]] bool mayHide(glm::vec3 low, glm::vec3 high) const
    {
        const glm::vec3 middle = 0.5f * (low + high), half = 0.5f * (high - low);
        const auto most = [&](glm::vec3 n) { return glm::dot(n, middle) + glm::dot(glm::abs(n), half); };
        return most(away) > behind && most(sides[0]) >= 0.0f && most(sides[1]) >= 0.0f;
    }
    enum class Part { none, some, all };
    /// How much of a triangle is hidden; `some` where it is not sure.
    [[nodiscard]] Part partOf(const std::array<glm::vec3, 3>& corners) const;
};
using Screens = std::span<const Screen>;

[[nodiscard]] inline bool isHidden(Screens screens, glm::vec3 fromCentre)
{
    for (const Screen& screen : screens) {
        if (screen.hides(fromCentre)) return true;
    }
    return false;
}

/// A part of a triangle (corners from the kernel's centre): a convex polygon, in the same order.
class FacetPart {
public:
    static constexpr std::size_t kMost = 12; ///< corners: a triangle gains one a cut; more by rounding
    explicit FacetPart(const std::array<glm::dvec3, 3>& corners) { std::ranges::copy(corners, points_.begin()); }
    /// What the screen hides stays.
    void keepHidden(const Screen& screen);
    /// What a screen in all directions hides goes.
    void dropBeyond(const Screen& screen);
    [[nodiscard]] std::span<const glm::dvec3> corners() const { return std::span(points_).first(count_); }

private:
    void keepAbove(glm::dvec3 normal, double least);
    std::array<glm::dvec3, kMost> points_;
    std::size_t count_ = 3;
};

} // namespace lightloom
