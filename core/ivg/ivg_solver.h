// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"
#include "core/ivg/irradiance_grid.h"

namespace lightloom {

/// Traces photons a batch at a time, sums each batch in the grid, and keeps its ways for grids of other sizes as far as
/// `grid.paths` allows. For jobs with `roughFirst` the light so far is published whenever there are twice as many
/// photons. Then fills the finer grid inside, if there is to be one. What is published last does not depend on what
/// was published before, nor on what was kept.
class IvgSolver final : public Solver {
public:
    Result<Done> bake(const BakeJob& job, BakeProducts& products, BakeControl& control) override;
};

[[nodiscard]] GridShow gridShow(const BakeParams& params);

/// `params` with the numbers that it leaves to the scene: cells for `grid.size=0`, photons for `grid.noise`. Kept in
/// `products`, so that a bake of the same job does not look again. Error: cancelled, or out of memory.
[[nodiscard]] Result<BakeParams> settledGridParams(const BakeJob& job, const SceneProducts& scene,
                                                   BakeProducts& products, BakeControl& control);

} // namespace lightloom
