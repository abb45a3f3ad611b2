// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"
#include "core/ivg/grid_memory.h"

namespace lightloom {

/// What a scene calls for.
struct GridAdvice {
    int size = 0;             ///< cells along the longest side, a multiple of 4
    float wallSpacing = 0.0f; ///< metres: a tenth of the surface that light reaches has something nearer before it
    bool isCut = false;       ///< walls called for more cells than memory, or grid.size, allows
};

/// A cell is a sixth of the wall spacing, so that there are some vertices between walls that stand off both; from 16 to
/// 128 cells, and no more than fit into a gibibyte beside what `memory` says.
[[nodiscard]] GridAdvice adviseGridSize(const SceneProducts& scene, const GridMemoryJob& memory, float shift);

/// Walls thinner than this many cells let light through: where vertices see along axes, a tenth; where filters reach
/// over 64 vertices, two.
[[nodiscard]] float leastWallCells(GridFilter filter);

/// Photons per light group that bring the noise of a grid, as it is stated at points of reached surface, to `wanted`
/// (a fraction of the mean light), from grids of `pilotPhotons`, not smoothed and as it will be. At least as many as
/// the pilots', at most 10^9. Without smoothing noise falls with the root of photons; with it slower, since more
/// photons are smoothed less: how much less follows at each point from what smoothing took there.
[[nodiscard]] std::uint64_t photonsForNoise(const IrradianceGrid& raw, const IrradianceGrid& pilot,
                                            std::uint64_t pilotPhotons, std::span<const SurfacePoint> points,
                                            double wanted);

} // namespace lightloom
