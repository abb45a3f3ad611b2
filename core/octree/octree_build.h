// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include "core/trace/cell_orientations.h"
#include "core/trace/light_reach.h"

namespace lightloom {

/// Leaves of depth `depth` with one entry per orientation of the surface inside each (pieces within 53 degrees of an
/// entry's mean normal join it). Entries of a leaf are ordered by area, largest first. Null: stopped.
[[nodiscard]] std::shared_ptr<OctreeGeometry> buildOctree(const Bounds& bounds, const LightReach& reach, int depth,
                                                          float shift, Workers& workers, const std::stop_token& stop);

/// The same on any lattice, of the surface within some cells of a coarser depth of it only.
[[nodiscard]] std::shared_ptr<OctreeGeometry> buildLeaves(const CellLattice& lattice, const CellsWithin& within,
                                                          const LightReach& reach, Workers& workers,
                                                          const std::stop_token& stop);

inline constexpr std::size_t kMostEntries = kMostOrientations; ///< per leaf (a texel has room)

} // namespace lightloom
