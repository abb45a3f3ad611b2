// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

/// Memory of the whole program, as the system sees it.
namespace lightloom {

/// Forgets the peak so far, where the system allows it (Linux). False: the next peak may be an older one.
bool resetPeakMemory();

/// Most bytes of main memory held at once since the last reset, or since the program began; 0 where unknown.
[[nodiscard]] std::uint64_t peakMemoryBytes();

/// Bytes of main memory this machine has.
[[nodiscard]] double machineMemoryBytes();

} // namespace lightloom
