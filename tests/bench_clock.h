// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

/// What benches measure with.
namespace lightloom {

using Clock = std::chrono::steady_clock;

inline double msSince(Clock::time_point then)
{
    return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
}

enum class CpuOf { process, thread };

/// Time spent computing so far, by all threads or by the calling one: what work costs, whoever else uses the machine.
inline double cpuSeconds(CpuOf what)
{
    timespec now{};
    clock_gettime(what == CpuOf::process ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Of `values`, not empty; the upper one of two.
inline double median(std::vector<double> values)
{
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

} // namespace lightloom
