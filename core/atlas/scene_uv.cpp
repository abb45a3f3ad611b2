// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/scene_uv.h"
#include "core/atlas/chart_pack.h"
#include "core/atlas/flat_overlap.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

using Triangle2 = std::array<glm::dvec2, 3>;

constexpr float kOutside = 1e-4f; ///< of the square's side: rounding of whoever made the set
constexpr double kOverlap = 1e-5; ///< the same

double twiceArea(const Triangle2& t)
{
    const glm::dvec2 u = t[1] - t[0], v = t[2] - t[0];
    return u.x * v.y - u.y * v.x;
}

std::string nameOf(const RayScene& rays, std::uint32_t side)
{
    const Instance& instance = rays.scene().instances[rays.triangle(side / 2).instance];
    return instance.node.empty() ? rays.scene().meshes[static_cast<std::size_t>(instance.mesh)].name : instance.node;
}

/// Texels within kPadding of a touched one belong to the set.
void ownAround(Atlas& atlas)
{
    atlas.owners.assign(atlas.texelCount(), -1);
    for (const SurfaceTexel& t : atlas.texels) {
        const int x = static_cast<int>(t.texel) % atlas.size, y = static_cast<int>(t.texel) / atlas.size;
        for (int v = std::max(0, y - kPadding); v <= std::min(atlas.size - 1, y + kPadding); ++v) {
            for (int u = std::max(0, x - kPadding); u <= std::min(atlas.size - 1, x + kPadding); ++u) {
                atlas.owners[static_cast<std::size_t>(v) * static_cast<std::size_t>(atlas.size) +
                             static_cast<std::size_t>(u)] = 0;
            }
        }
    }
}

/// The set as a flat surface, each face by itself, turned so that none counts as folded for being mirrored.
Stretch stretchOfFaces(const RayScene& rays, const std::vector<std::uint32_t>& sides,
                       const std::vector<Triangle2>& flat, double& texelsPerUnit)
{
    SurfaceMesh surface;
    std::vector<glm::dvec2> map;
    double wanted = 0.0, found = 0.0;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const SceneTriangle& t = rays.triangle(sides[i] / 2);
        const auto first = static_cast<std::uint32_t>(surface.positions.size());
        for (const glm::vec3 p : {t.a, t.b, t.c}) surface.positions.emplace_back(p);
        map.insert(map.end(), flat[i].begin(), flat[i].end());
        const bool isMirrored = twiceArea(flat[i]) < 0.0;
        surface.triangles.emplace_back(first, first + (isMirrored ? 2 : 1), first + (isMirrored ? 1 : 2));
        wanted += 2.0 * rays.triangleArea(sides[i] / 2);
        found += std::abs(twiceArea(flat[i]));
    }
    texelsPerUnit = wanted > 0.0 ? std::sqrt(found / wanted) : 0.0;
    if (!(texelsPerUnit > 0.0)) return {};
    for (glm::dvec2& p : map) p /= texelsPerUnit;
    return stretchOf(surface, map);
}

} // namespace

Result<std::shared_ptr<Atlas>> atlasFromSceneUv(const RayScene& rays, const std::vector<std::uint32_t>& sides, int size,
                                                const std::stop_token& stop)
{
    const auto bad = [](std::string text) { return Error{Error::Kind::badInput, std::move(text)}; };
    auto atlas = std::make_shared<Atlas>();
    atlas->size = size;
    std::vector<Triangle2> flat; // in the unit square
    for (const std::uint32_t side : sides) {
        if (!atlas->sides.empty() && atlas->sides.back() / 2 == side / 2) {
            ++atlas->report.sharedFaces;
            continue;
        }
        const SceneTriangle& t = rays.triangle(side / 2);
        const Instance& instance = rays.scene().instances[t.instance];
        const Mesh& mesh = rays.scene().meshes[static_cast<std::size_t>(instance.mesh)];
        if (mesh.uv[1].empty()) return bad(nameOf(rays, side) + " has no second UV set; leave it to new charts");
        Triangle2 corners;
        std::array<glm::vec2, 3> uv{};
        for (int k = 0; k < 3; ++k) {
            const glm::vec2 p = mesh.uv[1][mesh.triangles[t.indexInMesh][k]];
            const bool isInside =
                p.x >= -kOutside && p.y >= -kOutside && p.x <= 1.0f + kOutside && p.y <= 1.0f + kOutside; // NaN is not
            if (!isInside) {
                return bad(
                    fmt::format("the second UV set of {} leaves 0..1 at ({}, {})", nameOf(rays, side), p.x, p.y));
            }
            uv[static_cast<std::size_t>(k)] = glm::clamp(p, 0.0f, 1.0f);
            corners[static_cast<std::size_t>(k)] = glm::dvec2(uv[static_cast<std::size_t>(k)]);
        }
        atlas->sides.push_back(side), atlas->uv.push_back(uv), flat.push_back(corners);
    }
    if (const auto pair = findOverlap(flat, kOverlap, stop).pair) {
        return bad(fmt::format("the second UV set overlaps: {} lies on {}", nameOf(rays, atlas->sides[pair->second]),
                               nameOf(rays, atlas->sides[pair->first])));
    }
    if (stop.stop_requested()) return Error{Error::Kind::cancelled, "unwrapping was cancelled"};

    std::vector<FlatFace> faces;
    for (Triangle2& t : flat) {
        for (glm::dvec2& p : t) p *= double(size);
        faces.push_back({atlas->sides[faces.size()], t});
    }
    AtlasReport& report = atlas->report;
    report.stretch = stretchOfFaces(rays, atlas->sides, flat, report.texelsPerMetre);
    TouchedTexels found = touchedTexels(rays, faces, glm::ivec2(0), glm::ivec2(size), size);
    atlas->texels = std::move(found.texels);
    report.charts = atlas->sides.empty() ? 0 : 1;
    report.overlappingTexels = found.overlapping;
    report.utilisation = static_cast<double>(found.covered) / static_cast<double>(atlas->texelCount());
    ownAround(*atlas);
    return atlas;
}

} // namespace lightloom
