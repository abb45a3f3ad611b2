// SPDX-License-Identifier: Apache-2.0
#include "core/base/parallel.h"
#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <immintrin.h>
#include <mutex>
#include <thread>
#include <time.h>
#include <vector>

namespace lightloom {

FlushDenormals::FlushDenormals() : saved_(_mm_getcsr())
{
    _mm_setcsr(saved_ | 0x8040u); // FTZ | DAZ
}
FlushDenormals::~FlushDenormals() { _mm_setcsr(saved_); }

namespace {

double secondsOf(clockid_t clock)
{
    timespec now{};
    clock_gettime(clock, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

thread_local double helpedSeconds = 0.0; ///< what pool threads have worked for this one

/// One call of `run`, shared by the threads that work on it.
struct Task {
    Task(std::size_t count, const std::stop_token& token, const std::function<void(std::size_t)>& call)
        : blocks(count), stop(token), body(call)
    {
    }
    std::size_t blocks;
    const std::stop_token& stop;
    const std::function<void(std::size_t)>& body;
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed{false};
    std::atomic<std::size_t> ended{0};
    double helpedSeconds = 0.0; // of the pool's threads; guarded by the pool's mutex
    std::exception_ptr failure;
    std::mutex failureLock;

    void work()
    {
        while (!failed.load(std::memory_order_relaxed) && !stop.stop_requested()) {
            const std::size_t block = next.fetch_add(1);
            if (block >= blocks) return;
            try {
                body(block);
                ended.fetch_add(1);
            } catch (...) {
                std::lock_guard lock(failureLock);
                if (!failure) failure = std::current_exception();
                failed = true;
            }
        }
    }
};
} // namespace

struct Workers::State {
    std::mutex turn;  // one `run` at a time
    std::mutex mutex; // guards what follows
    std::condition_variable wake, idle;
    Task* task = nullptr;
    std::uint64_t serial = 0; // rises with each task, so that no thread joins one twice
    int working = 0;
    bool quit = false;
    std::vector<std::thread> threads;

    void loop()
    {
        const FlushDenormals flush;
        std::uint64_t seen = 0;
        std::unique_lock lock(mutex);
        while (true) {
            wake.wait(lock, [&] { return quit || (task && serial != seen); });
            if (quit) return;
            seen = serial;
            Task* mine = task;
            ++working;
            lock.unlock();
            const double began = secondsOf(CLOCK_THREAD_CPUTIME_ID);
            mine->work();
            const double worked = secondsOf(CLOCK_THREAD_CPUTIME_ID) - began;
            lock.lock();
            mine->helpedSeconds += worked;
            if (--working == 0) idle.notify_all();
        }
    }
};

Workers::Workers(int threads) : state_(std::make_unique<State>())
{
    if (threads <= 0) threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    for (int i = 1; i < threads; ++i) state_->threads.emplace_back([state = state_.get()] { state->loop(); });
}

Workers::~Workers()
{
    {
        std::lock_guard lock(state_->mutex);
        state_->quit = true;
    }
    state_->wake.notify_all();
    for (std::thread& thread : state_->threads) thread.join();
}

double threadWorkSeconds() { return secondsOf(CLOCK_THREAD_CPUTIME_ID) + helpedSeconds; }

double processCpuSeconds() { return secondsOf(CLOCK_PROCESS_CPUTIME_ID); }

int Workers::threadCount() const { return static_cast<int>(state_->threads.size()) + 1; }

bool Workers::run(std::size_t blocks, const std::stop_token& stop, const std::function<void(std::size_t)>& body)
{
    std::lock_guard turn(state_->turn);
    Task task(blocks, stop, body);
    if (blocks > 1 && !state_->threads.empty()) {
        std::lock_guard lock(state_->mutex);
        state_->task = &task;
        ++state_->serial;
        state_->wake.notify_all();
    }
    {
        const FlushDenormals flush;
        task.work();
    }
    {
        std::unique_lock lock(state_->mutex);
        state_->task = nullptr; // latecomers stay asleep
        state_->idle.wait(lock, [&] { return state_->working == 0; });
        helpedSeconds += task.helpedSeconds;
    }
    if (task.failure) std::rethrow_exception(task.failure);
    return task.ended == blocks;
}

} // namespace lightloom
