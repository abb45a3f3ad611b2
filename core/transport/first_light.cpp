// SPDX-License-Identifier: Apache-2.0
#include "core/transport/first_light.h"
#include "core/base/low_discrepancy.h"
#include "core/base/sampling.h"
#include "core/trace/material.h"
#include <algorithm>
#include <atomic>
#include <cassert>
#include <limits>

namespace lightloom {
namespace {

/// The surface of a facet near `p`, as a ray that comes to its side meets it.
Surface surfaceOf(const RayScene& rays, const ReachedFacet& facet, glm::vec3 p)
{
    Hit hit;
    hit.triangle = facet.side / 2;
    const SceneTriangle& t = rays.triangle(hit.triangle);
    hit.instance = t.instance;
    hit.position = p;
    hit.normal = t.normal;
    hit.isFront = facet.side % 2 == 0;
    const glm::dvec3 b(t.b - t.a), c(t.c - t.a), at(p - t.a), n = glm::cross(b, c);
    const double squared = glm::dot(n, n);
    if (squared > 0.0)
        hit.barycentric = {glm::dot(glm::cross(at, c), n) / squared, glm::dot(glm::cross(b, at), n) / squared};
    return surfaceAt(rays, hit);
}

/// Means over the surface of each entry, by area.
template<class Of>
std::vector<glm::vec3> overPieces(const RayScene& rays, const LightReach& reach, const SurfaceVoxels& voxels, Of of)
{
    std::vector<glm::vec3> means(voxels.entries.size());
    for (std::size_t e = 0; e < means.size(); ++e) {
        glm::vec3 sum(0.0f);
        float area = 0.0f;
        for (std::uint32_t i = voxels.firstPiece[e]; i < voxels.firstPiece[e + 1]; ++i) {
            const CellPiece& piece = voxels.pieces[i];
            sum += piece.area * of(surfaceOf(rays, reach.facets()[piece.facet], piece.centroid));
            area += piece.area;
        }
        means[e] = sum / area;
    }
    return means;
}

constexpr std::size_t kBlock = 256; ///< entries of a job

/// Points of entry `e`, as many as `points` has room for.
void spreadPoints(std::size_t e, std::uint64_t seed, const LightReach& reach, const SurfaceVoxels& voxels,
                  std::span<PointOnEntry> points)
{
    const int samples = static_cast<int>(points.size());
    Rng rng(seed, hashName("first light"), e);
    const ShiftedPoints spread(samples, rng);
    for (int i = 0; i < samples; ++i) {
        std::uint32_t facet = 0;
        const glm::vec3 p = voxels.pointOn(e, {rng.uniform(), spread[i].x, spread[i].y}, reach, facet);
        points[static_cast<std::size_t>(i)] = {p, reach.facets()[facet].normal};
    }
}

/// Light of one group at points of one entry. Lamps of wide surface near a point are found half by sampling their
/// surface, half by a ray along the cosine (balance heuristic): sampled by surface alone, walls that shine beside the
/// point would bring a few huge samples.
class GroupLight {
public:
    GroupLight(const LightSampler& lights, int group) : lights_(lights), rays_(*lights.rays()), group_(group) {}

    /// Mean illuminance over the points, lux.
    [[nodiscard]] glm::vec3 over(std::span<const PointOnEntry> points, Rng& rng) const
    {
        glm::vec3 sum(0.0f);
        const int count = static_cast<int>(points.size());
        for (const int emitter : lights_.inGroup(group_)) {
            const ShiftedPoints spots(count, rng); // of the lamp: one for each point
            for (int i = 0; i < count; ++i) sum += fromLamp(emitter, points[static_cast<std::size_t>(i)], spots[i]);
        }
        const ShiftedPoints ways(count, rng);
        for (int i = 0; i < count; ++i) sum += byRay(points[static_cast<std::size_t>(i)], ways[i]);
        return sum / static_cast<float>(count);
    }

private:
    [[nodiscard]] bool isWide(const Emitter& emitter, glm::vec3 p) const
    {
        constexpr float kWide = 0.1f; // mean squared distance of its surface from its middle, over that of the point
        const glm::vec3 way = emitter.centre - p;
        return emitter.kind == Emitter::Kind::surface && emitter.spreadSquared > kWide * glm::dot(way, way);
    }
    [[nodiscard]] glm::vec3 fromLamp(int number, const PointOnEntry& p, glm::vec2 spot) const
    {
        LightSample s;
        if (!lights_.sample(number, p.position, spot, s)) return glm::vec3(0.0f);
        const float cosine = glm::dot(p.normal, s.toLight);
        if (!(cosine > 0.0f) || rays_.isBlocked(rays_.leave(p.position, p.normal), s.end)) return glm::vec3(0.0f);
        if (s.isPunctual()) return s.illuminance * cosine;
        const Emitter& emitter = lights_.emitters()[static_cast<std::size_t>(number)];
        const float byCosine = isWide(emitter, p.position) ? cosine / kPi : 0.0f;
        return s.radiance * (cosine / (s.pdf + byCosine));
    }
    [[nodiscard]] glm::vec3 byRay(const PointOnEntry& p, glm::vec2 u) const
    {
        const auto isNear = [&](int e) { return isWide(lights_.emitters()[static_cast<std::size_t>(e)], p.position); };
        if (std::ranges::none_of(lights_.inGroup(group_), isNear)) return glm::vec3(0.0f);
        const glm::vec3 away = Frame(p.normal).toWorld(sampleCosineHemisphere(u.x, u.y));
        const float cosine = glm::dot(away, p.normal);
        Hit hit;
        if (!(cosine > 0.0f) || !rays_.intersect(rays_.leave(p.position, p.normal), away, kFar, hit))
            return glm::vec3(0.0f);
        const int e = lights_.emitterOf(hit.triangle);
        if (e < 0 || lights_.emitters()[static_cast<std::size_t>(e)].group != group_ || !isNear(e))
            return glm::vec3(0.0f);
        return surfaceAt(rays_, hit).emission * (cosine / (cosine / kPi + lights_.pdf(p.position, hit)));
    }

    static constexpr float kFar = std::numeric_limits<float>::infinity();
    const LightSampler& lights_;
    const RayScene& rays_;
    int group_;
};

} // namespace

std::vector<glm::vec3> entryAlbedos(const RayScene& rays, const LightReach& reach, const SurfaceVoxels& voxels)
{
    return overPieces(rays, reach, voxels, evenAlbedo);
}

std::vector<glm::vec3> entryMattAlbedos(const RayScene& rays, const LightReach& reach, const SurfaceVoxels& voxels)
{
    bool isSpecular = false;
    std::vector<glm::vec3> albedos = overPieces(rays, reach, voxels, [&](const Surface& surface) {
        isSpecular |= surface.isMirror() || surface.glass.share > 0.0f;
        return mattAlbedo(surface);
    });
    return isSpecular ? albedos : std::vector<glm::vec3>{};
}

std::shared_ptr<const EntryPoints> entryPoints(const LightReach& reach, const SurfaceVoxels& voxels, int samples,
                                               std::uint64_t seed, Workers& workers, const std::stop_token& stop)
{
    const std::size_t entries = voxels.entries.size(), each = static_cast<std::size_t>(samples);
    auto made = std::make_shared<EntryPoints>();
    made->samples = samples;
    made->points.resize(entries * each);
    const bool all = workers.run((entries + kBlock - 1) / kBlock, stop, [&](std::size_t block) {
        for (std::size_t e = block * kBlock; e < std::min(entries, (block + 1) * kBlock); ++e)
            spreadPoints(e, seed, reach, voxels, std::span(made->points).subspan(e * each, each));
    });
    return all ? made : nullptr;
}

EntryValues firstLight(const LightSampler& lights, const LightReach& reach, const SurfaceVoxels& voxels,
                       std::span<const int> groups, int samples, std::uint64_t seed, Workers& workers,
                       const std::stop_token& stop, const std::function<void(double)>& progress,
                       const EntryPoints* kept)
{
    assert(!kept || (kept->samples == samples &&
                     kept->points.size() == voxels.entries.size() * static_cast<std::size_t>(samples)));
    const std::size_t count = groups.size(), entries = voxels.entries.size();
    EntryValues lux{static_cast<int>(3 * count), std::vector<float>(3 * count * entries, 0.0f)};
    const std::uint64_t stream = hashName("first light of a group");
    const auto light = [&](std::size_t e, std::size_t g, std::span<const PointOnEntry> points) {
        Rng rng(seed, stream + static_cast<std::uint64_t>(groups[g]), e);
        const glm::vec3 found = GroupLight(lights, groups[g]).over(points, rng);
        for (int c = 0; c < 3; ++c) lux.values[(e * count + g) * 3 + static_cast<std::size_t>(c)] = found[c];
    };
    const std::size_t blocks = (entries + kBlock - 1) / kBlock;
    std::atomic<std::size_t> done = 0;
    const bool all = workers.run(blocks, stop, [&](std::size_t block) {
        const auto each = static_cast<std::size_t>(samples);
        std::vector<PointOnEntry> own(kept ? 0 : each);
        for (std::size_t e = block * kBlock; e < std::min(entries, (block + 1) * kBlock); ++e) {
            if (!kept) spreadPoints(e, seed, reach, voxels, own);
            const auto points =
                kept ? std::span(kept->points).subspan(e * each, each) : std::span<const PointOnEntry>(own);
            for (std::size_t g = 0; g < count; ++g) light(e, g, points);
        }
        if (progress) progress(static_cast<double>(++done) / static_cast<double>(blocks));
    });
    return all ? lux : EntryValues{};
}

EntryValues reflected(EntryValues lux, std::span<const glm::vec3> albedo)
{
    const auto channels = static_cast<std::size_t>(lux.channels);
    for (std::size_t i = 0; i < lux.values.size(); ++i)
        lux.values[i] *= albedo[i / channels][static_cast<int>(i % channels % 3)];
    return lux;
}

} // namespace lightloom
