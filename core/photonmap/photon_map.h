// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/photonmap/box_groups.h"
#include "core/photonmap/screens.h"
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
    Screens screens{};         ///< photons that they hide are not taken
};

/// What a gather found: always the same photons in the same order, that of their numbers.
struct Gathered {
    std::vector<std::uint32_t> photons; ///< numbers for PhotonMap::photon
    float radius = 0.0f;                ///< of the kernel: distance of the K-th photon, or the cap if fewer were there
    bool isFull = false;                ///< K photons were found
    std::vector<std::uint64_t> keys;    ///< the same with their distances (least_keys.h), in the same order
    std::vector<std::uint64_t> candidates, work; ///< memory of searches
    BoxGroups::Near near;                        ///< memory of searches
    std::vector<Screen> screens, nearScreens;    ///< memory of density estimates
    /// A guess at the next radius, from the last gather: saves time where queries lie close, and changes nothing else.
    float expected = 0.0f;
};

/// kd-tree over one light group's photons: blocks of 16 in structure-of-arrays form, made by median splits and found by
/// their boxes, eight boxes at a time; candidates kept as keys of (distance, number) and thinned by selection, not by a
/// heap. Photons lie, and are numbered, in the tree's order, so that those of a kernel lie together. Any thread may
/// query.
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
    struct Record;
    struct Search;
    PhotonMap() = default;
    bool takeInOrder(const PhotonPaths& paths, const std::vector<Record>& records, const std::stop_token& stop);
    static void split(std::vector<Record>& records, std::uint32_t firstBlock, std::uint32_t blocks,
                      const std::stop_token& stop);
    BoxGroups::Box fill(std::uint32_t block);
    void collect(Search& search, BoxGroups::Near& near) const;
    void scan(Search& search, std::uint32_t block) const;
    static std::size_t addBlock(const Search& search, const Block& block, std::uint32_t number);

    PhotonPaths paths_;
    std::vector<std::uint32_t> origin_;
    std::vector<Block> blocks_;
    BoxGroups boxes_;          // of the blocks
    float everyRadius_ = 0.0f; // that would hold one photon if all lay on the wall of a ball around the scene
};

} // namespace lightloom
