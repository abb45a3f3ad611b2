// SPDX-License-Identifier: Apache-2.0
#include "core/octree/vdl_cluster.h"
#include "core/base/sampling.h"
#include "core/base/units.h"
#include "core/base/wide_vectors.h"
#include <algorithm>
#include <array>
#include <cmath>

namespace lightloom {
namespace {

constexpr float kMostScale = 1e3f; ///< beyond it the sum that is scaled is rounding

/// Four sums at once: red, green, blue and weight.
using Sums = double __attribute__((vector_size(32)));

/// Of the lights of one cluster: sum of (colour, weight) times toLight's x, y, z, and times 1.
struct VectorSum {
    Sums x, y, z, one;
    const LightVector* strongest;

    [[nodiscard]] glm::dvec3 vectorOf(int channel) const { return {x[channel], y[channel], z[channel]}; }
    [[nodiscard]] glm::dvec3 colour() const { return {one[0], one[1], one[2]}; }
    [[nodiscard]] glm::dvec3 direction() const { return vectorOf(3); } ///< weighted
};

LIGHTLOOM_WIDE_VECTORS void addUp(std::span<const LightVector> lights, const std::int32_t* cluster, VectorSum* sums)
{
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const LightVector& light = lights[i];
        VectorSum& sum = sums[cluster[i]];
        const Sums what{static_cast<double>(light.colour.x), static_cast<double>(light.colour.y),
                        static_cast<double>(light.colour.z), static_cast<double>(light.weight)};
        sum.x += what * static_cast<double>(light.toLight.x);
        sum.y += what * static_cast<double>(light.toLight.y);
        sum.z += what * static_cast<double>(light.toLight.z);
        sum.one += what;
        if (!sum.strongest || light.weight > sum.strongest->weight) sum.strongest = &light;
    }
}

Vdl corrected(const VectorSum& sum, glm::vec3 n)
{
    const glm::dvec3 luma(kLumaR, kLumaG, kLumaB);
    const glm::dvec3 weighted = luma.x * sum.vectorOf(0) + luma.y * sum.vectorOf(1) + luma.z * sum.vectorOf(2);
    const double length = glm::length(weighted), all = glm::dot(luma, sum.colour());
    Vdl vdl;
    // opposite directions that cancel leave no direction of their own: take the strongest light's
    vdl.toLight = length > 1e-3 * all ? glm::vec3(weighted / length) : sum.strongest->toLight;
    const double cosine = std::max(static_cast<double>(glm::dot(vdl.toLight, n)), static_cast<double>(kLeastCosine));
    for (int c = 0; c < 3; ++c) {
        vdl.colour[c] = static_cast<float>(std::max(0.0, glm::dot(sum.vectorOf(c), glm::dvec3(n))) / cosine);
    }
    return vdl;
}

Vdl asPrinted(const VectorSum& sum)
{
    const double length = glm::length(sum.direction());
    return {glm::vec3(sum.colour()), length > 0.0 ? glm::vec3(sum.direction() / length) : sum.strongest->toLight};
}

} // namespace

void fitVdls(std::span<const LightVector> lights, glm::vec3 n, VdlForm form, std::span<Vdl> out,
             ClusterScratch& scratch)
{
    std::ranges::fill(out, Vdl{glm::vec3(0.0f), n});
    const int clusters = clusterDirections(lights, static_cast<int>(out.size()), scratch);
    std::array<VectorSum, kMostClusters> sums;
    std::fill_n(sums.begin(), clusters, VectorSum{}); // most places are not used
    addUp(lights, scratch.cluster.data(), sums.data());
    std::size_t used = 0;
    for (int j = 0; j < clusters; ++j) {
        const VectorSum& sum = sums[static_cast<std::size_t>(j)];
        if (!sum.strongest || sum.colour() == glm::dvec3(0.0)) continue;
        out[used++] = form == VdlForm::corrected ? corrected(sum, n) : asPrinted(sum);
    }
}

namespace {

constexpr std::size_t kNormals = 65;
constexpr float kBetween = 0.6f; ///< of the tolerance: normals between those looked at may be further off
using OnNormals = std::array<glm::vec3, kNormals>;

/// The entry's own, and rings of sixteen at four angles off it, the last just within what an entry answers for.
OnNormals normalsAround(glm::vec3 n)
{
    const Frame frame(n);
    OnNormals normals{n};
    std::size_t next = 1;
    for (const float cosine : {0.95f, 0.8f, 0.55f, kCompatibleCosine + 0.01f}) {
        const float sine = std::sqrt(1.0f - cosine * cosine);
        for (int i = 0; i < 16; ++i) {
            const float phi = 0.125f * kPi * static_cast<float>(i);
            const glm::vec3 aside = std::cos(phi) * frame.tangent + std::sin(phi) * frame.bitangent;
            normals[next++] = cosine * n + sine * aside;
        }
    }
    return normals;
}

OnNormals illuminances(std::span<const Vdl> vdls, const OnNormals& normals)
{
    OnNormals lux{};
    for (const Vdl& vdl : vdls) {
        for (std::size_t i = 0; i < kNormals; ++i)
            lux[i] += vdl.colour * glm::max(0.0f, glm::dot(vdl.toLight, normals[i]));
    }
    return lux;
}

} // namespace

std::size_t spendVdls(std::span<Vdl> vdls, glm::vec3 n, VdlForm form, float tolerance, ClusterScratch& scratch)
{
    std::vector<LightVector> lights;
    for (const Vdl& vdl : vdls) {
        if (const float luma = luminance(vdl.colour); luma > 0.0f) lights.push_back({vdl.toLight, vdl.colour, luma});
    }
    const OnNormals normals = normalsAround(n), whole = illuminances(vdls, normals);
    float brightest = 0.0f;
    for (const glm::vec3& lux : whole) brightest = glm::max(brightest, luminance(lux));
    std::vector<Vdl> fewer;
    for (std::size_t count = 1; count < lights.size(); ++count) {
        fewer.assign(count, Vdl{});
        fitVdls(lights, n, form, fewer, scratch);
        if (form == VdlForm::corrected) scaleTo(whole[0], n, fewer);
        const OnNormals merged = illuminances(fewer, normals);
        float apart = 0.0f;
        for (std::size_t i = 0; i < kNormals; ++i) apart = glm::max(apart, maxChannel(glm::abs(merged[i] - whole[i])));
        if (!(apart <= kBetween * tolerance * brightest)) continue;
        std::ranges::fill(vdls, Vdl{glm::vec3(0.0f), n});
        std::ranges::copy(fewer, vdls.begin());
        return count;
    }
    std::ranges::stable_partition(vdls, [](const Vdl& vdl) { return luminance(vdl.colour) > 0.0f; });
    return lights.size();
}

void scaleTo(glm::vec3 lux, glm::vec3 n, std::span<Vdl> vdls)
{
    if (vdls.empty()) return;
    const auto onEntry = [n](const Vdl& vdl) { return vdl.colour * glm::max(0.0f, glm::dot(vdl.toLight, n)); };
    glm::vec3 sum(0.0f);
    for (const Vdl& vdl : vdls) sum += onEntry(vdl);
    glm::vec3 missing(0.0f);
    for (int c = 0; c < 3; ++c) {
        const float share = sum[c] > 0.0f ? glm::min(lux[c] / sum[c], kMostScale) : 0.0f;
        for (Vdl& vdl : vdls) vdl.colour[c] *= share;
        missing[c] = glm::max(0.0f, lux[c] - share * sum[c]);
    }
    if (glm::all(glm::lessThanEqual(missing, 1e-5f * lux))) return;
    // light that grazes the entry, or comes from behind its plane, says little of where the rest is from: it comes
    // along the normal, as one of the lights, or in place of the weakest
    const auto weaker = [&](const Vdl& a, const Vdl& b) { return luminance(onEntry(a)) < luminance(onEntry(b)); };
    Vdl& spare = *std::ranges::min_element(vdls, weaker);
    spare = {onEntry(spare) + missing, n};
}

} // namespace lightloom
