// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/compare/cost_model.h"
#include "core/compare/error_model.h"
#include "core/compare/judge.h"
#include "core/field/solver.h"

namespace lightloom {

/// How much a pilot looks at.
struct PilotSize {
    std::uint64_t probes = 150;    ///< points where error is measured, area-uniform, none of those that judge bakes
    int paths = 128;               ///< of the reference, per point; its noise is taken out again
    int photons = 40'000;          ///< per light group, for each of two seeds
    std::vector<int> depths{4, 5}; ///< of the octree; unused for methods without
};

/// What a pilot found.
struct PilotFindings {
    std::vector<ErrorSample> errors;
    CostModel costs;
    Judge judge;           ///< its mean is that of all photons over all of the surface: steadier than few points have
    double cpuSeconds = 0; ///< of the pilot itself, without what a bake finds and keeps (rays, reach, octrees)
};

/// Bakes small parts of a job to learn what whole bakes will cost and how far off they will be: photons of two seeds,
/// then densities at few probe points with several K, and octrees of only those leaves that the probes read, all from
/// the same photons. Octrees and the scene's products stay in `products` for the bake that follows; the reference is
/// looked for and kept in `store`. Errors: a scene without indirect light; cancelled.
[[nodiscard]] Result<PilotFindings> runPilot(const BakeJob& job, Method method, const PilotSize& size,
                                             const ReferenceStore& store, BakeProducts& products, BakeControl& control);

} // namespace lightloom
