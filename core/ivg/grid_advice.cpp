// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_advice.h"
#include "core/base/memory_use.h"
#include "core/base/units.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

constexpr std::uint64_t kSpacingPoints = 1000;
constexpr double kSpacingShare = 0.1;   ///< of the surface that may have walls nearer than the spacing
constexpr float kCellsBetween = 6.0f;   ///< of a grid, in the wall spacing
constexpr int kLeast = 16, kMost = 128; ///< cells along the longest side
constexpr double kMostBytes = 1 << 30;

/// Metres from surface to what it faces, at the tenth of the points where that is least.
float wallSpacing(const SceneProducts& scene)
{
    std::vector<float> found;
    for (const SurfacePoint& p : samplePoints(*scene.rays, *scene.lights, *scene.reach, kSpacingPoints, 1)) {
        Hit hit;
        const float far = scene.rays->scene().bounds.diagonal();
        const glm::vec3 from = scene.rays->leave(p.position, p.normal);
        found.push_back(scene.rays->intersect(from, p.normal, far, hit) ? hit.distance : far);
    }
    if (found.empty()) return 0.0f;
    const auto at = found.begin() + static_cast<std::ptrdiff_t>(kSpacingShare * static_cast<double>(found.size()));
    std::ranges::nth_element(found, at);
    return *at;
}

} // namespace

GridAdvice adviseGridSize(const SceneProducts& scene, const GridMemoryJob& memory, float shift)
{
    GridAdvice advice;
    advice.wallSpacing = wallSpacing(scene);
    const float longest = scene.rays->scene().bounds.longestSide();
    const float wanted = advice.wallSpacing > 0.0f ? kCellsBetween * longest / advice.wallSpacing : 0.0f;
    const auto whole = static_cast<int>(std::min(std::ceil(wanted / 4.0f) * 4.0f + 0.5f, 1e6f));
    advice.size = std::clamp(whole, kLeast, kMost);
    advice.isCut = whole > kMost;
    const double room = std::min(kMostBytes, 0.25 * machineMemoryBytes());
    GridMemoryJob grids = memory; // segments and ways take what they do at any size
    grids.photons = 0, grids.mostPathBytes = 0.0;
    while (advice.size > kLeast &&
           gridMemory(placeGrid(*scene.rays, {advice.size, glm::ivec3(0)}, shift), grids).most > room) {
        advice.size -= 4;
        advice.isCut = true;
    }
    return advice;
}

float leastWallCells(GridFilter filter) { return filter == GridFilter::trilinear ? 0.1f : 2.0f; }

std::uint64_t photonsForNoise(const IrradianceGrid& pilot, std::uint64_t pilotPhotons,
                              std::span<const SurfacePoint> points, double wanted)
{
    double square = 0.0, mean = 0.0;
    for (const SurfacePoint& p : points) {
        const double noise = static_cast<double>(pilot.noise(p.position, p.normal).value_or(0.0f));
        square += noise * noise;
        mean += static_cast<double>(luminance(pilot.irradiance(p.position, p.normal)));
    }
    if (points.empty() || mean <= 0.0) return pilotPhotons;
    const double relative =
        std::sqrt(square / static_cast<double>(points.size())) / (mean / static_cast<double>(points.size()));
    const double photons = static_cast<double>(pilotPhotons) * (relative / wanted) * (relative / wanted);
    return static_cast<std::uint64_t>(std::clamp(photons, static_cast<double>(pilotPhotons), 1e9));
}

} // namespace lightloom
