// SPDX-License-Identifier: Apache-2.0
#include "core/bake/bake_session.h"

namespace lightloom {

BakeSession::BakeSession(Workers& workers, std::unique_ptr<Solver> solver, Sinks sinks)
    : workers_(workers), solver_(std::move(solver)), sinks_(std::move(sinks)),
      worker_([this](std::stop_token quit) { work(std::move(quit)); })
{
}

BakeSession::~BakeSession() { end(); }

void BakeSession::end()
{
    worker_.request_stop();
    if (worker_.joinable()) worker_.join();
}

std::uint64_t BakeSession::post(BakeJob job, bool urgent)
{
    std::uint64_t serial = 0;
    {
        std::lock_guard lock(mutex_);
        serial = job.serial = ++serial_;
        pending_ = std::move(job);
        if (shown_ || urgent) running_.request_stop();
    }
    wake_.notify_one();
    return serial;
}

void BakeSession::cancel()
{
    std::lock_guard lock(mutex_);
    pending_.reset();
    running_.request_stop();
}

void BakeSession::setPaused(bool paused)
{
    std::lock_guard lock(mutex_);
    paused_ = paused;
    if (control_) control_->setPaused(paused);
}

bool BakeSession::isPaused() const
{
    std::lock_guard lock(mutex_);
    return paused_;
}

WorkCounters BakeSession::counters() const
{
    std::lock_guard lock(mutex_);
    return counters_;
}

void BakeSession::show(Snapshot snapshot)
{
    sinks_.publish(std::move(snapshot));
    std::lock_guard lock(mutex_);
    shown_ = true;
    if (pending_) running_.request_stop(); // a superseded bake ends after one coarse picture
}

void BakeSession::work(std::stop_token quit)
{
    while (true) {
        std::unique_lock lock(mutex_);
        if (!wake_.wait(lock, quit, [this] { return pending_.has_value(); }) || quit.stop_requested()) return;
        const BakeJob job = std::move(*pending_);
        pending_.reset();
        std::stop_source run;
        running_ = run;
        shown_ = false;
        std::stop_callback linked(quit, [&run] { run.request_stop(); });
        BakeControl control(workers_, {[this](Snapshot s) { show(std::move(s)); }, sinks_.progress}, run.get_token(),
                            job.serial);
        control.setPaused(paused_);
        control_ = &control;
        lock.unlock();

        products_.beginRound();
        Result<Done> outcome = [&]() -> Result<Done> {
            try {
                return solver_->bake(job, products_, control);
            } catch (const std::bad_alloc&) {
                return Error{Error::Kind::outOfMemory,
                             "the bake needs more memory than there is; lower photons or octree.depth"};
            }
        }();

        if (outcome) products_.endRound();
        lock.lock();
        control_ = nullptr;
        counters_ = products_.counters;
        const bool replaced = pending_.has_value();
        lock.unlock();
        if (!replaced && !quit.stop_requested() && sinks_.finished) sinks_.finished(job.serial, outcome);
    }
}

} // namespace lightloom
