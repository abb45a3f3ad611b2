// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/vdb_file.h"
#include "core/ivg/irradiance_grid.h"
#include "core/octree/light_octree.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/voxel/voxel_field.h"

/// What each method keeps in a bake file (the names of its grids stand in bake_file.h). Readers throw as VdbFile does.
namespace lightloom {

/// A light group's id as part of a grid's name: "/", "%" and control characters as %XX.
[[nodiscard]] std::string escaped(const std::string& id);

void storeOctree(const LightOctree& octree, const Scene& scene, VdbFile& file);
/// `isOn` by light group; the mix is empty.
[[nodiscard]] std::shared_ptr<const LightOctree> readOctree(const VdbFile& file, const Scene& scene,
                                                            const std::vector<bool>& isOn, const BakeParams& params);

void storeGrid(const IrradianceGrid& grid, const Scene& scene, VdbFile& file);
[[nodiscard]] std::shared_ptr<const IrradianceGrid> readGrid(const VdbFile& file, const Scene& scene,
                                                             const std::vector<bool>& isOn, const BakeParams& params);

void storeVoxels(const VoxelField& field, const Scene& scene, VdbFile& file);
[[nodiscard]] std::shared_ptr<const VoxelField> readVoxels(const VdbFile& file, const Scene& scene,
                                                           const std::vector<bool>& isOn, const BakeParams& params);

void storePhotons(const PhotonMapField& field, const Scene& scene, VdbFile& file);
/// Empty where the bake kept none.
[[nodiscard]] ChristensenCache::Values readCache(const VdbFile& file, const Scene& scene, int group);
[[nodiscard]] std::shared_ptr<const PhotonPaths> readPhotons(const VdbFile& file, const Scene& scene, int group);

} // namespace lightloom
