// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/photon_tracer.h"
#include <cstdint>
#include <vector>

namespace lightloom {

/// Region photons are gathered from: all within `radius` of `centre`, distances along `normal` stretched by `stretch`
/// (1: a sphere; s: an ellipsoid flattened to radius / s along the normal), whose own normal is within 60 degrees of
/// `normal` (cosine above `leastCosine`; -2 takes all).
struct GatherQuery {
    glm::vec3 centre{0.0f}, normal{0.0f, 1.0f, 0.0f};
    float radius = 1.0f; ///< cap, metres
    float stretch = 1.0f;
    float leastCosine = 0.5f;
    std::uint32_t count = 100; ///< K: the nearest that many
};

/// What a gather found: always the same photons in the same order, the tree's from near to far.
struct Gathered {
    std::vector<std::uint32_t> photons; ///< numbers for PhotonMap::photon
    float radius = 0.0f;                ///< of the kernel: distance of the K-th photon, or the cap if fewer were there
    bool isFull = false;                ///< K photons were found
    std::vector<std::uint64_t> keys; ///< the same as (bits of the squared distance as float) << 32 | number; order as
                                     ///< in `photons`; kept between gathers of one thread
    std::vector<std::uint64_t> work; ///< for selections
    /// A guess at the next radius, from the last gather: saves time where queries lie close, and changes nothing else.
    float expected = 0.0f;
};

/// kd-tree over one light group's photons: blocks of 16 in structure-of-arrays form under an implicit tree of median
/// splits, candidates kept as (distance, number) keys and thinned by selection, not by a heap. Photons lie, and are
/// numbered, in the tree's order, so that those of a kernel lie together. Any thread may query.
class PhotonMap {
public:
    /// Builds the tree, O(n log n). Null: stopped.
    static std::shared_ptr<const PhotonMap> build(const std::shared_ptr<const PhotonPaths>& paths,
                                                  const std::stop_token& stop = {});

    [[nodiscard]] std::size_t size() const { return paths_.photons.size(); }
    [[nodiscard]] const Photon& photon(std::uint32_t number) const { return paths_.photons[number]; }
    [[nodiscard]] const PhotonPaths& paths() const { return paths_; } ///< as given, but in the tree's order
    /// Place that photon `number` had in the list the map was built from.
    [[nodiscard]] std::uint32_t origin(std::uint32_t number) const { return origin_[number]; }
    /// Numbers in the order of that list.
    [[nodiscard]] std::vector<std::uint32_t> listOrder() const;
    [[nodiscard]] std::size_t memoryBytes() const; ///< tree and photons

    /// The `query.count` nearest photons; ties by number. O(K + log n) typical.
    void gather(const GatherQuery& query, Gathered& out) const;

private:
    static constexpr std::uint32_t kBlock = 16;
    struct alignas(64) Block {
        float x[kBlock], y[kBlock], z[kBlock];
        float nx[kBlock], ny[kBlock], nz[kBlock];
    };
    struct Node {
        float split = 0.0f;
        std::int32_t axis = 0;
    };
    struct Record;
    struct Search;
    PhotonMap() = default;
    bool takeInOrder(const PhotonPaths& paths, const std::vector<Record>& records, const std::stop_token& stop);
    void split(std::vector<Record>& records, std::uint32_t firstBlock, std::uint32_t blocks, std::uint32_t node,
               const std::stop_token& stop);
    void fill(std::uint32_t block);
    void descend(Search& search, std::uint32_t firstBlock, std::uint32_t blocks, std::uint32_t node, glm::vec3 offset,
                 float squared) const;
    void collect(const GatherQuery& query, float radius, Gathered& out) const;
    void scan(Search& search, std::uint32_t block) const;

    PhotonPaths paths_;
    std::vector<std::uint32_t> origin_;
    std::vector<Block> blocks_;
    std::vector<Node> nodes_; // implicit: children of n are 2n+1 and 2n+2
};

} // namespace lightloom
