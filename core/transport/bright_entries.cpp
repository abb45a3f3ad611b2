// SPDX-License-Identifier: Apache-2.0
#include "core/transport/bright_entries.h"
#include <algorithm>
#include <numbers>

namespace lightloom {
namespace {

/// Cells that a ray's ends lie off the surface: the centroid of bent surface lies inside of it.
constexpr float kOff = 0.15f;
constexpr double kMeetings = 10.0; ///< lines that meet what sends light, on average, for it to count as spread

} // namespace

std::vector<std::uint32_t> brightestOf(std::span<const float> lumen, std::size_t directions)
{
    constexpr std::size_t kLong = 4; // sums that do not wait for each other
    double sums[kLong] = {}, squared[kLong] = {};
    for (std::size_t i = 0; i < lumen.size(); ++i) {
        const auto f = static_cast<double>(lumen[i]);
        sums[i % kLong] += f;
        squared[i % kLong] += f * f;
    }
    const double sum = (sums[0] + sums[1]) + (sums[2] + sums[3]);
    const double squares = (squared[0] + squared[1]) + (squared[2] + squared[3]);
    const auto ways = static_cast<double>(directions);
    const double spread = std::min(ways, kMeetings * static_cast<double>(lumen.size()) / ways);
    if (!(sum * sum < spread * squares)) return {};
    std::vector<std::uint32_t> brightest;
    for (std::uint32_t e = 0; e < lumen.size(); ++e)
        if (lumen[e] > 0.0f) brightest.push_back(e);
    const auto isBrighter = [&](std::uint32_t a, std::uint32_t b) {
        return lumen[a] != lumen[b] ? lumen[a] > lumen[b] : a < b;
    };
    const std::size_t count = std::min(kMostBright, brightest.size());
    std::ranges::partial_sort(brightest, brightest.begin() + static_cast<std::ptrdiff_t>(count), isBrighter);
    brightest.resize(count);
    double theirs = 0.0;
    for (const std::uint32_t e : brightest) theirs += static_cast<double>(lumen[e]);
    if (theirs < 0.5 * sum) return {};
    return brightest;
}

glm::vec3 luxFrom(std::span<const BrightEntry> bright, std::size_t entry, const RayScene& rays,
                  const SurfaceVoxels& voxels)
{
    const Orientation& at = voxels.entries[entry];
    const glm::vec3 from = at.centroid + kOff * voxels.cellSize() * at.normal;
    glm::vec3 lux(0.0f);
    for (const BrightEntry& source : bright) {
        const Orientation& o = voxels.entries[source.entry];
        const glm::vec3 way = o.centroid - at.centroid;
        const float along = glm::dot(way, at.normal), away = -glm::dot(way, o.normal), squared = glm::dot(way, way);
        if (source.entry == entry || !(along > 0.0f && away > 0.0f)) continue;
        if (rays.isBlocked(from, o.centroid + kOff * voxels.cellSize() * o.normal)) continue;
        const float seen = along * away / squared * o.area / (std::numbers::pi_v<float> * squared + o.area);
        lux += seen * source.radiosity;
    }
    return lux;
}

} // namespace lightloom
