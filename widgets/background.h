// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

/// Threads that leave the processor to others.
namespace lightloom {

/// How much threads give way, as the system counts it (nice); the window's own thread is at 0.
inline constexpr int kBakeNice = 10, kCompareNice = 15, kSweepNice = 19;

/// Gives the calling thread, and threads it starts from now on, a lower priority for good (Linux; elsewhere nothing).
void lowerPriority(int nice);

} // namespace lightloom
