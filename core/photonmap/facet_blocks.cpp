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

FacetsSeen::FacetsSeen(const FacetBlock& block, Screens screens, glm::vec3 centre, glm::vec3 normal, float leastCosine,
                       float small)
{
    find(*this, block, screens, centre, normal, leastCosine, small);
}

LIGHTLOOM_WIDE_VECTORS void FacetsSeen::find(FacetsSeen& seen, const FacetBlock& block, Screens screens,
                                             glm::vec3 centre, glm::vec3 normal, float leastCosine, float small)
{
    const auto of = [](const float* values) -> const auto& { return lanesOf<Floats8>(values, 0); };
    const Floats8 x = of(block.x) - centre.x, y = of(block.y) - centre.y, z = of(block.z) - centre.z;
    const Floats8 cosine = of(block.nx) * normal.x + of(block.ny) * normal.y + of(block.nz) * normal.z;
    const Ints8 counts = (cosine > leastCosine) & (of(block.area) > 0.0f);
    const Floats8 reach = of(block.reach);
    Floats8 share = Floats8{} + 1.0f;
    Ints8 whole{}, part{};
    for (const Screen& screen : screens) {
        const glm::vec3 away = screen.away, low = screen.sides[0], high = screen.sides[1];
        // how far the centroid lies within: to the nearest of the three planes
        const Floats8 far = x * away.x + y * away.y + z * away.z - screen.behind;
        const Floats8 left = x * low.x + y * low.y + z * low.z, right = x * high.x + y * high.y + z * high.z;
        const Floats8 beside = left < right ? left : right, within = far < beside ? far : beside;
        whole |= within >= reach;
        part |= within > -reach;
        const Floats8 some = 0.5f - 0.5f * within / reach, less = some < 1.0f ? some : Floats8{} + 1.0f;
        share *= less > 0.0f ? less : Floats8{};
    }
    const Ints8 cut = counts & part & ~whole & (reach >= small), touched = counts & part;
    share = cut != 0 ? Floats8{} : share;
    lanesOf<Floats8>(seen.share, 0) = touched != 0 ? share : Floats8{} + 1.0f;
    for (std::size_t i = 0; i < kLanes; ++i) {
        seen.cut |= static_cast<unsigned>(cut[i] & 1) << i;
        seen.touched |= static_cast<unsigned>(touched[i] & 1) << i;
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
    std::fill_n(sums_.begin(), radii.size() * kMoments * kLanes, 0.0f);
}

LIGHTLOOM_WIDE_VECTORS std::size_t BlockSums::add(const Place& place, const FacetBlock& block, const float* radii,
                                                  std::size_t count, float* sums, std::uint32_t first,
                                                  std::uint32_t* large)
{
    static_assert(FacetBlock::kCount == kLanes);
    const auto of = [](const float* values) -> const auto& { return lanesOf<Floats8>(values, 0); };
    const Floats8 dx = of(block.x) - place.centre[0], dy = of(block.y) - place.centre[1],
                  dz = of(block.z) - place.centre[2];
    const Floats8 squared = dx * dx + dy * dy + dz * dz, near = place.largest + of(block.reach);
    const Floats8 cosine =
        of(block.nx) * place.normal[0] + of(block.ny) * place.normal[1] + of(block.nz) * place.normal[2];
    const Ints8 counts = (cosine > place.leastCosine) & (squared <= near * near) & (of(block.area) > 0.0f);
    const Ints8 isPatch = counts & (of(block.reach) < place.small), isLarge = counts & ~isPatch;

    std::uint32_t* next = large;
    std::int32_t patches = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
        *next = first + static_cast<std::uint32_t>(i);
        next -= isLarge[i];
        patches |= isPatch[i];
    }
    if (patches == 0) return static_cast<std::size_t>(next - large);

    const Floats8 along = dx * place.normal[0] + dy * place.normal[1] + dz * place.normal[2];
    const Floats8 stretched = squared + place.stretch * along * along, spread = of(block.spread);
    Floats8 d, width;
    for (std::size_t i = 0; i < kLanes; ++i) d[i] = std::sqrt(stretched[i]), width[i] = 1e-30f + std::sqrt(spread[i]);
    // points beside the centroid lie further off on average: the border is round
    const Floats8 distance = d + 0.5f * spread / (d > width ? d : width);
    const Floats8 x = dx * place.tangent[0] + dy * place.tangent[1] + dz * place.tangent[2];
    const Floats8 y = dx * place.bitangent[0] + dy * place.bitangent[1] + dz * place.bitangent[2];
    const Floats8 area = isPatch != 0 ? of(block.area) : Floats8{};
    const Floats8 xx = x * x + spread, xy = x * y, yy = y * y + spread;
    for (std::size_t j = 0; j < count; ++j) {
        const Floats8 share = (radii[j] - distance) * of(block.slope) + 0.5f;
        const Floats8 some = share > 0.0f ? share : Floats8{};
        const Floats8 a = area * (some < 1.0f ? some : Floats8{} + 1.0f);
        const auto add = [&](std::size_t moment, const Floats8& value) {
            lanesOf<Floats8>(sums, j * kMoments + moment) += value;
        };
        add(0, a), add(1, a * x), add(2, a * y), add(3, a * xx), add(4, a * xy), add(5, a * yy);
    }
    return static_cast<std::size_t>(next - large);
}

AreaMoments BlockSums::sum(std::size_t j) const
{
    std::array<double, kMoments> m;
    for (std::size_t k = 0; k < kMoments; ++k) {
        const float* s = sums_.data() + (j * kMoments + k) * kLanes;
        const auto pair = [s](std::size_t i) { return static_cast<double>(s[i]) + static_cast<double>(s[i + 4]); };
        m[k] = (pair(0) + pair(2)) + (pair(1) + pair(3));
    }
    return {m[0], {m[1], m[2]}, m[3], m[4], m[5]};
}

} // namespace lightloom
