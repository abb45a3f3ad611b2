// SPDX-License-Identifier: Apache-2.0
#include "core/field/stage_cost.h"
#include "core/base/parallel.h"
#include <algorithm>

namespace lightloom {

void addCost(std::vector<StageCost>& stages, const StageCost& cost)
{
    const auto same = std::ranges::find_if(
        stages, [&](const StageCost& s) { return s.stage == cost.stage && s.isKept == cost.isKept; });
    if (same == stages.end()) {
        stages.push_back(cost);
        return;
    }
    same->wallMs += cost.wallMs;
    same->cpuMs += cost.cpuMs;
}

double allWallSeconds(const std::vector<StageCost>& stages)
{
    double sum = 0;
    for (const StageCost& s : stages) sum += s.wallMs;
    return sum / 1000.0;
}

double allCpuSeconds(const std::vector<StageCost>& stages)
{
    double sum = 0;
    for (const StageCost& s : stages) sum += s.cpuMs;
    return sum / 1000.0;
}

StageClock::StageClock(std::string stage, const BakeControl& control, CpuClock clock)
    : stage_(std::move(stage)), control_(control), clock_(clock), beganMs_(control.elapsedMs()), cpuBegan_(cpuSeconds())
{
}

double StageClock::cpuSeconds() const { return clock_ == CpuClock::worker ? threadWorkSeconds() : processCpuSeconds(); }

StageCost StageClock::stop() const
{
    return {stage_, control_.elapsedMs() - beganMs_, 1000.0 * (cpuSeconds() - cpuBegan_)};
}

} // namespace lightloom
