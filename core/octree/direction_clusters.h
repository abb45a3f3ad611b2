// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace lightloom {

/// Light from one direction that is to be clustered: a gathered photon, or a VDL that is to be merged with others.
struct LightVector {
    glm::vec3 toLight; ///< unit
    glm::vec3 colour;  ///< lux per channel on a surface that faces it
    float weight;      ///< of the k-means distance; luminous flux
};

/// Working memory of one thread, kept between fits. Arrays are filled up to whole groups of eight by what weighs
/// nothing.
struct ClusterScratch {
    std::vector<float> x, y, z, weight, nearest;
    std::vector<std::int32_t> cluster;
};

inline constexpr int kMostClusters = 8;

/// k-means over directions: chord distance weighted by `weight`, seeds by weighted farthest point, ties by order, at
/// most 16 rounds. Writes the cluster of each light to `scratch.cluster` and gives the number of clusters: at most k
/// (1 to kMostClusters), fewer where directions coincide.
int clusterDirections(std::span<const LightVector> lights, int k, ClusterScratch& scratch);

/// Sum over all lights of weight * squared chord to the mean direction of their cluster: what k-means minimises.
[[nodiscard]] double clusterCost(std::span<const LightVector> lights, const ClusterScratch& scratch, int clusters);

} // namespace lightloom
