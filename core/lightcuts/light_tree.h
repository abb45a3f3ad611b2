// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/lightcuts/disc_light.h"
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace lightloom {

/// A cluster of lights; those that are dark do not count. A cache line; the two halves of a cluster lie side by side.
struct alignas(64) LightNode {
    glm::vec3 low, high;  ///< box of the positions; low > high: all are dark
    glm::vec3 flux;       ///< lm, of all together
    glm::vec3 axis;       ///< of a cone that holds all normals, unit
    float cosine;         ///< of its half angle
    float leastArea;      ///< m2, of the smallest
    std::uint32_t child;  ///< the first half; the second comes after it. 0: a single light
    std::uint32_t chosen; ///< the light that stands for all
    [[nodiscard]] bool isLeaf() const { return child == 0; }
};

/// Lights in a binary tree of clusters (Walter et al. 2005; the 2009 paper, section 4.2). Split from the top, halfway
/// along the longest side of the box of positions and normals, these scaled to a quarter of the diagonal. In each
/// cluster one light stands for all: one of the two that stand for its halves, drawn by flux, with numbers that depend
/// on (seed, cluster) alone. So receivers share it: errors of neighbours are alike, which leaves a picture without
/// noise (at worst with faint blotches, within the bound), and a half that keeps its parent's light needs no shadow
/// ray. Never changes once built: any number of threads may read it.
class LightTree {
public:
    /// `exitance`: lm/m2 by light, as many as `lights`; what is negative or not finite counts as dark, and so does a
    /// light whose place is not finite. `cellSize`: metres, side of the voxels that the lights stand for; shadow rays
    /// end half of it before them. 0 for lamps, which lie free. O(n log n): 104,000 lights in 25 ms.
    [[nodiscard]] static std::shared_ptr<const LightTree>
    build(std::span<const DiscLight> lights, std::span<const glm::vec3> exitance, float cellSize, std::uint64_t seed);
    /// The same lights with other exitances (in `build`'s order): bit by bit the tree that `build` makes of them, but
    /// the split is shared with this one. O(n log n), 104,000 lights in 17 ms.
    [[nodiscard]] std::shared_ptr<const LightTree> withExitance(std::span<const glm::vec3> exitance) const;

    /// The root first, none without lights. Halves come after their cluster.
    [[nodiscard]] std::span<const LightNode> nodes() const { return nodes_; }
    /// All of a cluster as if it were one flat piece of surface, by node: its middle and mean normal, weighted by flux
    /// (shorter than 1 where normals differ), and the area of a square over which light would be spread as widely.
    [[nodiscard]] const DiscLight& mean(std::size_t node) const { return means_[node]; }
    /// In the order of the tree: those of a cluster come one after the other.
    [[nodiscard]] std::span<const DiscLight> lights() const { return split_->lights; }
    [[nodiscard]] glm::vec3 fluxOf(std::size_t light) const { return flux_[light]; } ///< lm
    /// The lights of a cluster: from the first to before the second.
    struct Range {
        std::uint32_t first, last;
    };
    [[nodiscard]] Range lightsOf(std::size_t node) const { return split_->ranges[node]; }
    [[nodiscard]] float cellSize() const { return split_->cellSize; }
    [[nodiscard]] std::size_t memoryBytes() const;

private:
    struct Split { // what does not depend on how bright the lights are
        float cellSize;
        std::uint64_t seed;
        std::vector<DiscLight> lights;
        std::vector<std::uint32_t> order; // their numbers as they were given
        std::vector<std::uint32_t> children;
        std::vector<Range> ranges;
    };
    explicit LightTree(std::shared_ptr<const Split> split) : split_(std::move(split)) {}
    static std::shared_ptr<const Split> splitUp(std::span<const DiscLight> lights, float cellSize, std::uint64_t seed);
    void light(std::span<const glm::vec3> exitance);
    [[nodiscard]] LightNode leaf(std::uint32_t light) const;
    [[nodiscard]] LightNode joined(std::size_t node) const;
    [[nodiscard]] DiscLight meanOf(std::uint32_t child) const;

    std::shared_ptr<const Split> split_;
    std::vector<LightNode> nodes_;
    std::vector<DiscLight> means_; // by node
    std::vector<glm::vec3> flux_;  // by light
};

} // namespace lightloom
