// SPDX-License-Identifier: Apache-2.0
#include "core/field/bake_control.h"
#include <algorithm>

namespace lightloom {

BakeControl::BakeControl(Workers& workers, Sinks sinks, std::stop_token stop, std::uint64_t serial)
    : workers_(workers), sinks_(std::move(sinks)), stop_(std::move(stop)), serial_(serial)
{
}

BakeControl::BakeControl(BakeControl& outer, Sinks sinks)
    : BakeControl(outer.workers_, std::move(sinks), outer.stop_, outer.serial_)
{
    outer_ = &outer;
    outerBeganMs_ = outer.elapsedMs();
}

void BakeControl::publish(std::shared_ptr<const IndirectField> field, int level, bool isFinal, bool isRough)
{
    if (sinks_.publish) sinks_.publish({std::move(field), level, isRough, isFinal, elapsedMs(), serial_});
}

void BakeControl::progress(Stage stage, double fraction)
{
    if (!sinks_.progress) return;
    const double elapsed = elapsedMs() / 1000.0;
    Progress told;
    {
        std::lock_guard lock(mutex_);
        fraction_ = std::max(fraction_, std::clamp(fraction, 0.0, 1.0));
        const auto now = Clock::now();
        if (fraction_ < 1.0 && now - lastTold_ < std::chrono::milliseconds(50)) return;
        lastTold_ = now;
        // an estimate from less than a tenth of a second or two per cent of the work would jump about
        const bool known = elapsed > 0.1 && fraction_ > 0.02;
        told = {stage, fraction_, known ? elapsed * (1.0 - fraction_) / fraction_ : -1.0, serial_};
    }
    sinks_.progress(told);
}

bool BakeControl::forBlocks(std::size_t blocks, const std::function<void(std::size_t)>& body)
{
    return workers_.run(blocks, stop_, [&](std::size_t block) {
        waitWhilePaused();
        if (!stop_.stop_requested()) body(block);
    }) && !stop_.stop_requested();
}

void BakeControl::setPaused(bool paused)
{
    {
        std::lock_guard lock(mutex_);
        if (paused == paused_) return;
        paused_ = paused;
        if (paused) {
            pausedAt_ = Clock::now();
        } else {
            pausedFor_ += Clock::now() - pausedAt_;
        }
    }
    resume_.notify_all();
}

void BakeControl::waitWhilePaused()
{
    if (outer_) outer_->waitWhilePaused();
    std::unique_lock lock(mutex_);
    resume_.wait(lock, stop_, [this] { return !paused_; });
}

double BakeControl::elapsedMs() const
{
    if (outer_) return outer_->elapsedMs() - outerBeganMs_;
    std::lock_guard lock(mutex_);
    const auto now = paused_ ? pausedAt_ : Clock::now();
    return std::chrono::duration<double, std::milli>(now - began_ - pausedFor_).count();
}

} // namespace lightloom
