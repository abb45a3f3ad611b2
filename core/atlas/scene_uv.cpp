// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/scene_uv.h"
#include "core/atlas/chart_pack.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

using Triangle2 = std::array<glm::dvec2, 3>;

constexpr float kOutside = 1e-4f; ///< of the square's side: rounding of whoever made the set
constexpr double kOverlap = 1e-5; ///< the same

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }
double twiceArea(const Triangle2& t) { return cross(t[1] - t[0], t[2] - t[0]); }

/// How far two triangles reach into each other along the edge normals of the first; least of the three.
double depthAlong(const Triangle2& a, const Triangle2& b)
{
    const double turn = twiceArea(a) > 0.0 ? 1.0 : -1.0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec2 edge = a[(k + 1) % 3] - a[k];
        const glm::dvec2 inwards = glm::dvec2(-edge.y, edge.x) * (turn / std::max(glm::length(edge), 1e-300));
        double deepest = -std::numeric_limits<double>::infinity();
        for (const glm::dvec2 p : b) deepest = std::max(deepest, glm::dot(inwards, p - a[k]));
        least = std::min(least, deepest);
    }
    return least;
}

bool doOverlap(const Triangle2& a, const Triangle2& b, double tolerance)
{
    return depthAlong(a, b) > tolerance && depthAlong(b, a) > tolerance;
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

std::optional<std::pair<std::size_t, std::size_t>> findOverlap(const std::vector<std::array<glm::dvec2, 3>>& triangles,
                                                               double tolerance, const std::stop_token& stop)
{
    const int cells = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(triangles.size()))), 1, 1024);
    std::vector<std::vector<std::uint32_t>> grid(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
    const auto cell = [&](glm::dvec2 p) {
        return glm::clamp(glm::ivec2(glm::clamp(p, 0.0, 1.0) * double(cells)), 0, cells - 1);
    };
    for (std::uint32_t i = 0; i < triangles.size() && !stop.stop_requested(); ++i) {
        const Triangle2& t = triangles[i];
        if (twiceArea(t) == 0.0) continue;
        const glm::ivec2 from = cell(glm::min(t[0], glm::min(t[1], t[2])));
        const glm::ivec2 to = cell(glm::max(t[0], glm::max(t[1], t[2])));
        for (int y = from.y; y <= to.y; ++y) {
            for (int x = from.x; x <= to.x; ++x) {
                auto& here = grid[static_cast<std::size_t>(y * cells + x)];
                for (const std::uint32_t other : here) {
                    if (doOverlap(t, triangles[other], tolerance)) return std::pair{std::size_t(other), std::size_t(i)};
                }
                here.push_back(i);
            }
        }
    }
    return {};
}

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
    if (const auto pair = findOverlap(flat, kOverlap, stop)) {
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
