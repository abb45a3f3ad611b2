// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"
#include "core/ivg/irradiance_grid.h"

namespace lightloom {

/// Traces photons a batch at a time, sums each batch in the grid and forgets it; one snapshot.
class IvgSolver final : public Solver {
public:
    Result<Done> bake(const BakeJob& job, BakeProducts& products, BakeControl& control) override;
};

[[nodiscard]] GridShow gridShow(const BakeParams& params);

/// Error out of memory if the grid of a job would not fit into this machine beside the segments of a batch.
[[nodiscard]] Result<Done> checkGridFits(const GridLattice& lattice, int groups);

} // namespace lightloom
