// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_corners.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

constexpr float kBefore = 0.1f;  ///< cells before a surface within which a vertex counts in part
constexpr float kSlack = 0.05f;  ///< cells, for walls that are not quite parallel to an axis
constexpr float kBehind = 0.01f; ///< of what counts before a surface: where there is any, it decides
constexpr float kLean = 0.1f;    ///< of a normal along an axis that is enough to face a wall's side

/// 1 below -width, 0 above it.
float fade(float excess, float width) { return glm::clamp(0.5f - 0.5f * excess / width, 0.0f, 1.0f); }

/// Cell that holds `at` and the place in it, per axis.
struct CellPlace {
    glm::ivec3 cell;
    glm::vec3 in;
    CellPlace(const GridLattice& lattice, glm::vec3 at)
    {
        const glm::vec3 inside = glm::clamp(at, glm::vec3(0.0f), glm::vec3(lattice.cells));
        cell = glm::min(glm::ivec3(inside), lattice.cells - 1);
        in = inside - glm::vec3(cell);
    }
};

std::array<float, 4> cubicWeights(GridFilter filter, float t)
{
    const float tt = t * t, ttt = tt * t;
    if (filter == GridFilter::bspline) {
        const float s = 1.0f - t;
        return {s * s * s / 6.0f, (3.0f * ttt - 6.0f * tt + 4.0f) / 6.0f,
                (-3.0f * ttt + 3.0f * tt + 3.0f * t + 1.0f) / 6.0f, ttt / 6.0f};
    }
    return {0.5f * (-ttt + 2.0f * tt - t), 0.5f * (3.0f * ttt - 5.0f * tt + 2.0f), 0.5f * (-3.0f * ttt + 4.0f * tt + t),
            0.5f * (ttt - tt)};
}

} // namespace

glm::vec3 lookupPlace(const GridLattice& lattice, glm::vec3 p, glm::vec3 n, float offset)
{
    // a cell along n is a step of length 1 in grid coordinates
    const glm::vec3 inGrid = n / lattice.cellSize;
    return lattice.toGrid(p) + inGrid * (offset / glm::length(inGrid));
}

void trilinearCorners(const GridGeometry& geometry, glm::vec3 at, glm::vec3 p, glm::vec3 n, CornerSide allowed,
                      GridCorners& corners)
{
    const GridLattice& lattice = geometry.lattice;
    const GridOpenness& openness = geometry.openness;
    const CellPlace place(lattice, at);
    const glm::vec3 surface = lattice.toGrid(p), side = n * lattice.cellSize;
    for (int k = 0; k < 8; ++k) {
        const glm::ivec3 step(k & 1, k >> 1 & 1, k >> 2);
        const glm::ivec3 vertex = place.cell + step;
        const glm::vec3 near = glm::mix(1.0f - place.in, place.in, glm::vec3(step));
        const float weight = near.x * near.y * near.z;
        const std::size_t index = lattice.index(vertex);
        if (weight <= 0.0f || openness.isOpen[index] == 0) continue;
        const glm::vec3 away = surface - glm::vec3(vertex);
        // both tests fade, or light would jump where a surface that runs aslant loses one vertex after the other
        const float seen = glm::clamp(-glm::dot(away, side) / (glm::length(side) * kBefore), 0.0f, 1.0f);
        if (seen <= 0.0f && allowed == CornerSide::before) continue;
        float lean = 0.0f, sees = 1.0f;
        for (int axis = 0; axis < 3; ++axis) {
            const bool isUp = away[axis] > 0.0f;
            const int sight = openness.sight[index][static_cast<std::size_t>(2 * axis + (isUp ? 1 : 0))];
            if (sight == 255) continue;
            sees *= fade(std::abs(away[axis]) - static_cast<float>(sight) / GridOpenness::kSightUnits - kSlack, kSlack);
            lean = std::max(lean, isUp ? -n[axis] : n[axis]);
        }
        const float leans = allowed == CornerSide::leaning ? glm::clamp(lean / kLean, 0.0f, 1.0f) : 0.0f;
        const float counts = std::max(seen, kBehind * leans);
        if (counts * sees > 0.0f) corners.add(index, weight * sees * counts, weight * sees * std::max(seen, leans));
    }
}

void tricubicCorners(const GridLattice& lattice, glm::vec3 at, GridFilter filter, GridCorners& corners)
{
    const CellPlace place(lattice, at);
    const std::array xs = cubicWeights(filter, place.in.x), ys = cubicWeights(filter, place.in.y),
                     zs = cubicWeights(filter, place.in.z);
    for (int z = 0; z < 4; ++z) {
        for (int y = 0; y < 4; ++y) {
            for (int x = 0; x < 4; ++x) {
                const float weight =
                    xs[static_cast<std::size_t>(x)] * ys[static_cast<std::size_t>(y)] * zs[static_cast<std::size_t>(z)];
                const glm::ivec3 vertex = place.cell + glm::ivec3(x, y, z) - 1;
                corners.add(lattice.index(glm::clamp(vertex, glm::ivec3(0), lattice.cells)), weight, weight);
            }
        }
    }
}

} // namespace lightloom
