// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/atlas.h"
#include "core/atlas/chart_pack.h"
#include "core/atlas/scene_uv.h"
#include <algorithm>
#include <chrono>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr double kChartShare = 0.6, kPackShare = 0.8; ///< of the work, about

double msSince(std::chrono::steady_clock::time_point began)
{
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - began).count();
}

Error stopped() { return {Error::Kind::cancelled, "unwrapping was cancelled"}; }

Error doesNotFit(std::size_t charts, const AtlasOptions& options)
{
    if (options.texelsPerMetre > 0.0) {
        return {Error::Kind::badInput, fmt::format("{} texels per metre take an atlas of more than {} texels a side; "
                                                   "ask for fewer",
                                                   options.texelsPerMetre, kMostAtlas)};
    }
    return {Error::Kind::badInput, fmt::format("the {} charts of the scene do not fit into an atlas of {} texels a "
                                               "side; ask for a larger one",
                                               charts, options.size)};
}

Result<Packing> packed(const std::vector<Chart>& charts, const AtlasOptions& options, const std::stop_token& stop)
{
    std::optional<Packing> packing;
    if (options.texelsPerMetre > 0.0) {
        for (int size = kLeastAtlas; size <= kMostAtlas && !packing && !stop.stop_requested(); size *= 2) {
            packing = pack(charts, size / kBlock, options.texelsPerMetre, stop);
        }
    } else {
        packing = packIntoSide(charts, options.size / kBlock, stop);
    }
    if (stop.stop_requested()) return stopped();
    if (!packing) return doesNotFit(charts.size(), options);
    return *std::move(packing);
}

/// Fills in where sides lie, rising.
void placeSides(const std::vector<Chart>& charts, const Packing& packing, Atlas& atlas)
{
    std::vector<std::pair<std::uint32_t, std::array<glm::vec2, 3>>> placed;
    const double scale = 1.0 / static_cast<double>(atlas.size);
    for (std::size_t i = 0; i < charts.size(); ++i) {
        for (std::size_t f = 0; f < charts[i].sides.size(); ++f) {
            std::array<glm::vec2, 3> uv{};
            for (int k = 0; k < 3; ++k) {
                const glm::vec2 p = charts[i].uv[charts[i].corners[f][k]];
                uv[static_cast<std::size_t>(k)] =
                    glm::vec2(packing.places[i].texel(charts[i], p, packing.texelsPerMetre) * scale);
            }
            placed.emplace_back(charts[i].sides[f], uv);
        }
    }
    std::ranges::sort(placed, {}, [](const auto& p) { return p.first; });
    for (const auto& [side, uv] : placed) atlas.sides.push_back(side), atlas.uv.push_back(uv);
}

void ownTexels(const Packing& packing, Atlas& atlas)
{
    atlas.owners.resize(atlas.texelCount());
    for (std::size_t i = 0; i < atlas.owners.size(); ++i) {
        const std::size_t x = i % static_cast<std::size_t>(atlas.size), y = i / static_cast<std::size_t>(atlas.size);
        atlas.owners[i] = packing.owner[y / kBlock * static_cast<std::size_t>(packing.side) + x / kBlock];
    }
}

TouchedTexels texelsOf(const RayScene& rays, const Chart& chart, const ChartPlace& place, double scale, int size)
{
    std::vector<FlatFace> faces;
    glm::dvec2 most(0.0);
    for (std::size_t f = 0; f < chart.sides.size(); ++f) {
        FlatFace face{chart.sides[f], {}};
        for (int k = 0; k < 3; ++k) {
            const glm::dvec2 p = place.texel(chart, chart.uv[chart.corners[f][k]], scale);
            face.corners[static_cast<std::size_t>(k)] = p;
            most = glm::max(most, p);
        }
        faces.push_back(face);
    }
    const glm::ivec2 low = place.block * kBlock;
    return touchedTexels(rays, faces, low, glm::min(glm::ivec2(most) + kPadding, glm::ivec2(size)), size);
}

/// Runs the texels of all charts and joins them in order. False: stopped.
bool listTexels(const RayScene& rays, const std::vector<Chart>& charts, const Packing& packing, Atlas& atlas,
                Workers& workers, const std::stop_token& stop)
{
    std::vector<TouchedTexels> found(charts.size());
    const bool all = workers.run(charts.size(), stop, [&](std::size_t i) {
        found[i] = texelsOf(rays, charts[i], packing.places[i], packing.texelsPerMetre, atlas.size);
    });
    if (!all) return false;
    std::uint64_t covered = 0;
    for (const TouchedTexels& some : found) {
        atlas.texels.insert(atlas.texels.end(), some.texels.begin(), some.texels.end());
        covered += some.covered;
        atlas.report.overlappingTexels += some.overlapping;
    }
    atlas.report.utilisation = static_cast<double>(covered) / static_cast<double>(atlas.texelCount());
    return true;
}

Result<std::shared_ptr<Atlas>> fromCharts(const RayScene& rays, const std::vector<std::uint32_t>& sides,
                                          const AtlasOptions& options, Workers& workers, const std::stop_token& stop,
                                          const std::function<void(double)>& progress)
{
    const auto tell = [&](double fraction) {
        if (progress) progress(fraction);
    };
    auto atlas = std::make_shared<Atlas>();
    AtlasReport& report = atlas->report;
    auto began = std::chrono::steady_clock::now();
    const std::vector<Chart> charts = makeCharts(rays, sides, workers, stop, [&](double f) { tell(kChartShare * f); });
    report.chartMs = msSince(began);
    if (stop.stop_requested()) return stopped();
    tell(kChartShare);

    began = std::chrono::steady_clock::now();
    const Result<Packing> packing = packed(charts, options, stop);
    report.packMs = msSince(began);
    if (!packing) return packing.error();
    tell(kPackShare);

    began = std::chrono::steady_clock::now();
    atlas->size = packing->texels();
    atlas->voidUv = glm::vec2(0.5f * kVoidBlocks * kBlock / static_cast<float>(atlas->size));
    placeSides(charts, *packing, *atlas);
    ownTexels(*packing, *atlas);
    if (!listTexels(rays, charts, *packing, *atlas, workers, stop)) return stopped();
    report.texelMs = msSince(began);
    report.charts = charts.size();
    report.texelsPerMetre = packing->texelsPerMetre;
    for (const Chart& chart : charts) report.stretch.add(chart.stretch);
    tell(1.0);
    return atlas;
}

} // namespace

Result<Done> checkAtlasOptions(const AtlasOptions& options)
{
    const bool isSizeFine = options.size >= kLeastAtlas && options.size <= kMostAtlas && options.size % kBlock == 0;
    if (!isSizeFine) {
        return Error{Error::Kind::badInput, fmt::format("an atlas of {} texels a side was asked for; it may be {} to "
                                                        "{} in steps of {}",
                                                        options.size, kLeastAtlas, kMostAtlas, kBlock)};
    }
    if (!(options.texelsPerMetre >= 0.0 && options.texelsPerMetre <= 1e12)) {
        return Error{Error::Kind::badInput,
                     fmt::format("{} texels per metre were asked for; give a number above 0", options.texelsPerMetre)};
    }
    return Done{};
}

std::optional<std::size_t> Atlas::find(std::uint32_t side) const
{
    const auto at = std::ranges::lower_bound(sides, side);
    if (at == sides.end() || *at != side) return {};
    return static_cast<std::size_t>(at - sides.begin());
}

AtlasSides atlasSides(const RayScene& rays, const LightReach& reach)
{
    std::vector<std::uint8_t> isReached(2 * std::size_t(rays.triangleCount()), 0);
    for (const ReachedFacet& facet : reach.facets()) isReached[facet.side] = 1;
    AtlasSides found;
    for (std::uint32_t t = 0; t < rays.triangleCount(); ++t) {
        if (rays.triangleNormal(t) == glm::vec3(0.0f)) continue;
        const std::uint32_t drawn = rays.material(t).doubleSided ? 2 : 1;
        for (std::uint32_t side = 2 * t; side < 2 * t + drawn; ++side) {
            if (isReached[side]) {
                found.lit.push_back(side);
            } else {
                ++found.unlit;
            }
        }
    }
    return found;
}

Result<std::shared_ptr<const Atlas>> makeAtlas(const RayScene& rays, const LightReach& reach,
                                               const AtlasOptions& options, Workers& workers,
                                               const std::stop_token& stop, const std::function<void(double)>& progress)
try {
    if (const Result<Done> fine = checkAtlasOptions(options); !fine) return fine.error();
    const AtlasSides sides = atlasSides(rays, reach);
    const Result<std::shared_ptr<Atlas>> made = options.useSceneUv
                                                    ? atlasFromSceneUv(rays, sides.lit, options.size, stop)
                                                    : fromCharts(rays, sides.lit, options, workers, stop, progress);
    if (!made) return made.error();
    (*made)->report.faces = (*made)->sides.size();
    (*made)->report.unlitFaces = sides.unlit;
    return std::shared_ptr<const Atlas>(*made);
} catch (const std::bad_alloc&) {
    return Error{Error::Kind::outOfMemory, "not enough memory for the atlas; ask for a smaller one"};
}

} // namespace lightloom
