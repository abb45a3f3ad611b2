// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <mutex>

namespace lightloom {

/// Says when it is time to tell a window how far something is: five times a second, from any thread.
class Seldom {
public:
    [[nodiscard]] bool isDue()
    {
        std::lock_guard lock(mutex_);
        const Clock::time_point now = Clock::now();
        if (now - told_ < std::chrono::milliseconds(200)) return false;
        told_ = now;
        return true;
    }

private:
    using Clock = std::chrono::steady_clock;
    std::mutex mutex_;
    Clock::time_point told_ = Clock::now();
};

} // namespace lightloom
