// SPDX-License-Identifier: Apache-2.0
#include "core/transport/first_light.h"
#include "core/base/low_discrepancy.h"
#include "core/base/sampling.h"
#include "core/trace/material.h"
#include <algorithm>
#include <array>
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

/// Light that arrives unless something is in its way: asked for eight at a time.
class ShadowRays {
public:
    explicit ShadowRays(const RayScene& rays) : rays_(rays) {}
    /// Adds `lux` to `sum`, now or with a later one, if nothing lies between.
    void add(glm::vec3 from, glm::vec3 to, glm::vec3 lux, glm::vec3& sum)
    {
        sights_.set(count_, from, to);
        lux_[count_] = lux;
        sums_[count_] = &sum;
        if (++count_ == Sights8::kCount) trace();
    }
    /// Adds all that is still waiting.
    void trace()
    {
        for (std::size_t i = count_; i < Sights8::kCount; ++i) sights_.set(i, glm::vec3(0.0f), glm::vec3(0.0f));
        const std::uint32_t blocked = count_ > 0 ? rays_.areBlocked(sights_, count_) : 0;
        for (std::size_t i = 0; i < count_; ++i)
            if (!(blocked >> i & 1u)) *sums_[i] += lux_[i];
        count_ = 0;
    }

private:
    const RayScene& rays_;
    Sights8 sights_;
    glm::vec3 lux_[Sights8::kCount];
    glm::vec3* sums_[Sights8::kCount];
    std::size_t count_ = 0;
};

/// Light of one group at points of entries. Lamps of wide surface near a point are found half by sampling their
/// surface, half by a ray along the cosine (balance heuristic): sampled by surface alone, walls that shine beside the
/// point would bring a few huge samples.
class GroupLight {
public:
    GroupLight(const LightSampler& lights, int group) : lights_(lights), rays_(*lights.rays()), group_(group)
    {
        for (const int e : lights.inGroup(group)) hasSurface_ |= emitter(e).kind == Emitter::Kind::surface;
    }

    /// Adds the illuminance of all points, lux: to `fromLamps` what shadow rays let through, as `shadows` get to them,
    /// to `byRays` the rest.
    void over(std::span<const PointOnEntry> points, Rng& rng, ShadowRays& shadows, glm::vec3& fromLamps,
              glm::vec3& byRays) const
    {
        const int count = static_cast<int>(points.size());
        for (const int number : lights_.inGroup(group_)) {
            const ShiftedPoints spots(count, rng); // of the lamp: one for each point
            const bool isSurface = emitter(number).kind == Emitter::Kind::surface;
            for (int i = 0; i < count; ++i)
                fromLamp(number, points[static_cast<std::size_t>(i)], isSurface ? spots[i] : glm::vec2(0.5f), shadows,
                         fromLamps);
        }
        if (!hasSurface_) return;
        const ShiftedPoints ways(count, rng);
        for (int i = 0; i < count; ++i) byRays += byRay(points[static_cast<std::size_t>(i)], ways[i]);
    }

private:
    [[nodiscard]] const Emitter& emitter(int number) const
    {
        return lights_.emitters()[static_cast<std::size_t>(number)];
    }
    [[nodiscard]] static bool isWide(const Emitter& emitter, glm::vec3 p)
    {
        constexpr float kWide = 0.1f; // mean squared distance of its surface from its middle, over that of the point
        const glm::vec3 way = emitter.centre - p;
        return emitter.kind == Emitter::Kind::surface && emitter.spreadSquared > kWide * glm::dot(way, way);
    }
    void fromLamp(int number, const PointOnEntry& p, glm::vec2 spot, ShadowRays& shadows, glm::vec3& sum) const
    {
        LightSample s;
        if (!lights_.sample(number, p.position, spot, s)) return;
        const float cosine = glm::dot(p.normal, s.toLight);
        if (!(cosine > 0.0f)) return;
        glm::vec3 lux = s.illuminance * cosine;
        if (!s.isPunctual()) {
            const float byCosine = isWide(emitter(number), p.position) ? cosine / kPi : 0.0f;
            lux = s.radiance * (cosine / (s.pdf + byCosine));
        }
        shadows.add(rays_.leave(p.position, p.normal), s.end, lux, sum);
    }
    [[nodiscard]] glm::vec3 byRay(const PointOnEntry& p, glm::vec2 u) const
    {
        const auto isNear = [&](int e) { return isWide(emitter(e), p.position); };
        if (std::ranges::none_of(lights_.inGroup(group_), isNear)) return glm::vec3(0.0f);
        const glm::vec3 away = Frame(p.normal).toWorld(sampleCosineHemisphere(u.x, u.y));
        const float cosine = glm::dot(away, p.normal);
        Hit hit;
        if (!(cosine > 0.0f) || !rays_.intersect(rays_.leave(p.position, p.normal), away, kFar, hit))
            return glm::vec3(0.0f);
        const int e = lights_.emitterOf(hit.triangle);
        if (e < 0 || emitter(e).group != group_ || !isNear(e)) return glm::vec3(0.0f);
        return surfaceAt(rays_, hit).emission * (cosine / (cosine / kPi + lights_.pdf(p.position, hit)));
    }

    static constexpr float kFar = std::numeric_limits<float>::infinity();
    const LightSampler& lights_;
    const RayScene& rays_;
    int group_;
    bool hasSurface_ = false;
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
    const auto each = static_cast<std::size_t>(samples);
    // eight rays that go together are of one group and one block: no other has a say in what comes of them
    const auto light = [&](std::size_t first, std::size_t end, std::size_t g, std::span<const PointOnEntry> points) {
        const GroupLight group(lights, groups[g]);
        ShadowRays shadows(*lights.rays());
        std::array<glm::vec3, kBlock> fromLamps{}, byRays{};
        for (std::size_t e = first; e < end; ++e) {
            Rng rng(seed, stream + static_cast<std::uint64_t>(groups[g]), e);
            group.over(points.subspan((e - first) * each, each), rng, shadows, fromLamps[e - first], byRays[e - first]);
        }
        shadows.trace();
        for (std::size_t e = first; e < end; ++e) {
            const glm::vec3 mean = (fromLamps[e - first] + byRays[e - first]) / static_cast<float>(samples);
            for (int c = 0; c < 3; ++c) lux.values[(e * count + g) * 3 + static_cast<std::size_t>(c)] = mean[c];
        }
    };
    const std::size_t blocks = (entries + kBlock - 1) / kBlock;
    std::atomic<std::size_t> done = 0;
    const bool all = workers.run(blocks, stop, [&](std::size_t block) {
        const std::size_t first = block * kBlock, end = std::min(entries, first + kBlock);
        std::vector<PointOnEntry> own(kept ? 0 : (end - first) * each);
        for (std::size_t e = first; e < end && !kept; ++e)
            spreadPoints(e, seed, reach, voxels, std::span(own).subspan((e - first) * each, each));
        const std::span<const PointOnEntry> points =
            kept ? std::span(kept->points).subspan(first * each, (end - first) * each) : own;
        for (std::size_t g = 0; g < count; ++g) light(first, end, g, points);
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
