// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/facet_blocks.h"
#include "core/base/wide_vectors.h"
#include <algorithm>
#include <cmath>

namespace lightloom {

FacetBlock::FacetBlock(std::span<const ReachedFacet> facets)
{
    for (std::size_t i = 0; i < facets.size(); ++i) {
        const ReachedFacet& f = facets[i];
        const glm::dvec3 ab = glm::dvec3(f.b) - glm::dvec3(f.a), ac = glm::dvec3(f.c) - glm::dvec3(f.a), bc = ac - ab;
        const glm::vec3 centroid((glm::dvec3(f.a) + glm::dvec3(f.b) + glm::dvec3(f.c)) / 3.0);
        x[i] = centroid.x, y[i] = centroid.y, z[i] = centroid.z;
        nx[i] = f.normal.x, ny[i] = f.normal.y, nz[i] = f.normal.z;
        area[i] = static_cast<float>(0.5 * glm::length(glm::cross(ab, ac)));
        const double variance = (glm::dot(ab, ab) + glm::dot(ac, ac) + glm::dot(bc, bc)) / 72.0;
        spread[i] = static_cast<float>(variance);
        // a square of that variance is sqrt(12 variance) wide
        for (const glm::vec3 corner : {f.a, f.b, f.c}) reach[i] = glm::max(reach[i], glm::distance(centroid, corner));
        slope[i] = variance > 0.0 ? static_cast<float>(1.0 / std::sqrt(12.0 * variance)) : 0.0f;
    }
}

BlockSums::BlockSums(glm::vec3 centre, glm::vec3 normal, glm::vec3 tangent, glm::vec3 bitangent, float stretch,
                     float leastCosine, float small, std::span<const float> radii)
    : place_{{centre.x, centre.y, centre.z},
             {normal.x, normal.y, normal.z},
             {tangent.x, tangent.y, tangent.z},
             {bitangent.x, bitangent.y, bitangent.z},
             stretch * stretch - 1.0f,
             leastCosine,
             small,
             radii.back()},
      radii_(radii)
{
}

unsigned BlockSums::add(const FacetBlock& block)
{
    Patches patches;
    int isPatch[FacetBlock::kCount], isLarge[FacetBlock::kCount];
    measure(block, place_, patches, isPatch, isLarge);
    unsigned large = 0;
    int patch = 0;
    for (std::size_t i = 0; i < FacetBlock::kCount; ++i) {
        large |= static_cast<unsigned>(isLarge[i]) << i;
        patch |= isPatch[i];
    }
    if (patch != 0) {
        if (!isUsed_) std::fill_n(sums_.begin(), radii_.size() * kMoments * FacetBlock::kCount, 0.0f);
        isUsed_ = true;
        addTo(sums_.data(), block, patches, radii_.data(), radii_.size());
    }
    return large;
}

LIGHTLOOM_WIDE_VECTORS void BlockSums::measure(const FacetBlock& block, const Place& place, Patches& patches,
                                               int* __restrict isPatch, int* __restrict isLarge)
{
    for (std::size_t i = 0; i < FacetBlock::kCount; ++i) {
        const float dx = block.x[i] - place.centre[0], dy = block.y[i] - place.centre[1],
                    dz = block.z[i] - place.centre[2];
        const float along = dx * place.normal[0] + dy * place.normal[1] + dz * place.normal[2];
        const float squared = dx * dx + dy * dy + dz * dz, d = std::sqrt(squared + place.stretch * along * along);
        // points beside the centroid lie further off on average: the border is round
        patches.distance[i] = d + 0.5f * block.spread[i] / std::max(d, 1e-30f + std::sqrt(block.spread[i]));
        patches.x[i] = dx * place.tangent[0] + dy * place.tangent[1] + dz * place.tangent[2];
        patches.y[i] = dx * place.bitangent[0] + dy * place.bitangent[1] + dz * place.bitangent[2];
        const float cosine =
            block.nx[i] * place.normal[0] + block.ny[i] * place.normal[1] + block.nz[i] * place.normal[2];
        const float near = place.largest + block.reach[i];
        const int counts = (cosine > place.leastCosine) & (squared <= near * near) & (block.area[i] > 0.0f);
        const int small = block.reach[i] < place.small;
        isPatch[i] = counts & small;
        isLarge[i] = counts & (1 - small);
        patches.area[i] = isPatch[i] != 0 ? block.area[i] : 0.0f;
    }
}

LIGHTLOOM_WIDE_VECTORS void BlockSums::addTo(float* __restrict sums, const FacetBlock& block, const Patches& patches,
                                             const float* __restrict radii, std::size_t count)
{
    constexpr std::size_t n = FacetBlock::kCount;
    for (std::size_t j = 0; j < count; ++j) {
        float* sum = sums + j * kMoments * n;
        for (std::size_t i = 0; i < n; ++i) {
            const float x = patches.x[i], y = patches.y[i];
            const float share = (radii[j] - patches.distance[i]) * block.slope[i] + 0.5f;
            const float a = patches.area[i] * std::min(std::max(share, 0.0f), 1.0f);
            sum[i] += a;
            sum[n + i] += a * x;
            sum[2 * n + i] += a * y;
            sum[3 * n + i] += a * (x * x + block.spread[i]);
            sum[4 * n + i] += a * (x * y);
            sum[5 * n + i] += a * (y * y + block.spread[i]);
        }
    }
}

AreaMoments BlockSums::sum(std::size_t j) const
{
    if (!isUsed_) return {};
    std::array<double, kMoments> m{};
    const float* sum = sums_.data() + j * kMoments * FacetBlock::kCount;
    for (std::size_t k = 0; k < kMoments; ++k) {
        for (std::size_t i = 0; i < FacetBlock::kCount; ++i)
            m[k] += static_cast<double>(sum[k * FacetBlock::kCount + i]);
    }
    return {m[0], {m[1], m[2]}, m[3], m[4], m[5]};
}

} // namespace lightloom
