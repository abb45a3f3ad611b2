// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/base/statistics.h"
#include "core/trace/caustic_discs.h"
#include "core/trace/caustic_lamps.h"

namespace lightloom {

/// Progressive photon tracing (Hachisuka et al. 2008; memoryless as in Knaus and Zwicker 2011) for the light that
/// CausticLamps names: photons whose first surface mirrors them or lets them through, and all that becomes of these.
/// Every round shoots new photons at smaller discs; the mean over rounds converges, its bias with the discs, its noise
/// with the photons.
struct CausticJob {
    std::uint64_t seed = 1;
    int pathDepth = 1024;
    std::uint64_t photons = 1 << 17; ///< per round
};

/// Disc radius in round `number` (from 0): 1 % of the scene's diagonal, its square falling with the cube root.
[[nodiscard]] float causticRadius(const RayScene& rays, std::uint64_t number);

/// What the rounds so far say of one point. Plain data.
struct CausticSums {
    std::array<RunningMean, 3> illuminance;              ///< lux per channel
    std::array<double, CausticDiscs::kCells> partSums{}; ///< lux, luminance on each part of the disc, over the rounds
    double radiusSum = 0.0;                              ///< metres

    [[nodiscard]] glm::dvec3 mean() const;
    [[nodiscard]] glm::dvec3 standardError() const;
    /// Bound on the blur of the mean (luminance, lux): how far the parts of the disc lie apart. Counts their noise too,
    /// so it is never too small for that. For light that varies no faster than the discs are wide.
    [[nodiscard]] double blurBound() const;
};

/// Shoots the photons of round `number` at `discs`. False: stopped.
[[nodiscard]] bool shootCaustics(const RayScene& rays, const CausticLamps& lamps, const CausticJob& job,
                                 std::uint64_t number, const CausticDiscs& discs, float radius, Workers& workers,
                                 const std::stop_token& stop);

/// Catches at `points` (position, normal; radius is the largest that is clear) for one round, and adds it to `sums`.
/// False: stopped, nothing was added.
[[nodiscard]] bool addCausticRound(const RayScene& rays, const CausticLamps& lamps, const CausticJob& job,
                                   std::uint64_t number, const std::vector<CatchPoint>& points,
                                   std::vector<CausticSums>& sums, Workers& workers, const std::stop_token& stop);

} // namespace lightloom
