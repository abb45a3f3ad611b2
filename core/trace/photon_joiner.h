// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/photon_path.h"
#include <map>
#include <mutex>
#include <shared_mutex>

namespace lightloom {

/// Joins blocks of photons in their order while others are still traced, so that photons lie twice in memory for as
/// long as a block takes only, and each thread keeps to the memory of few blocks. Any thread may add and ask.
class PhotonJoiner {
public:
    PhotonJoiner(const PhotonJob& job, std::size_t blocks);

    /// For the photons of a new block: what a joined one left.
    [[nodiscard]] RawVector<Photon> memory();
    /// Block `number`, when it is done.
    void add(std::size_t number, PhotonBlock&& done);
    /// After all were added.
    [[nodiscard]] std::shared_ptr<const PhotonPaths> finish();

private:
    struct Placed {
        PhotonBlock block;
        std::size_t first; // of its photons
    };
    std::vector<Placed> place(std::size_t number, PhotonBlock&& done);

    std::mutex mutex_;          // of all but the photons themselves
    std::shared_mutex growing_; // alone while photons move to larger memory, shared while some are written
    std::map<std::size_t, PhotonBlock> waiting_;
    std::vector<RawVector<Photon>> spare_;
    std::size_t blocks_, joined_ = 0, stored_ = 0;
    std::shared_ptr<PhotonPaths> paths_ = std::make_shared<PhotonPaths>();
};

} // namespace lightloom
