// SPDX-License-Identifier: Apache-2.0
#include "core/compare/sweep_effort.h"
#include <cmath>

namespace lightloom {
namespace {

// one core's work: docs/measurements.md, hot loops
constexpr double kSecondsPerPhoton = 0.7e-6, kSecondsPerGather = 4e-6, kSecondsPerGathered = 0.05e-6;
constexpr double kEntriesPerCell =
    6.0; // leaves go by the surface: six faces of 4^depth, entries and furniture evened out
constexpr double kSecondsPerDeposit = 1.0e-6, kSecondsPerVertex = 3e-6;     // grids, by photon and by vertex
constexpr double kSecondsPerPartner = 25e-9, kSecondsPerShadowRay = 0.5e-6; // voxels, by entry and direction; ray
constexpr double kOverhead = 0.02;                                          // looking up the probes

} // namespace

double SweepEffort::units(const BakeParams& row, const BakeParams* before) const
{
    const auto from = before ? firstDifference(*before, row, method_) : Stage::shoot;
    double perGroup = 0;
    if (method_ == Method::voxelLightcuts) {
        const double entries = kEntriesPerCell * row.voxelSize * row.voxelSize;
        if (from && *from <= Stage::fit)
            perGroup = entries * (kSecondsPerShadowRay * row.voxelSamples + kSecondsPerPartner * row.voxelDirections);
        return 2.0 * groups_ * perGroup + kOverhead;
    }
    if (from && *from == Stage::shoot) perGroup += kSecondsPerPhoton * row.photonCount;
    if (from && *from <= Stage::fit && method_ == Method::irradianceGrid) {
        const double side = row.gridSize > 0 ? row.gridSize : BakeParams{}.gridSize;
        perGroup += kSecondsPerDeposit * row.photonCount + kSecondsPerVertex * std::pow(side, 3.0);
    } else if (from && *from <= Stage::fit) {
        double entries = 0;
        for (int d = row.octreeFirstDepth; d <= row.octreeDepth; ++d) entries += kEntriesPerCell * std::pow(4.0, d);
        perGroup += entries * (kSecondsPerGather + kSecondsPerGathered * row.gatherCount);
    }
    return 2.0 * groups_ * perGroup + kOverhead;
}

double SweepEffort::seconds(const BakeParams& row, const BakeParams* before) const
{
    const double rate = unitsDone_ > 0 ? secondsDone_ / unitsDone_ : 1.0;
    return rate * units(row, before);
}

void SweepEffort::learn(const BakeParams& row, const BakeParams* before, double seconds)
{
    unitsDone_ += units(row, before);
    secondsDone_ += seconds;
}

} // namespace lightloom
