// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include "core/photonmap/photon_map_solver.h"
#include <map>
#include <memory>
#include <openvdb/openvdb.h>
#include <string>

/// What a bake file holds, as OpenVDB grids and back: for the source files of this folder only, as OpenVDB is large.
/// Readers throw where something is missing; bake_file turns that into an Error.
namespace lightloom::vdb {

using Vec3Grid = openvdb::Vec3SGrid;
using FloatGrid = openvdb::FloatGrid;

inline openvdb::Vec3s toVdb(glm::vec3 v) { return {v.x, v.y, v.z}; }
inline glm::vec3 fromVdb(const openvdb::Vec3s& v) { return {v.x(), v.y(), v.z()}; }

/// Grids by name.
class NamedGrids {
public:
    explicit NamedGrids(const openvdb::GridPtrVec& grids)
    {
        for (const auto& grid : grids) grids_[grid->getName()] = grid;
    }
    [[nodiscard]] bool contains(const std::string& name) const { return grids_.contains(name); }
    template<class Grid>
    [[nodiscard]] typename Grid::ConstPtr get(const std::string& name) const
    {
        const auto found = grids_.find(name);
        const auto grid = found == grids_.end() ? nullptr : openvdb::gridConstPtrCast<Grid>(found->second);
        if (!grid) throw std::runtime_error("the grid " + name + " is missing");
        return grid;
    }

private:
    std::map<std::string, openvdb::GridBase::Ptr> grids_;
};

/// A light group's id as part of a grid's name: "/" and control characters as %XX.
[[nodiscard]] std::string escaped(const std::string& id);

[[nodiscard]] openvdb::GridPtrVec octreeGrids(const LightOctree& octree, const Scene& scene, openvdb::MetaMap& meta);
/// `isOn` by light group. The mix is empty.
[[nodiscard]] std::shared_ptr<const LightOctree> readOctree(const NamedGrids& grids, const openvdb::MetaMap& meta,
                                                            const Scene& scene, const std::vector<bool>& isOn,
                                                            VdlForm form);

[[nodiscard]] openvdb::GridPtrVec photonGrids(const PhotonMapField& field, const Scene& scene);
[[nodiscard]] std::shared_ptr<const PhotonPaths> readPhotons(const NamedGrids& grids, const Scene& scene, int group);

} // namespace lightloom::vdb
