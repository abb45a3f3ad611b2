// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <stop_token>

namespace lightloom {

/// A fixed set of threads that run numbered blocks. Every thread (the caller's too, while it works here) has
/// denormals flushed, as Embree wants. Which thread runs which block is not fixed: results must depend on the block's
/// number alone, then they are the same bits on any number of threads.
class Workers {
public:
    /// `threads` 0: one per core. The calling thread counts as one, so 1 starts none.
    explicit Workers(int threads = 0);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    [[nodiscard]] int threadCount() const;

    /// Calls `body(block)` once for each block in [0, blocks), in rising order of start, and returns when all have
    /// ended. After `stop` no further block starts. True if every block ran. The first exception out of a body stops
    /// the rest and is thrown again here. Any thread may call; calls from several threads take turns. A body must not
    /// call `run` of the same object.
    bool run(std::size_t blocks, const std::stop_token& stop, const std::function<void(std::size_t)>& body);

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// CPU-seconds that the calling thread has worked, and pool threads on its behalf in `Workers::run`. Differences are
/// what a piece of work cost, whatever else the program does meanwhile. Embree's own threads are not in it.
[[nodiscard]] double threadWorkSeconds();

/// CPU-seconds of all threads of the program so far.
[[nodiscard]] double processCpuSeconds();

/// Sets flush-to-zero and denormals-are-zero on this thread while it lives, as Embree wants it.
class FlushDenormals {
public:
    FlushDenormals();
    ~FlushDenormals();
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
    unsigned saved_;
};

} // namespace lightloom
