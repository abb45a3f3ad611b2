// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/screens.h"
#include <utility>

namespace lightloom {

Screen::Part Screen::partOf(const std::array<glm::vec3, 3>& corners) const
{
    bool isWhole = true;
    const auto cuts = [&](glm::vec3 normal, float least) {
        int within = 0;
        for (const glm::vec3 corner : corners) within += glm::dot(normal, corner) > least ? 1 : 0;
        isWhole = isWhole && within == 3;
        return within > 0;
    };
    if (!cuts(away, behind) || !cuts(sides[0], 0.0f) || !cuts(sides[1], 0.0f)) return Part::none;
    return isWhole ? Part::all : Part::some;
}

void FacetPart::keepHidden(const Screen& screen)
{
    keepAbove(glm::dvec3(screen.away), static_cast<double>(screen.behind));
    if (screen.isInAllDirections()) return;
    for (const glm::vec3 side : screen.sides) keepAbove(glm::dvec3(side), 0.0);
}

void FacetPart::dropBeyond(const Screen& screen)
{
    keepAbove(-glm::dvec3(screen.away), -static_cast<double>(screen.behind));
}

void FacetPart::keepAbove(glm::dvec3 normal, double least)
{
    std::array<double, kMost> above; // by how much
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i) {
        above[i] = glm::dot(normal, points_[i]) - least;
        kept += above[i] >= 0.0 ? 1 : 0;
    }
    if (kept == count_) return;
    if (kept == 0) {
        count_ = 0;
        return;
    }
    std::array<glm::dvec3, kMost> from;
    const std::size_t count = std::exchange(count_, 0);
    std::copy_n(points_.begin(), count, from.begin());
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t next = i + 1 < count ? i + 1 : 0;
        if (count_ + 2 > kMost) break;
        if (above[i] >= 0.0) points_[count_++] = from[i];
        if ((above[i] >= 0.0) != (above[next] >= 0.0))
            points_[count_++] = from[i] + (from[next] - from[i]) * (above[i] / (above[i] - above[next]));
    }
    if (count_ < 3) count_ = 0;
}

} // namespace lightloom
