// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/ivg/irradiance_grid.h"

namespace lightloom {

/// Where a finer grid inside `outer`, with cells `fine` times as small, is worth most: a box of whole cells of `outer`
/// (scene space) with no more vertices than `outer` has. Grown from the vertex near surface where light bends most
/// within a cell beyond its noise, a layer of cells at a time, towards what bends most. Nothing where light does not
/// bend at all. The same grid gives the same box.
[[nodiscard]] std::optional<Bounds> chooseNest(const IrradianceGrid& outer, int fine);

/// The lattice of a finer grid over `box`, with a cell to spare, its planes off the walls as placeGrid's.
[[nodiscard]] GridLattice nestLattice(const RayScene& rays, const GridLattice& outer, const Bounds& box, int fine);

/// How a finer grid is joined to `outer`: over a cell of `outer` inside the box. Faces at or beyond the scene's bounds
/// need no seam; the box is moved out there.
[[nodiscard]] GridInside joinNest(std::shared_ptr<const IrradianceGrid> finer, const Bounds& scene,
                                  const GridLattice& outer, Bounds box);

} // namespace lightloom
