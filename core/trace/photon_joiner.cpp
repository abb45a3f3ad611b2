// SPDX-License-Identifier: Apache-2.0
#include "core/trace/photon_joiner.h"
#include <algorithm>

namespace lightloom {
namespace {

constexpr double kReserve = 1.05; ///< over what the blocks so far let expect: growing moves all photons

} // namespace

PhotonJoiner::PhotonJoiner(const PhotonJob& job, std::size_t blocks) : blocks_(blocks)
{
    paths_->group = job.group;
    paths_->shot = job.count;
}

RawVector<Photon> PhotonJoiner::memory()
{
    const std::lock_guard lock(mutex_);
    if (spare_.empty()) return {};
    RawVector<Photon> memory = std::move(spare_.back());
    spare_.pop_back();
    return memory;
}

void PhotonJoiner::add(std::size_t number, PhotonBlock&& done)
{
    std::vector<Placed> placed = place(number, std::move(done));
    {
        const std::shared_lock lock(growing_);
        for (const Placed& p : placed) {
            std::copy_n(p.block.photons.begin(), p.block.stored,
                        paths_->photons.begin() + static_cast<std::ptrdiff_t>(p.first));
        }
    }
    const std::lock_guard lock(mutex_);
    for (Placed& p : placed) spare_.push_back(std::move(p.block.photons));
}

/// The blocks whose turn has come, with their places, which exist.
std::vector<PhotonJoiner::Placed> PhotonJoiner::place(std::size_t number, PhotonBlock&& done)
{
    const std::lock_guard lock(mutex_);
    waiting_.emplace(number, std::move(done));
    std::vector<Placed> placed;
    for (auto next = waiting_.find(joined_); next != waiting_.end(); next = waiting_.find(joined_)) {
        const PhotonBlock& block = next->second;
        paths_->rays += block.rayCount;
        paths_->caustic += block.caustic;
        paths_->cutOff += block.cutOff;
        paths_->ledger += block.ledger;
        const std::size_t first = stored_;
        stored_ += block.stored;
        ++joined_;
        placed.push_back({std::move(next->second), first});
        waiting_.erase(next);
    }
    if (stored_ > paths_->photons.size()) {
        const std::unique_lock alone(growing_);
        const double all = static_cast<double>(stored_) / static_cast<double>(joined_) * static_cast<double>(blocks_);
        paths_->photons.resize(std::max(stored_, static_cast<std::size_t>(kReserve * all)));
    }
    return placed;
}

std::shared_ptr<const PhotonPaths> PhotonJoiner::finish()
{
    paths_->photons.resize(stored_);
    return paths_;
}

} // namespace lightloom
