// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/bake_products.h"
#include "core/trace/photon_segments.h"

namespace lightloom {

/// Ways of a light group's photons, block by block from the first, as far as they were kept. Immutable once shared.
struct GridPaths {
    std::vector<std::shared_ptr<const SegmentBlock>> blocks;
};

/// Gives the blocks of a light group's photons in order: those that an earlier bake left are taken from memory, the
/// others are traced. What is given is the same. Not for several threads.
class PathFeed {
public:
    /// `key` names the photons in `products`; up to `mostBytes` of blocks are kept there. There is room for
    /// `segmentsPerPhoton` from the start. What is traced lies in `buffer`, which feeds may share.
    PathFeed(const SceneProducts& scene, const PhotonJob& photons, std::string key, double mostBytes,
             double segmentsPerPhoton, std::vector<SegmentBlock>& buffer, BakeProducts& products);
    ~PathFeed(); ///< leaves in `products` what is to be kept, also after a stop
    PathFeed(const PathFeed&) = delete;
    PathFeed& operator=(const PathFeed&) = delete;

    /// Blocks `first` to `end`, without it; good until the next call on a feed of this buffer. Adds what tracing cost
    /// to `cost`. Empty: stopped.
    [[nodiscard]] std::span<const SegmentBlock* const> blocks(std::uint64_t first, std::uint64_t end,
                                                              BakeControl& control, StageCost& cost);

    [[nodiscard]] std::uint64_t photonsTraced() const { return photonsTraced_; }
    [[nodiscard]] std::uint64_t raysTraced() const { return raysTraced_; }
    [[nodiscard]] std::uint64_t photonsKept() const { return photonsKept_; } ///< given from memory

private:
    void keep(std::span<const SegmentBlock> traced, std::uint64_t first);

    const SceneProducts& scene_;
    PhotonJob photons_;
    std::string key_;
    double mostBytes_, segmentsPerPhoton_, bytes_ = 0.0;
    BakeProducts& products_;
    GridPaths kept_;
    std::uint64_t photonsTraced_ = 0, raysTraced_ = 0, photonsKept_ = 0;
    bool isNew_ = false; ///< more is kept than `products` has
    std::vector<SegmentBlock>& traced_;
    std::vector<const SegmentBlock*> given_;
};

} // namespace lightloom
