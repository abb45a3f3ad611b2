// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include "core/photonmap/screen_finder.h"

namespace lightloom {

/// Finds the screens of all entries, for kernels of up to kScreenReach. Entries whose centroid is buried in a solid
/// (triangles count as reached to a little beyond the foot of a wall) move to what is seen of their surface; those of
/// which nothing is seen go. An entry whose surface a wall parts becomes one for each part; those near such a wall know
/// their side of it (OctreeEntry::side). False: stopped, do not use.
[[nodiscard]] bool findScreens(OctreeGeometry& geometry, const ScreenFinder& finder, Workers& workers,
                               const std::stop_token& stop);
inline constexpr float kScreenReach = 0.2f; ///< of the lattice; kernels reach further with a few thousand photons only

} // namespace lightloom
