// SPDX-License-Identifier: Apache-2.0
#include "core/bake/solver_for.h"
#include "core/ivg/ivg_solver.h"
#include "core/octree/octree_solver.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/voxel/voxel_solver.h"

namespace lightloom {

std::unique_ptr<Solver> solverFor(Method method)
{
    switch (method) {
    case Method::lightOctree:
        return std::make_unique<OctreeSolver>();
    case Method::irradianceGrid:
        return std::make_unique<IvgSolver>();
    case Method::voxelLightcuts:
        return std::make_unique<VoxelSolver>();
    case Method::photonMap:
        return std::make_unique<PhotonMapSolver>();
    case Method::direct:
    case Method::reference:
        break;
    }
    return nullptr;
}

} // namespace lightloom
