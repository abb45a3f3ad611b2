// SPDX-License-Identifier: Apache-2.0
#include "core/voxel/voxel_advice.h"
#include "core/base/units.h"
#include "core/transport/bright_entries.h"
#include <algorithm>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr float kGapCells = 2.0f;        ///< narrower ones close up
constexpr double kGapsThatMatter = 0.01; ///< of the surface

void lookForGaps(const RayScene& rays, std::span<const SurfacePoint> points, VoxelAdvice& advice)
{
    std::vector<VoxelAdvice::Gap> gaps;
    for (const SurfacePoint& point : points) {
        Hit hit;
        const float most = kGapCells * advice.cellSize;
        if (!rays.intersect(rays.leave(point.position, point.normal), point.normal, most, hit)) continue;
        const float width = glm::dot(hit.position - point.position, point.normal);
        // not the other side of an edge, which a ray along the surface would meet
        if (glm::dot(hit.facing(), point.normal) < -0.5f) gaps.push_back({point.position, width});
    }
    if (gaps.empty()) return;
    advice.inGaps = static_cast<double>(gaps.size()) / static_cast<double>(points.size());
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::ranges::nth_element(gaps, middle, {}, &VoxelAdvice::Gap::width);
    advice.gap = *middle;
}

/// Light of one lamp as it leaves the entries that it falls on first.
VoxelAdvice::Lamp lampOf(const VoxelField& field, int group, int directions)
{
    const VoxelLayer& layer = *field.layers()[static_cast<std::size_t>(group)];
    std::vector<float> lumen;
    double sum = 0.0, squares = 0.0;
    for (std::size_t e = 0; e < layer.direct.size(); ++e) {
        const glm::vec3 leaving = field.surface().albedo[e] * layer.direct[e];
        const float f = luminance(leaving) * field.surface().leaves->entries[e].area;
        lumen.push_back(f);
        sum += static_cast<double>(f);
        squares += static_cast<double>(f) * static_cast<double>(f);
    }
    if (!(squares > 0.0)) return {group, 0.0, false};
    return {group, sum * sum / squares, !brightestOf(lumen, static_cast<std::size_t>(directions)).empty()};
}

} // namespace

VoxelAdvice voxelAdvice(const RayScene& rays, std::span<const SurfacePoint> points, const VoxelField& field,
                        int directions)
{
    VoxelAdvice advice;
    advice.cellSize = field.surface().leaves->cellSize();
    lookForGaps(rays, points, advice);
    for (std::size_t g = 0; g < field.layers().size(); ++g) {
        if (!field.layers()[g] || gainOf(field.mix(), static_cast<int>(g)) == glm::vec3(0.0f)) continue;
        const VoxelAdvice::Lamp lamp = lampOf(field, static_cast<int>(g), directions);
        if (lamp.emitters > 0.0) advice.lamps.push_back(lamp);
    }
    return advice;
}

std::vector<std::string> adviceLines(const VoxelAdvice& advice, const Scene& scene)
{
    std::vector<std::string> lines;
    if (advice.inGaps >= kGapsThatMatter) {
        const glm::dvec3 at = scene.toFile(advice.gap->at);
        lines.push_back(
            fmt::format("{:.0f} % of the lit surface stands in gaps narrower than two voxels ({:.3g} m), at "
                        "({:.3g}, {:.3g}, {:.3g}) one of {:.3g} m: light there is that of the surface "
                        "around; a larger voxel.size parts them",
                        100.0 * advice.inGaps, kGapCells * advice.cellSize, at.x, at.y, at.z, advice.gap->width));
    }
    for (const VoxelAdvice::Lamp& lamp : advice.lamps) {
        if (!lamp.isConnected) continue;
        lines.push_back(
            fmt::format("{} lights a small patch, equal to {:.0f} voxels, which lines would meet by chance: "
                        "its light is carried on by shadow rays",
                        scene.groups[static_cast<std::size_t>(lamp.group)].label, lamp.emitters));
    }
    return lines;
}

} // namespace lightloom
