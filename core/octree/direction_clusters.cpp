// SPDX-License-Identifier: Apache-2.0
#include "core/octree/direction_clusters.h"
#include "core/base/wide_vectors.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr int kRounds = 16;
constexpr float kSameDirection = 1e-6f; ///< 1 - cosine below which two directions are one
constexpr float kRounding = 1e-7f;      ///< of all weight: a sum below it says nothing

/// What is clustered, in groups of eight. Weights are shares of all weight: squares of small fluxes underflow.
struct Directions {
    const float* x;
    const float* y;
    const float* z;
    const float* weight;
    std::size_t groups;
};

using Centres = std::array<glm::vec3, kMostClusters>;

/// Place and value of the largest number; the first of equals.
struct Most {
    std::size_t place = 0;
    float value = -1.0f;
};

Most mostOf(const float* values, const std::int32_t* places)
{
    Most most{static_cast<std::size_t>(places[0]), values[0]};
    for (std::size_t i = 1; i < kLanes; ++i) {
        const auto place = static_cast<std::size_t>(places[i]);
        if (values[i] > most.value || (values[i] == most.value && place < most.place)) most = {place, values[i]};
    }
    return most;
}

LIGHTLOOM_WIDE_VECTORS void heaviest(const Directions& d, float* values, std::int32_t* places)
{
    Floats8 most = lanesOf<Floats8>(d.weight, 0);
    Ints8 place{0, 1, 2, 3, 4, 5, 6, 7}, at = place;
    for (std::size_t g = 1; g < d.groups; ++g) {
        place += static_cast<int>(kLanes);
        const Floats8 weight = lanesOf<Floats8>(d.weight, g);
        const Ints8 more = weight > most;
        most = more ? weight : most;
        at = more ? place : at;
    }
    lanesOf<Floats8>(values, 0) = most;
    lanesOf<Ints8>(places, 0) = at;
}

/// Takes a further centre into account: the largest cosine so far of each direction, and what adds most to the cost if
/// it stays where it is (squared chord is 2 - 2 cosine).
LIGHTLOOM_WIDE_VECTORS void nearer(const Directions& d, const float* centre, float* nearest, float* values,
                                   std::int32_t* places)
{
    Floats8 most{-1.0f, -1.0f, -1.0f, -1.0f, -1.0f, -1.0f, -1.0f, -1.0f};
    Ints8 place{0, 1, 2, 3, 4, 5, 6, 7}, at = place;
    for (std::size_t g = 0; g < d.groups; ++g) {
        const Floats8 cosine = lanesOf<Floats8>(d.x, g) * centre[0] + lanesOf<Floats8>(d.y, g) * centre[1] +
                               lanesOf<Floats8>(d.z, g) * centre[2];
        const Floats8 before = lanesOf<Floats8>(nearest, g);
        const Floats8 now = cosine > before ? cosine : before;
        lanesOf<Floats8>(nearest, g) = now;
        const Floats8 apart = 1.0f - now;
        const Floats8 cost = apart > kSameDirection ? apart * lanesOf<Floats8>(d.weight, g) : Floats8{};
        const Ints8 more = cost > most;
        most = more ? cost : most;
        at = more ? place : at;
        place += static_cast<int>(kLanes);
    }
    lanesOf<Floats8>(values, 0) = most;
    lanesOf<Ints8>(places, 0) = at;
}

[[gnu::always_inline]] inline float sumOf(const Floats8& s)
{
    const Floats4 four = __builtin_shufflevector(s, s, 0, 1, 2, 3) + __builtin_shufflevector(s, s, 4, 5, 6, 7);
    return (four[0] + four[2]) + (four[1] + four[3]);
}

/// Sends each direction to its nearest of K centres, the first of equals, and sums weight * direction of each cluster.
/// False: all stayed.
template<int K>
[[gnu::always_inline]] inline bool assign(const Directions& d, const Centres& centres, std::int32_t* cluster,
                                          Centres& out)
{
    Floats8 sums[K][3] = {};
    Ints8 changed{};
    for (std::size_t g = 0; g < d.groups; ++g) {
        const Floats8 x = lanesOf<Floats8>(d.x, g), y = lanesOf<Floats8>(d.y, g), z = lanesOf<Floats8>(d.z, g);
        Floats8 best = x * centres[0].x + y * centres[0].y + z * centres[0].z;
        Ints8 which{};
#pragma GCC unroll 8
        for (int j = 1; j < K; ++j) {
            const glm::vec3& c = centres[static_cast<std::size_t>(j)];
            const Floats8 cosine = x * c.x + y * c.y + z * c.z;
            const Ints8 closer = cosine > best;
            best = closer ? cosine : best;
            which = closer ? Ints8{} + j : which;
        }
        changed |= which ^ lanesOf<Ints8>(cluster, g);
        lanesOf<Ints8>(cluster, g) = which;
        const Floats8 weight = lanesOf<Floats8>(d.weight, g);
#pragma GCC unroll 8
        for (int j = 0; j < K; ++j) {
            const Floats8 mine = which == j ? weight : Floats8{};
            sums[j][0] += mine * x;
            sums[j][1] += mine * y;
            sums[j][2] += mine * z;
        }
    }
    for (int j = 0; j < K; ++j) {
        for (int axis = 0; axis < 3; ++axis) {
            out[static_cast<std::size_t>(j)][axis] = sumOf(sums[j][axis]);
        }
    }
    std::int32_t any = 0;
    for (std::size_t i = 0; i < kLanes; ++i) any |= changed[i];
    return any != 0;
}

LIGHTLOOM_WIDE_VECTORS bool assignToFour(const Directions& d, const Centres& centres, std::int32_t* cluster,
                                         Centres& sums)
{
    return assign<4>(d, centres, cluster, sums);
}

LIGHTLOOM_WIDE_VECTORS bool assignToEight(const Directions& d, const Centres& centres, std::int32_t* cluster,
                                          Centres& sums)
{
    return assign<8>(d, centres, cluster, sums);
}

LIGHTLOOM_WIDE_VECTORS void makeShares(float* weight, std::size_t groups)
{
    Floats8 sums{};
    for (std::size_t g = 0; g < groups; ++g) sums += lanesOf<Floats8>(weight, g);
    const float all = sumOf(sums), share = all >= std::numeric_limits<float>::min() ? 1.0f / all : 0.0f;
    for (std::size_t g = 0; g < groups; ++g) lanesOf<Floats8>(weight, g) *= share;
}

Directions takeIn(std::span<const LightVector> lights, ClusterScratch& s)
{
    const std::size_t groups = (lights.size() + kLanes - 1) / kLanes, places = groups * kLanes;
    for (auto* array : {&s.x, &s.y, &s.z, &s.weight}) array->resize(places);
    for (std::size_t i = 0; i < places; ++i) {
        const bool isUsed = i < lights.size();
        const glm::vec3 to = isUsed ? lights[i].toLight : glm::vec3(0.0f);
        s.x[i] = to.x, s.y[i] = to.y, s.z[i] = to.z;
        s.weight[i] = isUsed ? lights[i].weight : 0.0f;
    }
    makeShares(s.weight.data(), groups);
    s.nearest.assign(places, -2.0f);
    s.cluster.assign(places, 0);
    return {s.x.data(), s.y.data(), s.z.data(), s.weight.data(), groups};
}

/// Centres that were not needed are the first again: nothing is nearer to them.
int seed(Centres& centres, int k, const Directions& d, ClusterScratch& s)
{
    float values[kLanes];
    std::int32_t places[kLanes];
    heaviest(d, values, places);
    std::size_t next = mostOf(values, places).place;
    const auto at = [&](std::size_t i) { return glm::vec3(d.x[i], d.y[i], d.z[i]); };
    centres.fill(at(next));
    for (int j = 1; j < k; ++j) {
        nearer(d, &centres[static_cast<std::size_t>(j) - 1].x, s.nearest.data(), values, places);
        next = mostOf(values, places).place;
        if (!(1.0f - s.nearest[next] > kSameDirection)) return j; // no further direction
        centres[static_cast<std::size_t>(j)] = at(next);
    }
    return k;
}

/// Moves each centre to the mean direction of its cluster; one whose directions cancel stays.
void recentre(Centres& centres, int clusters, const Centres& sums)
{
    for (std::size_t j = 0; j < static_cast<std::size_t>(clusters); ++j) {
        const float length = glm::length(sums[j]);
        if (length > kRounding) centres[j] = sums[j] * (1.0f / length);
    }
    std::fill(centres.begin() + clusters, centres.end(), centres[0]);
}

} // namespace

int clusterDirections(std::span<const LightVector> lights, int k, ClusterScratch& s)
{
    if (lights.empty()) return 0;
    if (k == 1) {
        s.cluster.assign(lights.size(), 0);
        return 1;
    }
    const Directions d = takeIn(lights, s);
    Centres centres{};
    const int clusters = seed(centres, std::min(k, kMostClusters), d, s);
    if (clusters == 1) return 1;
    const auto assignAll = clusters <= 4 ? assignToFour : assignToEight;
    Centres sums;
    assignAll(d, centres, s.cluster.data(), sums);
    for (int round = 0; round < kRounds; ++round) {
        recentre(centres, clusters, sums);
        if (!assignAll(d, centres, s.cluster.data(), sums)) break;
    }
    return clusters;
}

double clusterCost(std::span<const LightVector> lights, const ClusterScratch& s, int clusters)
{
    // sum w |d - m|^2 = sum w - |sum w d| * 2 + sum w, m the unit mean
    std::vector<glm::dvec3> sums(static_cast<std::size_t>(clusters), glm::dvec3(0.0));
    double weight = 0.0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        sums[static_cast<std::size_t>(s.cluster[i])] +=
            static_cast<double>(lights[i].weight) * glm::dvec3(lights[i].toLight);
        weight += static_cast<double>(lights[i].weight);
    }
    double cost = 2.0 * weight;
    for (const glm::dvec3& sum : sums) cost -= 2.0 * glm::length(sum);
    return cost;
}

} // namespace lightloom
