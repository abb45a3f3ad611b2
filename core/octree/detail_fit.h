// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/bake_control.h"
#include "core/octree/light_octree.h"
#include "core/photonmap/photon_map.h"
#include "core/photonmap/screen_finder.h"
#include "core/photonmap/surface_area.h"

namespace lightloom {

/// What the deeper leaves of one light group depend on.
struct DetailJob {
    const OctreeGeometry& base; ///< of depth octree.depth
    const VdlLayer& layer;      ///< of `base`
    const LightReach& reach;
    const ScreenFinder& screens;
    const PhotonMap& map;
    const SurfaceArea& area;
    const BakeParams& params;
};

struct DetailResult {
    std::shared_ptr<const LampDetail> detail; ///< null: stopped
    std::uint64_t fits = 0, degenerate = 0;   ///< children that were fitted, kept or not
};

/// Splits leaves, up to octree.detail levels, where smaller kernels see light that theirs blur. Children are fitted
/// where a neighbour's light differs by more than noise and photons are dense enough for kernels of about a child's
/// size. A leaf is split if its children, taken together with those around, are further from what the octree gives
/// there than their noise explains, by enough to be worth their larger noise; or if a child of it is split. Depends on
/// this group's photons alone; the same bits on any number of threads.
[[nodiscard]] DetailResult fitDetail(const DetailJob& job, BakeControl& control);

} // namespace lightloom
