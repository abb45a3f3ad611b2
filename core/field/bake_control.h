// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/field/indirect_field.h"
#include "core/params/bake_params.h"
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>

namespace lightloom {

/// One refinement, shown as it is while the next is made.
struct Snapshot {
    std::shared_ptr<const IndirectField> field;
    int level = 0;        ///< octree depth; rises with each refinement
    bool isRough = false; ///< from a part of the photons, before the bake proper
    bool isFinal = false; ///< nothing finer follows
    double elapsedMs = 0; ///< since the bake began, pauses left out
    std::uint64_t serial = 0;
};

struct Progress {
    Stage stage = Stage::shoot;
    double fraction = 0;          ///< of the whole bake, 0 to 1, never falls within one bake
    double remainingSeconds = -1; ///< estimate; negative while unknown
    std::uint64_t serial = 0;
};

/// What a solver needs from whoever runs it: threads, stop, pause, and where results go. Made anew for each bake.
class BakeControl {
public:
    struct Sinks {
        std::function<void(Snapshot)> publish;  ///< on the bake worker
        std::function<void(Progress)> progress; ///< on any worker, at most 20 times a second
    };
    BakeControl(Workers& workers, Sinks sinks, std::stop_token stop = {}, std::uint64_t serial = 0);
    /// For one bake of several inside a longer job: results go to `sinks`, stop and pause are those of `outer`, which
    /// must live longer.
    BakeControl(BakeControl& outer, Sinks sinks);

    [[nodiscard]] Workers& workers() { return workers_; }
    [[nodiscard]] const std::stop_token& stop() const { return stop_; }
    [[nodiscard]] bool isStopped() const { return stop_.stop_requested(); }

    void publish(std::shared_ptr<const IndirectField> field, int level, bool isFinal, bool isRough = false);
    /// `fraction` of the whole bake done.
    void progress(Stage stage, double fraction);

    /// Runs blocks on all workers; waits between blocks while paused. False if stopped before all ran.
    bool forBlocks(std::size_t blocks, const std::function<void(std::size_t)>& body);

    void setPaused(bool paused);            ///< any thread
    void waitWhilePaused();                 ///< returns at once when not paused, or when stopped
    [[nodiscard]] double elapsedMs() const; ///< since construction, pauses left out

private:
    using Clock = std::chrono::steady_clock;
    Workers& workers_;
    Sinks sinks_;
    std::stop_token stop_;
    std::uint64_t serial_;
    BakeControl* outer_ = nullptr;
    double outerBeganMs_ = 0;
    Clock::time_point began_ = Clock::now();
    mutable std::mutex mutex_;
    std::condition_variable_any resume_;
    bool paused_ = false;
    Clock::time_point pausedAt_{};
    Clock::duration pausedFor_{};
    Clock::time_point lastTold_{};
    double fraction_ = 0;
};

} // namespace lightloom
