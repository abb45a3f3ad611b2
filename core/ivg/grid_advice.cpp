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

namespace {

constexpr double kLeastLeft = 0.06; ///< of a variance, where smoothing takes all it can
constexpr double kStep = 1.02;      ///< between numbers of photons that are tried

/// The noise at a point for other numbers of photons (grid_smooth.h): a value keeps k = (b + c) / (b + c + 1) of
/// itself, b what its neighbours differ by over its variance, so that it grows with the photons, c what their mean errs
/// by over the same; k^2 + (1 - k)^2 c of the variance are left.
class PointNoise {
public:
    PointNoise(double raw, double smoothed) : square_(smoothed)
    {
        const double part = raw > 0.0 ? smoothed / raw : 1.0, c = kLeastLeft;
        // part = k^2 (1 + c) - 2 c k + c, solved for the larger k
        const double root = std::max(c * c - (1.0 + c) * (c - part), 0.0);
        const double kept = std::clamp((c + std::sqrt(root)) / (1.0 + c), c / (1.0 + c), 0.999);
        bend_ = (kept * (1.0 + c) - c) / (1.0 - kept);
        left_ = left(1.0);
    }
    /// lux^2, with `more` times the photons.
    [[nodiscard]] double squareFor(double more) const { return square_ / more * left(more) / left_; }

private:
    [[nodiscard]] double left(double more) const
    {
        const double apart = bend_ * more + kLeastLeft, kept = apart / (apart + 1.0);
        return kept * kept + (1.0 - kept) * (1.0 - kept) * kLeastLeft;
    }
    double square_, bend_ = 0.0, left_ = 1.0;
};

} // namespace

std::uint64_t photonsForNoise(const IrradianceGrid& raw, const IrradianceGrid& pilot, std::uint64_t pilotPhotons,
                              std::span<const SurfacePoint> points, double wanted)
{
    std::vector<PointNoise> noises;
    double mean = 0.0;
    for (const SurfacePoint& p : points) {
        const auto squareIn = [&](const IrradianceGrid& grid) {
            const auto noise = static_cast<double>(grid.noise(p.position, p.normal).value_or(0.0f));
            return noise * noise;
        };
        noises.emplace_back(squareIn(raw), squareIn(pilot));
        mean += static_cast<double>(luminance(pilot.irradiance(p.position, p.normal)));
    }
    if (points.empty() || mean <= 0.0) return pilotPhotons;
    mean /= static_cast<double>(points.size());
    const double most = 1e9 / static_cast<double>(pilotPhotons);
    double more = 1.0;
    for (; more < most; more *= kStep) {
        double square = 0.0;
        for (const PointNoise& noise : noises) square += noise.squareFor(more);
        if (square <= wanted * wanted * mean * mean * static_cast<double>(points.size())) break;
    }
    return static_cast<std::uint64_t>(std::min(more, most) * static_cast<double>(pilotPhotons));
}

} // namespace lightloom
