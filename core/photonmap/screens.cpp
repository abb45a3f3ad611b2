// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/screens.h"

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
    const std::array<glm::dvec3, kMost> from = points_;
    const std::size_t count = count_;
    count_ = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const glm::dvec3 a = from[i], b = from[(i + 1) % count];
        const double atA = glm::dot(normal, a) - least, atB = glm::dot(normal, b) - least;
        if (count_ + 2 > kMost) break;
        if (atA >= 0.0) points_[count_++] = a;
        if ((atA >= 0.0) != (atB >= 0.0)) points_[count_++] = a + (b - a) * (atA / (atA - atB));
    }
    if (count_ < 3) count_ = 0;
}

} // namespace lightloom
