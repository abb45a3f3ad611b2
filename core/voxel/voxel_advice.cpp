// SPDX-License-Identifier: Apache-2.0
#include "core/voxel/voxel_advice.h"
#include "core/base/units.h"
#include "core/transport/bright_entries.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr float kGapCells = 2.0f;        ///< narrower ones close up
constexpr double kGapsThatMatter = 0.01; ///< of the surface
constexpr float kDark = 0.1f;            ///< of the light on the other side

using Gaps = std::vector<VoxelAdvice::Gap>;

/// The one of middling width; nothing: there are none.
std::optional<VoxelAdvice::Gap> middling(Gaps gaps)
{
    if (gaps.empty()) return {};
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::ranges::nth_element(gaps, middle, {}, &VoxelAdvice::Gap::width);
    return *middle;
}

double shareOf(const Gaps& gaps, std::size_t points)
{
    return points == 0 ? 0.0 : static_cast<double>(gaps.size()) / static_cast<double>(points);
}

void lookForGaps(const RayScene& rays, std::span<const SurfacePoint> points, VoxelAdvice& advice)
{
    Gaps gaps;
    for (const SurfacePoint& point : points) {
        Hit hit;
        const float most = kGapCells * advice.cellSize;
        if (!rays.intersect(rays.leave(point.position, point.normal), point.normal, most, hit)) continue;
        const float width = glm::dot(hit.position - point.position, point.normal);
        // not the other side of an edge, which a ray along the surface would meet
        if (glm::dot(hit.facing(), point.normal) < -0.5f) gaps.push_back({point.position, width});
    }
    advice.inGaps = shareOf(gaps, points.size());
    advice.gap = middling(std::move(gaps));
}

/// Which sides of triangles light reaches, at least in part: by 2 * triangle, + 1 for the back.
std::vector<bool> reachedSides(const LightReach& reach)
{
    std::vector<bool> sides;
    for (const ReachedFacet& facet : reach.facets()) {
        if (sides.size() <= facet.side) sides.resize(facet.side + std::size_t{1});
        sides[facet.side] = true;
    }
    return sides;
}

/// The far side of what is thinner than a voxel behind `point`, if light reaches it: its thickness.
std::optional<VoxelAdvice::Gap> farSide(const RayScene& rays, const std::vector<bool>& isReached,
                                        const SurfacePoint& point, float cellSize, glm::vec3& outwards)
{
    const auto has = [&](std::size_t side) { return side < isReached.size() && isReached[side]; };
    const std::size_t front = std::size_t{2} * point.triangle;
    if (has(front) && has(front + 1)) { // a sheet
        outwards = -point.normal;
        return VoxelAdvice::Gap{point.position, 0.0f};
    }
    Hit hit;
    const glm::vec3 inwards = -point.normal;
    if (!rays.intersect(rays.leave(point.position, inwards), inwards, cellSize, hit)) return {};
    // from within: its other side is the one that counts
    const std::size_t side = std::size_t{2} * hit.triangle + (hit.isFront ? 1 : 0);
    if (glm::dot(hit.facing(), point.normal) < 0.5f || !has(side)) return {};
    outwards = -hit.facing();
    return VoxelAdvice::Gap{hit.position, glm::dot(point.position - hit.position, point.normal)};
}

void lookForThinThings(const RayScene& rays, const LightReach& reach, std::span<const SurfacePoint> points,
                       const VoxelField& field, VoxelAdvice& advice)
{
    const std::vector<bool> isReached = reachedSides(reach);
    const auto luxAt = [&](glm::vec3 p, glm::vec3 n) {
        glm::vec3 lux(0.0f);
        return field.lookup(p, n, lux) ? luminance(lux) : 0.0f;
    };
    Gaps thin, dark;
    for (const SurfacePoint& point : points) {
        glm::vec3 outwards;
        const auto far = farSide(rays, isReached, point, advice.cellSize, outwards);
        if (!far) continue;
        const VoxelAdvice::Gap found{point.position, far->width};
        thin.push_back(found);
        const float here = luxAt(point.position, point.normal), there = luxAt(far->at, outwards);
        if (glm::min(here, there) <= kDark * glm::max(here, there)) dark.push_back(found);
    }
    advice.onThin = shareOf(thin, points.size());
    advice.onThinBeforeDark = shareOf(dark, points.size());
    advice.thin = middling(std::move(dark));
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

VoxelAdvice voxelAdvice(const RayScene& rays, const LightReach& reach, std::span<const SurfacePoint> points,
                        const VoxelField& field, int directions)
{
    VoxelAdvice advice;
    advice.cellSize = field.surface().leaves->cellSize();
    lookForGaps(rays, points, advice);
    lookForThinThings(rays, reach, points, field, advice);
    for (std::size_t g = 0; g < field.layers().size(); ++g) {
        if (!field.layers()[g] || gainOf(field.mix(), static_cast<int>(g)) == glm::vec3(0.0f)) continue;
        const VoxelAdvice::Lamp lamp = lampOf(field, static_cast<int>(g), directions);
        if (lamp.emitters > 0.0) advice.lamps.push_back(lamp);
    }
    return advice;
}

namespace {

/// "(1.20, 0.85, 1.00)" in the file's frame, to a tenth of a voxel or better.
std::string placeText(const Scene& scene, glm::vec3 p, float cellSize)
{
    const int digits = std::clamp(static_cast<int>(std::ceil(1.0f - std::log10(cellSize))), 0, 6);
    const double unit = std::pow(10.0, -digits);
    const glm::dvec3 at = glm::round(scene.toFile(p) / unit) * unit + 0.0; // no "-0"
    return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", at.x, digits, at.y, digits, at.z, digits);
}

std::string lampLine(const std::vector<const VoxelAdvice::Lamp*>& lamps, const Scene& scene)
{
    const auto label = [&](std::size_t i) -> const std::string& {
        return scene.groups[static_cast<std::size_t>(lamps[i]->group)].label;
    };
    if (lamps.size() == 1) {
        return fmt::format("{} lights a small patch, equal to {:.0f} voxels, which lines would meet by chance: its "
                           "light is carried on by shadow rays",
                           label(0), lamps[0]->emitters);
    }
    const auto [least, most] = std::ranges::minmax_element(lamps, {}, &VoxelAdvice::Lamp::emitters);
    const std::size_t others = lamps.size() - 2;
    return fmt::format(
        "{}{} {}{} light small patches, equal to {:.0f} to {:.0f} voxels each, which lines would meet by "
        "chance: their light is carried on by shadow rays",
        label(0), others > 0 ? "," : " and", label(1),
        others == 0   ? ""
        : others == 1 ? " and one more lamp"
                      : fmt::format(" and {} more lamps", others),
        (*least)->emitters, (*most)->emitters);
}

} // namespace

std::vector<std::string> adviceLines(const VoxelAdvice& advice, const Scene& scene)
{
    std::vector<std::string> lines;
    if (advice.inGaps >= kGapsThatMatter) {
        lines.push_back(fmt::format("{:.0f} % of the lit surface stands in gaps narrower than two voxels ({:.3g} m), "
                                    "at {} one of {:.3g} m: light there is that of the surface around; more voxels "
                                    "(voxel.size) part them",
                                    100.0 * advice.inGaps, kGapCells * advice.cellSize,
                                    placeText(scene, advice.gap->at, advice.cellSize), advice.gap->width));
    }
    if (advice.onThinBeforeDark >= kGapsThatMatter) {
        lines.push_back(fmt::format("{:.0f} % of the lit surface is on walls, boards or columns thinner than a voxel "
                                    "({:.3g} m) with ten times as much light on one side as on the other, at {} one of "
                                    "{:.3g} m: up to 2 % of it comes through; more voxels (voxel.size) keep it out",
                                    100.0 * advice.onThinBeforeDark, advice.cellSize,
                                    placeText(scene, advice.thin->at, advice.cellSize), advice.thin->width));
    }
    std::vector<const VoxelAdvice::Lamp*> connected;
    for (const VoxelAdvice::Lamp& lamp : advice.lamps)
        if (lamp.isConnected) connected.push_back(&lamp);
    if (!connected.empty()) lines.push_back(lampLine(connected, scene));
    return lines;
}

} // namespace lightloom
