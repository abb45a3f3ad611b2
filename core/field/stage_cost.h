// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/bake_control.h"
#include <string>
#include <vector>

namespace lightloom {

/// What one stage of a bake cost.
struct StageCost {
    std::string stage;   ///< "rays", "reach", "shoot", "tree", "octree d4", "gather d4", ...
    double wallMs = 0;   ///< by the clock on the wall, pauses left out
    double cpuMs = 0;    ///< summed over all threads that worked on it
    bool isKept = false; ///< paid by an earlier bake, whose product this one found and used
};

/// Adds `cost` to the stage of the same name and kind, or as a new last one.
void addCost(std::vector<StageCost>& stages, const StageCost& cost);

/// Sums over all stages; what was kept counts too, so that the sum is what the bake would cost alone.
[[nodiscard]] double allWallSeconds(const std::vector<StageCost>& stages);
[[nodiscard]] double allCpuSeconds(const std::vector<StageCost>& stages);

/// Whose CPU time a stage is charged with.
enum class CpuClock {
    worker, ///< this thread, and the pool on its behalf (`threadWorkSeconds`); others that run meanwhile do not count
    process ///< all threads of the program: for Embree's builds, which run on threads of Embree's own
};

/// Measures a stage from construction to `stop`.
class StageClock {
public:
    StageClock(std::string stage, const BakeControl& control, CpuClock clock = CpuClock::worker);
    [[nodiscard]] StageCost stop() const; ///< on the thread that made it

private:
    [[nodiscard]] double cpuSeconds() const;
    std::string stage_;
    const BakeControl& control_;
    CpuClock clock_;
    double beganMs_, cpuBegan_;
};

} // namespace lightloom
