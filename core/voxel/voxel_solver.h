// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"
#include "core/transport/first_light.h"
#include "core/voxel/voxel_field.h"

namespace lightloom {

/// Surface voxels and lines through them, of a scene as it is reached by light: kept for as long as that does not
/// change, whatever lamps do.
struct VoxelGeometry {
    std::shared_ptr<const SurfaceVoxels> voxels;
    VoxelOrders orders;
    std::shared_ptr<const VoxelSurface> surface;
};

/// Surface voxels -> first light by shadow rays, and by photons where there are mirrors or glass -> bounces along
/// discrete lines, all lamps at once; lamps that are kept from an earlier bake are left out, and get the same light as
/// if all were made anew. For jobs with `roughFirst` a coarse lattice is lit and published before, unless all that
/// lamps do not change is kept and the field is there as soon.
class VoxelSolver final : public Solver {
public:
    Result<Done> bake(const BakeJob& job, BakeProducts& products, BakeControl& control) override;
};

/// What a rough picture of a bake with `params` is made with: at most 24 voxels along a side, 128 directions.
[[nodiscard]] BakeParams roughVoxelParams(BakeParams params);

/// The entries as lookups want them.
[[nodiscard]] std::shared_ptr<const VoxelSurface>
voxelSurface(const SurfaceVoxels& voxels, std::vector<glm::vec3> albedo, std::vector<glm::vec3> matt = {});

} // namespace lightloom
