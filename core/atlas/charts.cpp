// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/charts.h"
#include "core/atlas/atlas_patch.h"
#include <algorithm>
#include <atomic>
#include <cmath>

namespace lightloom {
namespace {

constexpr double kFlatCosine = 1.0 - 1e-5;
constexpr std::size_t kMostFaces = 20'000; ///< larger curved pieces are halved unseen: a solve cannot be stopped

glm::dvec3 meanNormal(const Patch& patch)
{
    glm::dvec3 sum(0.0);
    for (const std::uint32_t f : patch.faces) sum += patch.mesh->normals[f] * patch.mesh->areas[f];
    const double length = glm::length(sum);
    return length > 0.0 ? sum / length : patch.mesh->normals[patch.faces.front()];
}

double leastCosine(const Patch& patch, glm::dvec3 normal)
{
    double least = 1.0;
    for (const std::uint32_t f : patch.faces) least = std::min(least, glm::dot(normal, patch.mesh->normals[f]));
    return least;
}

/// The faces of a patch with vertices of their own.
SurfaceMesh surfaceOf(const Patch& patch)
{
    std::vector<std::uint32_t> used;
    for (const std::uint32_t f : patch.faces) {
        for (int k = 0; k < 3; ++k) used.push_back(patch.mesh->corners[f][k]);
    }
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    SurfaceMesh surface;
    for (const std::uint32_t v : used) surface.positions.push_back(patch.mesh->positions[v]);
    const auto number = [&](std::uint32_t v) {
        return static_cast<std::uint32_t>(std::ranges::lower_bound(used, v) - used.begin());
    };
    for (const std::uint32_t f : patch.faces) {
        const glm::uvec3 c = patch.mesh->corners[f];
        surface.triangles.emplace_back(number(c.x), number(c.y), number(c.z));
    }
    return surface;
}

/// Scales the map so that its area is the surface's. False: the map has no area.
bool scaleToArea(const SurfaceMesh& surface, std::vector<glm::dvec2>& map)
{
    double wanted = 0.0, found = 0.0;
    for (const glm::uvec3 t : surface.triangles) {
        const glm::dvec3 a = surface.positions[t.x];
        wanted += glm::length(glm::cross(surface.positions[t.y] - a, surface.positions[t.z] - a));
        const glm::dvec2 u = map[t.y] - map[t.x], v = map[t.z] - map[t.x];
        found += u.x * v.y - u.y * v.x;
    }
    if (!(found > 0.0)) return false;
    for (glm::dvec2& p : map) p *= std::sqrt(wanted / found);
    return true;
}

/// Convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<glm::dvec2> hullOf(std::vector<glm::dvec2> points)
{
    std::ranges::sort(points, [](glm::dvec2 a, glm::dvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
    std::vector<glm::dvec2> hull;
    for (int half = 0; half < 2; ++half) {
        const std::size_t start = hull.size();
        for (const glm::dvec2 p : points) {
            while (hull.size() >= start + 2) {
                const glm::dvec2 u = hull.back() - hull[hull.size() - 2], v = p - hull.back();
                if (u.x * v.y - u.y * v.x > 0.0) break;
                hull.pop_back();
            }
            hull.push_back(p);
        }
        hull.pop_back();
        std::ranges::reverse(points);
    }
    return hull;
}

glm::dvec2 turned(glm::dvec2 p, glm::dvec2 along) { return {glm::dot(p, along), along.x * p.y - along.y * p.x}; }

/// Turns the map so that its box has the least area and lies along x, and moves it to the origin.
glm::dvec2 boxIn(std::vector<glm::dvec2>& map)
{
    const std::vector<glm::dvec2> hull = hullOf(map);
    glm::dvec2 best(1.0, 0.0), bestLow(0.0), bestSize(0.0);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull.size(); ++i) {
        glm::dvec2 along = hull[(i + 1) % hull.size()] - hull[i];
        const double length = glm::length(along);
        if (!(length > 0.0)) continue;
        along /= length;
        glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
        for (const glm::dvec2 p : hull) {
            low = glm::min(low, turned(p, along));
            high = glm::max(high, turned(p, along));
        }
        const glm::dvec2 size = high - low;
        if (!(size.x * size.y < least)) continue;
        least = size.x * size.y;
        best = along, bestLow = low, bestSize = size;
    }
    const bool isUpright = bestSize.y > bestSize.x; // a quarter turn: (x, y) -> (y, width - x)
    for (glm::dvec2& p : map) {
        p = turned(p, best) - bestLow;
        if (isUpright) p = {p.y, bestSize.x - p.x};
    }
    return isUpright ? glm::dvec2(bestSize.y, bestSize.x) : bestSize;
}

Chart chartOf(const Patch& patch, const SurfaceMesh& surface, std::vector<glm::dvec2> map, const Stretch& stretch)
{
    Chart chart;
    chart.stretch = stretch;
    const glm::dvec2 size = boxIn(map);
    chart.size = glm::vec2(size);
    for (const glm::dvec2 p : map) chart.uv.emplace_back(glm::clamp(p, glm::dvec2(0.0), size));
    for (std::size_t i = 0; i < patch.faces.size(); ++i) {
        const std::uint32_t face = patch.faces[i];
        chart.sides.push_back(patch.mesh->sides[face]);
        const glm::uvec3 c = surface.triangles[i];
        chart.corners.push_back(patch.mesh->isTurned[face] ? glm::uvec3(c.x, c.z, c.y) : c);
    }
    return chart;
}

bool isGood(const Stretch& stretch)
{
    return !stretch.folds && stretch.strayArea <= kMostStrayShare * stretch.area && stretch.mostScale <= kMostScale &&
           stretch.leastScale >= 1.0 / kMostScale;
}

/// The patch as a chart, or nothing if it has to be halved.
std::optional<Chart> flattened(const Patch& patch)
{
    const glm::dvec3 normal = meanNormal(patch);
    const double cosine = leastCosine(patch, normal);
    const bool isFlat = cosine >= kFlatCosine;
    if (!isFlat && (cosine <= 0.0 || patch.faces.size() > kMostFaces)) return {};
    const SurfaceMesh surface = surfaceOf(patch);
    if (isFlat) {
        std::vector<glm::dvec2> map = projected(surface, normal);
        Stretch exact;
        for (const std::uint32_t f : patch.faces) exact.area += patch.mesh->areas[f];
        exact.anisotropySum = exact.area;
        if (patch.faces.size() > 1) {
            const SurfaceBorder border = borderOf(surface);
            if (!border.isManifold || stretchOf(surface, map).folds || !isSimple(border, map)) return {};
        }
        return chartOf(patch, surface, std::move(map), exact);
    }
    const SurfaceBorder border = borderOf(surface);
    if (!border.isDisc(surface)) return {};
    std::optional<std::vector<glm::dvec2>> map = conformalMap(surface);
    if (!map || !scaleToArea(surface, *map)) return {};
    const Stretch stretch = stretchOf(surface, *map);
    if (!isGood(stretch) || !isSimple(border, *map)) return {};
    return chartOf(patch, surface, *std::move(map), stretch);
}

/// What became of one piece.
struct Outcome {
    std::optional<Chart> chart;
    std::vector<Patch> halves;
};

/// Meshes of all instances, fronts and backs apart. `sides` rising, so each instance's stand together.
std::vector<PatchMesh> meshesOf(const RayScene& rays, const std::vector<std::uint32_t>& sides, Workers& workers,
                                const std::stop_token& stop)
{
    std::vector<std::vector<std::uint32_t>> groups;
    for (std::size_t first = 0, last; first < sides.size(); first = last) {
        const std::uint32_t instance = rays.triangle(sides[first] / 2).instance;
        std::vector<std::uint32_t> fronts, backs;
        for (last = first; last < sides.size() && rays.triangle(sides[last] / 2).instance == instance; ++last) {
            (sides[last] % 2 != 0 ? backs : fronts).push_back(sides[last]);
        }
        for (auto* group : {&fronts, &backs}) {
            if (!group->empty()) groups.push_back(std::move(*group));
        }
    }
    std::vector<PatchMesh> meshes(groups.size());
    workers.run(groups.size(), stop, [&](std::size_t i) { meshes[i] = patchMesh(rays, groups[i]); });
    return meshes;
}

} // namespace

std::vector<Chart> makeCharts(const RayScene& rays, const std::vector<std::uint32_t>& sides, Workers& workers,
                              const std::stop_token& stop, const std::function<void(double)>& progress)
{
    const std::vector<PatchMesh> meshes = meshesOf(rays, sides, workers, stop);
    std::vector<std::vector<Patch>> pieces(meshes.size());
    workers.run(meshes.size(), stop, [&](std::size_t i) { pieces[i] = connectedPatches(meshes[i]); });
    std::vector<Patch> open;
    for (std::vector<Patch>& some : pieces) std::ranges::move(some, std::back_inserter(open));

    std::vector<Chart> charts;
    std::atomic<std::size_t> done = 0;
    while (!open.empty() && !stop.stop_requested()) {
        std::vector<Outcome> outcomes(open.size());
        workers.run(open.size(), stop, [&](std::size_t i) {
            outcomes[i].chart = flattened(open[i]);
            if (!outcomes[i].chart) {
                auto [a, b] = halved(open[i]);
                outcomes[i].halves.push_back(std::move(a));
                outcomes[i].halves.push_back(std::move(b));
            } else if (progress) {
                done += open[i].faces.size();
                progress(static_cast<double>(done) / static_cast<double>(sides.size()));
            }
        });
        std::vector<Patch> next;
        for (Outcome& outcome : outcomes) {
            if (outcome.chart) charts.push_back(*std::move(outcome.chart));
            std::ranges::move(outcome.halves, std::back_inserter(next));
        }
        open = std::move(next);
    }
    if (stop.stop_requested()) return {};
    for (Chart& chart : charts) chart.instance = rays.triangle(chart.sides.front() / 2).instance;
    std::ranges::sort(charts, {}, [](const Chart& c) { return c.sides.front(); });
    return charts;
}

} // namespace lightloom
