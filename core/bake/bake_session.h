// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"
#include <thread>

namespace lightloom {

/// The one bake worker of a window. Latest request wins, but a running bake first shows its coarse picture, or the
/// picture would stand still while a slider moves. Callbacks come on the worker (progress: on any worker thread).
class BakeSession {
public:
    struct Sinks {
        std::function<void(Snapshot)> publish;
        std::function<void(Progress)> progress;
        /// A bake ended and was not replaced by a newer one: done, failed, or cancelled by `cancel`.
        std::function<void(std::uint64_t serial, const Result<Done>& outcome)> finished;
    };
    BakeSession(Workers& workers, std::unique_ptr<Solver> solver, Sinks sinks);
    ~BakeSession(); ///< as `end`
    /// Stops what runs; returns within 100 ms of the solver's next block. Nothing is published, told or finished after.
    void end();

    /// Any thread; returns at once. `urgent` (a new scene, a deleted lamp) does not wait for the coarse picture.
    /// Gives the job's serial.
    std::uint64_t post(BakeJob job, bool urgent = false);
    void cancel(); ///< stops the running bake and forgets the waiting one; the newest snapshot stays valid
    void setPaused(bool paused);
    [[nodiscard]] bool isPaused() const;
    /// Counters of the bake that ended last.
    [[nodiscard]] WorkCounters counters() const;
    /// Products of earlier bakes, for readers on the worker only (inside `publish` and `finished`).
    [[nodiscard]] BakeProducts& products() { return products_; }

private:
    void work(std::stop_token quit);
    void show(Snapshot snapshot);

    Workers& workers_;
    std::unique_ptr<Solver> solver_;
    Sinks sinks_;
    BakeProducts products_;
    mutable std::mutex mutex_;
    std::condition_variable_any wake_;
    std::optional<BakeJob> pending_;
    std::stop_source running_;
    BakeControl* control_ = nullptr; // of the running bake
    bool shown_ = false, paused_ = false;
    std::uint64_t serial_ = 0;
    WorkCounters counters_;
    std::jthread worker_; // last: it uses all of the above
};

} // namespace lightloom
