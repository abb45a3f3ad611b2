// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/rng.h"
#include "core/transport/partner_finder.h"
#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

/// What tests of discrete lines share.
namespace lightloom::test {

/// All directions with components up to `most`, each once: those of every octant and every order of axes.
inline std::vector<LineDirection> allDirections(int most)
{
    std::vector<LineDirection> lines;
    std::set<std::tuple<int, int, int>> seen;
    for (int x = -most; x <= most; ++x) {
        for (int y = -most; y <= most; ++y) {
            for (int z = -most; z <= most; ++z) {
                if (std::gcd(std::gcd(x, y), z) != 1) continue;
                const LineDirection line = lineAlong({x, y, z});
                if (seen.insert({line.step.x, line.step.y, line.step.z}).second) lines.push_back(line);
            }
        }
    }
    return lines;
}

/// Voxels by hand: a cell and the orientations in it.
class HandMade {
public:
    explicit HandMade(int cells)
    {
        voxels_.cells = cells;
        voxels_.lattice.depth = 5;
        voxels_.lattice.rootSize = 32.0f; // cells of one metre
    }
    void add(glm::ivec3 cell, const std::vector<Orientation>& entries)
    {
        voxels_.voxels.push_back(cell);
        voxels_.firstEntry.push_back(static_cast<std::uint32_t>(voxels_.entries.size()));
        voxels_.entries.insert(voxels_.entries.end(), entries.begin(), entries.end());
    }
    /// One entry, of so much surface that no line passes beside it.
    void add(glm::ivec3 cell, glm::vec3 normal) { add(cell, {{glm::vec3(cell) + 0.5f, normal, 1e4f}}); }
    SurfaceVoxels finish()
    {
        voxels_.firstEntry.push_back(static_cast<std::uint32_t>(voxels_.entries.size()));
        return voxels_;
    }
    /// Partners of all entries along one direction.
    std::vector<std::uint32_t> partnersAlong(glm::ivec3 step, VoxelLines how = VoxelLines::covered)
    {
        const SurfaceVoxels voxels = finish();
        const VoxelOrders orders(voxels, how);
        const auto lines = partnerFinder(voxels, orders);
        const auto found = lines->find(lineAlong(step), 0);
        return {found.begin(), found.end()};
    }

private:
    SurfaceVoxels voxels_;
};

/// Along none of the directions: rounding would decide what such a surface faces.
inline glm::vec3 anyNormal(Rng& rng, const std::vector<LineDirection>& directions)
{
    while (true) {
        const glm::vec3 n = glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) * 2.0f - 1.0f;
        const float length = glm::length(n);
        const auto isAlong = [&](const LineDirection& d) { return std::abs(glm::dot(n, d.unit)) <= 1e-3f * length; };
        if (length > 0.01f && std::ranges::none_of(directions, isAlong)) return n / length;
    }
}

/// Line of a cell by the formula, in exact arithmetic: floor(p / q) for q > 0.
inline std::pair<int, int> lineOf(glm::ivec3 cell, const LineDirection& d)
{
    const auto floorOf = [](int p, int q) { return p >= 0 ? p / q : -((-p + q - 1) / q); };
    const int k = d.major, a = d.step[k], x = cell[k];
    const auto aside = [&](int axis) { return floorOf(-2 * d.step[axis] * x + a, 2 * a); };
    return {cell[(k + 1) % 3] + aside((k + 1) % 3), cell[(k + 2) % 3] + aside((k + 2) % 3)};
}

/// The voxels of each line, in the order of its slices.
inline std::vector<std::vector<std::uint32_t>> voxelsByLine(const SurfaceVoxels& voxels, const LineDirection& d)
{
    std::map<std::pair<int, int>, std::vector<std::uint32_t>> lines;
    for (std::uint32_t i = 0; i < voxels.voxels.size(); ++i) lines[lineOf(voxels.voxels[i], d)].push_back(i);
    std::vector<std::vector<std::uint32_t>> sorted;
    for (auto& [number, line] : lines) {
        std::ranges::sort(line, {}, [&](std::uint32_t i) { return voxels.voxels[i][d.major]; });
        sorted.push_back(std::move(line));
    }
    return sorted;
}

} // namespace lightloom::test
