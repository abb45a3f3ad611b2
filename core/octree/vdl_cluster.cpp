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

constexpr int kMostClusters = 8, kRounds = 16;
constexpr float kMostScale = 1e3f;      ///< beyond it the sum that is scaled is rounding
constexpr float kSameDirection = 1e-6f; ///< 1 - cosine below which two directions are one

/// Largest cosine to the centres so far, and the centre that has it. Plain loops: they vectorise, and give the same
/// bits on any vector width.
LIGHTLOOM_WIDE_VECTORS void nearer(const float* __restrict x, const float* __restrict y, const float* __restrict z,
                                   std::size_t count, const float* centre, std::uint8_t number,
                                   float* __restrict nearest, std::uint8_t* __restrict cluster)
{
    const float cx = centre[0], cy = centre[1], cz = centre[2];
    for (std::size_t i = 0; i < count; ++i) {
        const float cosine = x[i] * cx + y[i] * cy + z[i] * cz;
        const bool closer = cosine > nearest[i];
        nearest[i] = closer ? cosine : nearest[i];
        cluster[i] = closer ? number : cluster[i];
    }
}

using Centres = std::array<glm::vec3, kMostClusters>;

void assign(const Centres& centres, int clusters, ClusterScratch& s)
{
    std::ranges::fill(s.nearest, -2.0f);
    for (int j = 0; j < clusters; ++j) {
        nearer(s.x.data(), s.y.data(), s.z.data(), s.x.size(), &centres[static_cast<std::size_t>(j)].x,
               static_cast<std::uint8_t>(j), s.nearest.data(), s.cluster.data());
    }
}

/// The light that adds most to the cost if it stays where it is: squared chord is 2 - 2 cosine.
std::size_t farthest(const ClusterScratch& s)
{
    std::size_t best = 0;
    float bestCost = -1.0f;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
        const float apart = 1.0f - s.nearest[i];
        const float cost = apart > kSameDirection ? apart * s.weight[i] : 0.0f;
        if (cost > bestCost) bestCost = cost, best = i;
    }
    return best;
}

int seed(Centres& centres, int k, ClusterScratch& s)
{
    const auto heaviest = static_cast<std::size_t>(std::ranges::max_element(s.weight) - s.weight.begin());
    centres[0] = {s.x[heaviest], s.y[heaviest], s.z[heaviest]};
    std::ranges::fill(s.nearest, -2.0f);
    nearer(s.x.data(), s.y.data(), s.z.data(), s.x.size(), &centres[0].x, 0, s.nearest.data(), s.cluster.data());
    for (int j = 1; j < k; ++j) {
        const std::size_t next = farthest(s);
        if (!(1.0f - s.nearest[next] > kSameDirection)) return j; // no further direction
        const auto n = static_cast<std::size_t>(j);
        centres[n] = {s.x[next], s.y[next], s.z[next]};
        nearer(s.x.data(), s.y.data(), s.z.data(), s.x.size(), &centres[n].x, static_cast<std::uint8_t>(j),
               s.nearest.data(), s.cluster.data());
    }
    return k;
}

/// Weighted sums of the directions of each cluster, and of all weights.
struct ClusterSums {
    std::array<glm::dvec3, kMostClusters> direction{};
    double weight = 0.0;
};

glm::dvec3 weighted(const ClusterScratch& s, std::size_t i)
{
    return static_cast<double>(s.weight[i]) * glm::dvec3(s.x[i], s.y[i], s.z[i]);
}

ClusterSums sumsOf(const ClusterScratch& s)
{
    ClusterSums sums;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
        sums.direction[s.cluster[i]] += weighted(s, i);
        sums.weight += static_cast<double>(s.weight[i]);
    }
    return sums;
}

/// Takes those that changed their cluster over: few, after the first rounds. False: none did.
bool takeOver(const ClusterScratch& s, ClusterSums& sums)
{
    bool isChanged = false;
    for (std::size_t i = 0; i < s.x.size(); ++i) {
        if (s.cluster[i] == s.previous[i]) continue;
        const glm::dvec3 moved = weighted(s, i);
        sums.direction[s.previous[i]] -= moved;
        sums.direction[s.cluster[i]] += moved;
        isChanged = true;
    }
    return isChanged;
}

/// Moves each centre to the mean direction of its cluster; one whose directions cancel stays.
void recentre(Centres& centres, int clusters, const ClusterSums& sums)
{
    for (int j = 0; j < clusters; ++j) {
        const auto n = static_cast<std::size_t>(j);
        const double length = glm::length(sums.direction[n]);
        // rounding is left where all have gone
        if (length > 1e-12 * sums.weight) centres[n] = glm::vec3(sums.direction[n] / length);
    }
}

/// Per channel sum of colour * toLight: columns R, G, B.
struct VectorSum {
    glm::dmat3 v{0.0};
    glm::dvec3 colour{0.0}, direction{0.0};
    const LightVector* strongest = nullptr;

    void add(const LightVector& light)
    {
        const glm::dvec3 d(light.toLight);
        for (int c = 0; c < 3; ++c) v[c] += static_cast<double>(light.colour[c]) * d;
        colour += glm::dvec3(light.colour);
        direction += static_cast<double>(light.weight) * d;
        if (!strongest || light.weight > strongest->weight) strongest = &light;
    }
};

Vdl corrected(const VectorSum& sum, glm::vec3 n)
{
    const glm::dvec3 weighted = static_cast<double>(kLumaR) * sum.v[0] + static_cast<double>(kLumaG) * sum.v[1] +
                                static_cast<double>(kLumaB) * sum.v[2];
    const double length = glm::length(weighted);
    const double all = static_cast<double>(kLumaR) * sum.colour.x + static_cast<double>(kLumaG) * sum.colour.y +
                       static_cast<double>(kLumaB) * sum.colour.z;
    Vdl vdl;
    // opposite directions that cancel leave no direction of their own: take the strongest light's
    vdl.toLight = length > 1e-3 * all ? glm::vec3(weighted / length) : sum.strongest->toLight;
    const double cosine = std::max(static_cast<double>(glm::dot(vdl.toLight, n)), static_cast<double>(kLeastCosine));
    for (int c = 0; c < 3; ++c) {
        vdl.colour[c] = static_cast<float>(std::max(0.0, glm::dot(sum.v[c], glm::dvec3(n))) / cosine);
    }
    return vdl;
}

Vdl asPrinted(const VectorSum& sum)
{
    const double length = glm::length(sum.direction);
    return {glm::vec3(sum.colour), length > 0.0 ? glm::vec3(sum.direction / length) : sum.strongest->toLight};
}

} // namespace

int clusterDirections(std::span<const LightVector> lights, int k, ClusterScratch& s)
{
    const std::size_t count = lights.size();
    for (auto* array : {&s.x, &s.y, &s.z, &s.weight, &s.nearest}) array->resize(count);
    s.cluster.assign(count, 0);
    if (count == 0) return 0;
    for (std::size_t i = 0; i < count; ++i) {
        s.x[i] = lights[i].toLight.x, s.y[i] = lights[i].toLight.y, s.z[i] = lights[i].toLight.z;
        s.weight[i] = lights[i].weight;
    }
    Centres centres{};
    const int clusters = seed(centres, std::min(k, kMostClusters), s);
    ClusterSums sums = sumsOf(s);
    for (int round = 0; round < kRounds && clusters > 1; ++round) {
        s.previous = s.cluster;
        recentre(centres, clusters, sums);
        assign(centres, clusters, s);
        if (!takeOver(s, sums)) break;
    }
    return clusters;
}

double clusterCost(std::span<const LightVector> lights, const ClusterScratch& s, int clusters)
{
    // sum w |d - m|^2 = sum w - |sum w d| * 2 + sum w, m the unit mean
    std::vector<glm::dvec3> sums(static_cast<std::size_t>(clusters), glm::dvec3(0.0));
    double weight = 0.0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        sums[s.cluster[i]] += static_cast<double>(lights[i].weight) * glm::dvec3(lights[i].toLight);
        weight += static_cast<double>(lights[i].weight);
    }
    double cost = 2.0 * weight;
    for (const glm::dvec3& sum : sums) cost -= 2.0 * glm::length(sum);
    return cost;
}

void fitVdls(std::span<const LightVector> lights, glm::vec3 n, VdlForm form, std::span<Vdl> out,
             ClusterScratch& scratch)
{
    std::ranges::fill(out, Vdl{glm::vec3(0.0f), n});
    const int clusters = clusterDirections(lights, static_cast<int>(out.size()), scratch);
    std::array<VectorSum, kMostClusters> sums{};
    for (std::size_t i = 0; i < lights.size(); ++i) sums[scratch.cluster[i]].add(lights[i]);
    std::size_t used = 0;
    for (int j = 0; j < clusters; ++j) {
        const VectorSum& sum = sums[static_cast<std::size_t>(j)];
        if (!sum.strongest || sum.colour == glm::dvec3(0.0)) continue;
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
