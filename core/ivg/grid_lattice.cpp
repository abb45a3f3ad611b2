// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_lattice.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

constexpr float kFlat = 1e-3f; ///< of a cell: triangles that extend less along an axis are walls across it
constexpr int kLeastCells = 2;
constexpr std::size_t kPlaces = 512; ///< in a cell, at which flat triangles are told apart
constexpr float kLeastWall = 0.1f;   ///< of a cell's face: less in one place is no wall, but where curved surface turns
constexpr float kMargin = 1e-3f;     ///< of the bound: what rounding may take from the cell to spare

float fraction(float x) { return x - std::floor(x); }

} // namespace

std::vector<float> wallFractions(const RayScene& rays, int axis, float low, float cellSize)
{
    struct Flat {
        float place, area;
    };
    std::vector<Flat> flat;
    std::vector<double> areas(kPlaces, 0.0);
    const auto indexOf = [](float place) { return static_cast<std::size_t>(place * static_cast<float>(kPlaces)); };
    for (std::uint32_t i = 0; i < rays.triangleCount(); ++i) {
        const SceneTriangle& t = rays.triangle(i);
        const auto [least, most] = std::minmax({t.a[axis], t.b[axis], t.c[axis]});
        if (most - least > kFlat * cellSize) continue;
        // the last step below a whole cell is the next one's beginning
        float place = fraction((0.5f * (least + most) - low) / cellSize);
        if (place >= 1.0f) place = 0.0f;
        flat.push_back({place, 0.5f * glm::length(glm::cross(t.b - t.a, t.c - t.a))});
        areas[indexOf(place)] += static_cast<double>(flat.back().area);
    }
    std::vector<float> found;
    const double enough = static_cast<double>(kLeastWall * cellSize * cellSize);
    for (const Flat& f : flat) {
        const std::size_t at = indexOf(f.place);
        const double here = areas[at] + areas[(at + 1) % kPlaces] + areas[(at + kPlaces - 1) % kPlaces];
        if (here >= enough) found.push_back(f.place);
    }
    std::ranges::sort(found);
    const auto same = std::ranges::unique(found);
    found.erase(same.begin(), same.end());
    return found;
}

float freePlace(float wanted, const std::vector<float>& taken, float clearance)
{
    if (taken.empty()) return wanted;
    float nearest = wanted, distance = 2.0f, widest = 0.0f, middle = wanted;
    for (std::size_t i = 0; i < taken.size(); ++i) {
        const bool isLast = i + 1 == taken.size();
        const float begin = taken[i], end = isLast ? taken[0] + 1.0f : taken[i + 1];
        if (end - begin > widest) widest = end - begin, middle = 0.5f * (begin + end);
        if (end - begin < 2.0f * clearance) continue;
        for (const float turn : {-1.0f, 0.0f, 1.0f}) {
            const float place = std::clamp(wanted + turn, begin + clearance, end - clearance);
            if (std::abs(place - wanted - turn) >= distance) continue;
            distance = std::abs(place - wanted - turn);
            nearest = place;
        }
    }
    return fraction(distance < 2.0f ? nearest : middle);
}

GridLattice placeGrid(const RayScene& rays, const GridSize& size, float shift)
{
    const Bounds& bounds = rays.scene().bounds;
    const auto cellOf = [](float side, int cells) { // one of them is to spare
        return side * (1.0f + kMargin) / static_cast<float>(std::max(cells, kLeastCells) - 1);
    };
    const float longest = bounds.longestSide() > 0.0f ? bounds.longestSide() : 1.0f;
    GridLattice lattice;
    for (int axis = 0; axis < 3; ++axis) {
        const float side = bounds.size()[axis];
        const int asked = size.perAxis[axis];
        const float cell = asked > 0 && side > 0.0f ? cellOf(side, asked) : cellOf(longest, size.longest);
        const auto needed = static_cast<int>(std::ceil(side * (1.0f + 0.5f * kMargin) / cell)) + 1;
        const float place =
            freePlace(fraction(0.5f - shift), wallFractions(rays, axis, bounds.low[axis], cell), kWallClearance);
        lattice.cellSize[axis] = cell;
        lattice.cells[axis] = std::max(asked, needed);
        lattice.lowest[axis] = bounds.low[axis] - (1.0f - place) * cell;
    }
    return lattice;
}

} // namespace lightloom
