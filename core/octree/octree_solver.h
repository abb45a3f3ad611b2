// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"
#include "core/octree/light_octree.h"

namespace lightloom {

struct PhotonProducts;

/// Photons -> kd-tree -> octree of rising depth -> gather and cluster per entry; each depth is published.
class OctreeSolver final : public Solver {
public:
    Result<Done> bake(const BakeJob& job, BakeProducts& products, BakeControl& control) override;
};

/// What a rough picture (BakeJob::roughFirst) of a bake with `params` is made with: a sixteenth of the photons, the
/// first depth alone.
[[nodiscard]] BakeParams roughParams(BakeParams params);

/// Leaves of one depth for the job's scene and lattice shift, from `products` or built now. Null: stopped.
[[nodiscard]] std::shared_ptr<const OctreeGeometry>
octreeGeometry(const BakeJob& job, const PhotonProducts& at, int depth, BakeProducts& products, BakeControl& control);

} // namespace lightloom
