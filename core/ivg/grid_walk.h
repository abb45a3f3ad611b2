// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/wide_vectors.h"
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

/// How a segment passes through a grid, in grid coordinates (vertices lie where they are whole). Header only: these are
/// the innermost loops.
namespace lightloom {

/// Grid planes `first` to `last`; none where `first` is larger.
struct PlaneRange {
    int first = 0, last = -1;
    [[nodiscard]] PlaneRange within(PlaneRange o) const { return {std::max(first, o.first), std::min(last, o.last)}; }
    [[nodiscard]] int count() const { return std::max(0, last - first + 1); }
};

/// Planes that a way from `from` to `to` along one axis crosses: its end counts, its start does not. So a path that
/// turns on a plane crosses it once, one that stays in a plane does not cross it, and light that ends on a wall in a
/// plane has crossed it while what the wall sends back has not. Both finite and within int.
[[nodiscard]] inline PlaneRange crossedPlanes(float from, float to)
{
    const bool isUp = from < to; // as good as random: choices of values, not of ways
    const float first = isUp ? std::floor(from) + 1.0f : std::ceil(to);
    const float last = isUp ? std::floor(to) : std::ceil(from) - 1.0f;
    return {static_cast<int>(first), static_cast<int>(last)};
}

/// Calls visit(plane, u, v) for `planes` of `axis`, rising, which the segment crosses; (u, v) are coordinates along
/// axes axis + 1 and axis + 2, which may lie outside the grid. Planes of one axis do not depend on those of the others,
/// so there is no order to keep between them.
template<class Visit>
inline void forPlanes(const glm::vec3& from, const glm::vec3& to, int axis, PlaneRange planes, const Visit& visit)
{
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const float perPlane = 1.0f / (to[axis] - from[axis]);
    const float du = (to[u] - from[u]) * perPlane, dv = (to[v] - from[v]) * perPlane;
    for (int plane = planes.first; plane <= planes.last; ++plane) {
        const float way = static_cast<float>(plane) - from[axis];
        visit(plane, from[u] + way * du, from[v] + way * dv);
    }
}

/// The same four planes at a time: visit(plane, count, us, vs), the last with fewer than four that count.
template<int axis, class Visit>
inline void forFourPlanes(const glm::vec3& from, const glm::vec3& to, PlaneRange planes, const Visit& visit)
{
    constexpr int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const float perPlane = 1.0f / (to[axis] - from[axis]);
    const float du = (to[u] - from[u]) * perPlane, dv = (to[v] - from[v]) * perPlane;
    for (int plane = planes.first; plane <= planes.last; plane += 4) {
        const Floats4 way = __builtin_convertvector(plane + Ints4{0, 1, 2, 3}, Floats4) - from[axis];
        visit(plane, std::min(4, planes.last - plane + 1), from[u] + way * du, from[v] + way * dv);
    }
}

/// The same for those of `planes` that the segment crosses, each once.
template<class Visit>
inline void forCrossings(const glm::vec3& from, const glm::vec3& to, int axis, PlaneRange planes, const Visit& visit)
{
    const PlaneRange crossed = crossedPlanes(from[axis], to[axis]).within(planes);
    if (crossed.first <= crossed.last) forPlanes(from, to, axis, crossed, visit);
}

/// Calls visit(vertex, begin, share) for the cells around vertices (from half a cell before to half a cell behind, cut
/// off at the grid's border) that the segment passes, for vertices whose z is among `layers`; it is in the cell from
/// `begin`, a part of its length, and for `share` of it. Shares of all layers add up to what lies inside the grid.
template<class Visit>
inline void forPieces(const glm::vec3& from, const glm::vec3& to, const glm::ivec3& cells, PlaneRange layers,
                      const Visit& visit)
{
    const glm::vec3 way = to - from;
    float begin = 0.0f, end = 1.0f;
    for (int axis = 0; axis < 3; ++axis) {
        const auto border = static_cast<float>(cells[axis]);
        float low = 0.0f, high = border;
        if (axis == 2) {
            low = std::max(low, static_cast<float>(layers.first) - 0.5f);
            high = std::min(high, static_cast<float>(layers.last) + 0.5f);
        }
        if (way[axis] == 0.0f) {
            // a way along the border of two layers belongs to the upper one
            const bool isInside = from[axis] >= low && (from[axis] < high || (high == border && from[axis] == high));
            if (!isInside) return;
            continue;
        }
        const float a = (low - from[axis]) / way[axis], b = (high - from[axis]) / way[axis];
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    if (!(begin < end)) return;
    glm::ivec3 vertex, step;
    glm::vec3 next;
    for (int axis = 0; axis < 3; ++axis) {
        const float at = from[axis] + begin * way[axis];
        int index = std::clamp(static_cast<int>(std::floor(at + 0.5f)), 0, cells[axis]);
        if (axis == 2) index = std::clamp(index, layers.first, layers.last);
        step[axis] = way[axis] > 0.0f ? 1 : -1;
        const auto nextOf = [&] {
            return (static_cast<float>(index) + 0.5f * static_cast<float>(step[axis]) - from[axis]) / way[axis];
        };
        next[axis] = 2.0f;
        if (way[axis] != 0.0f) {
            if (nextOf() <= begin) index = std::clamp(index + step[axis], 0, cells[axis]); // it begins on the border
            next[axis] = nextOf();
        }
        vertex[axis] = index;
    }
    const glm::vec3 perCell = 1.0f / glm::abs(way); // infinite where never used
    while (true) {
        const int axis = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
        const float until = std::min(next[axis], end);
        if (until > begin) visit(vertex, begin, until - begin);
        if (next[axis] >= end) return;
        begin = std::max(begin, until);
        vertex[axis] += step[axis];
        next[axis] += perCell[axis];
        if (vertex[axis] < 0 || vertex[axis] > cells[axis]) return;
        if (axis == 2 && (vertex.z < layers.first || vertex.z > layers.last)) return;
    }
}

} // namespace lightloom
