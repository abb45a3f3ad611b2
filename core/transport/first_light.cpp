// SPDX-License-Identifier: Apache-2.0
#include "core/transport/first_light.h"
#include "core/base/low_discrepancy.h"
#include "core/trace/direct_light.h"

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

} // namespace

std::vector<glm::vec3> entryAlbedos(const RayScene& rays, const LightReach& reach, const SurfaceVoxels& voxels)
{
    std::vector<glm::vec3> albedos(voxels.entries.size());
    for (std::size_t e = 0; e < albedos.size(); ++e) {
        glm::vec3 sum(0.0f);
        float area = 0.0f;
        for (std::uint32_t i = voxels.firstPiece[e]; i < voxels.firstPiece[e + 1]; ++i) {
            const CellPiece& piece = voxels.pieces[i];
            const Surface surface = surfaceOf(rays, reach.facets()[piece.facet], piece.centroid);
            sum += piece.area * glm::min(surface.diffuse + surface.specular, glm::vec3(kLargestAlbedo));
            area += piece.area;
        }
        albedos[e] = sum / area;
    }
    return albedos;
}

EntryValues firstLight(const LightSampler& lights, const LightReach& reach, const SurfaceVoxels& voxels, int samples,
                       std::uint64_t seed, Workers& workers, const std::stop_token& stop)
{
    const RayScene& rays = *lights.rays();
    const std::size_t groups = rays.scene().groups.size(), entries = voxels.entries.size();
    EntryValues lux{static_cast<int>(3 * groups), std::vector<float>(3 * groups * entries, 0.0f)};
    std::vector<Mix> alone(groups, Mix(groups, glm::vec3(0.0f)));
    for (std::size_t g = 0; g < groups; ++g) alone[g][g] = glm::vec3(1.0f);
    constexpr std::size_t kBlock = 256;
    const bool all = workers.run((entries + kBlock - 1) / kBlock, stop, [&](std::size_t block) {
        for (std::size_t e = block * kBlock; e < std::min(entries, (block + 1) * kBlock); ++e) {
            Rng rng(seed, hashName("first light"), e);
            const ShiftedPoints points(samples, rng);
            for (int i = 0; i < samples; ++i) {
                std::uint32_t facet = 0;
                const glm::vec3 p = voxels.pointOn(e, {rng.uniform(), points[i].x, points[i].y}, reach, facet);
                for (std::size_t g = 0; g < groups; ++g) {
                    const glm::vec3 found =
                        directIlluminance(rays, lights, alone[g], p, reach.facets()[facet].normal, 1, rng);
                    for (int c = 0; c < 3; ++c)
                        lux.values[(e * groups + g) * 3 + static_cast<std::size_t>(c)] +=
                            found[c] / static_cast<float>(samples);
                }
            }
        }
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
