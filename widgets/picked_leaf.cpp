// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/picked_leaf.h"
#include "core/base/units.h"
#include "core/octree/vdl_cluster.h"
#include "widgets/bake_view.h"

namespace lightloom {

namespace {

constexpr std::size_t kMostDirections = 8; ///< as many as an octree's entry has lights

/// What a cut is made of, as few lights from afar.
std::vector<Vdl> directionsOf(const std::vector<CutLight>& parts, glm::vec3 n)
{
    std::vector<LightVector> lights;
    for (const CutLight& part : parts)
        lights.push_back(
            {part.toLight, part.lux / glm::max(kLeastCosine, glm::dot(n, part.toLight)), luminance(part.lux)});
    std::vector<Vdl> vdls(kMostDirections);
    ClusterScratch scratch;
    fitVdls(lights, n, VdlForm::corrected, vdls, scratch);
    std::erase_if(vdls, [](const Vdl& vdl) { return vdl.colour == glm::vec3(0.0f); });
    return vdls;
}

void addCut(const VoxelCuts& cuts, LeafPick& leaf, PickedVoxel& voxel)
{
    if (cuts.show().lookup == VoxelLookup::samples) {
        voxel.samples = cuts.show().samples;
        voxel.lux = cuts.irradiance(leaf.point, leaf.normal);
        return;
    }
    voxel.cut = cuts.cutAt(leaf.point, leaf.normal);
    voxel.everyLight = cuts.everyLightAt(leaf.point, leaf.normal);
    voxel.lights = cuts.field().surface().leaves->entries.size();
    voxel.asked = cuts.show().cuts;
    if (leaf.answers < 0) return;
    leaf.entries[static_cast<std::size_t>(leaf.answers)].lights =
        directionsOf(cuts.lightsAt(leaf.point, leaf.normal, 1.0f), leaf.normal);
}

void addVoxel(const VoxelField& field, const VoxelCuts* cuts, PickedLeaf& out)
{
    LeafPick& leaf = *out.leaf;
    const VoxelSurface& surface = field.surface();
    PickedVoxel voxel;
    voxel.cells = surface.cells;
    const auto number = static_cast<std::size_t>(surface.leaves->leafAt(leaf.cell));
    for (std::size_t i = 0; i < leaf.entries.size(); ++i) {
        const std::size_t e = surface.leaves->firstEntry[number] + i;
        const glm::vec3 direct = field.direct(e), all = field.illuminance(e);
        voxel.entries.push_back({direct, all - direct, field.exitance(e)});
    }
    if (cuts) addCut(*cuts, leaf, voxel);
    out.voxel = std::move(voxel);
}

void addPhotons(const LightOctree& octree, const BakeView& view, PickedLeaf& out)
{
    if (out.leaf->answers < 0 || !view.photons) return;
    for (const auto& layer : octree.layers()) {
        if (!layer || gainOf(octree.mix(), layer->group) == glm::vec3(0.0f)) continue;
        const auto& map = view.photons->layers()[static_cast<std::size_t>(layer->group)].map;
        if (!map) continue;
        const std::vector<glm::vec3> some =
            gatheredPhotons(octree, *out.leaf, out.leaf->answers, *map, *view.photons->area(), view.params);
        out.photons.insert(out.photons.end(), some.begin(), some.end());
    }
}

PickedGrid pickedGrid(const IrradianceGrid& whole, glm::vec3 p, glm::vec3 n)
{
    PickedGrid out;
    out.point = p, out.normal = n;
    out.isInside = whole.inside().grid && whole.inside().weight(p) > 0.5f;
    const IrradianceGrid& grid = out.isInside ? *whole.inside().grid : whole;
    out.lattice = grid.geometry().lattice;
    out.isLit = whole.lookup(p, n, out.lux);
    out.noise = whole.noise(p, n).value_or(-1.0f);
    GridCorners corners;
    if (out.isLit && grid.findCorners(p, n, corners)) {
        for (const GridCorner& corner : corners)
            if (corner.weight > 0.0f) out.vertices.push_back(out.lattice.position(out.lattice.vertex(corner.vertex)));
    }
    for (int i = 0; i < 6; ++i) { // in mid-air, as far before the surface as it is asked for itself
        glm::vec3 facing(0.0f);
        facing[i / 2] = i % 2 == 0 ? -1.0f : 1.0f;
        const float before = grid.show().offset *
                             glm::min(out.lattice.cellSize.x, glm::min(out.lattice.cellSize.y, out.lattice.cellSize.z));
        if (!whole.lookup(p + before * n, facing, out.around[static_cast<std::size_t>(i)]))
            out.around[static_cast<std::size_t>(i)] = glm::vec3(0.0f);
    }
    return out;
}

} // namespace

PickedLeaf pickedLeaf(const BakeView& view, glm::vec3 p, glm::vec3 n)
{
    PickedLeaf out;
    out.field = view.snapshot.field;
    const IndirectField* field = view.snapshot.field.get();
    if (const auto* grid = dynamic_cast<const IrradianceGrid*>(field)) {
        out.grid = pickedGrid(*grid, p, n);
        return out;
    }
    const auto* octree = dynamic_cast<const LightOctree*>(field);
    const auto* cuts = dynamic_cast<const VoxelCuts*>(field);
    const auto* voxels = cuts ? &cuts->field() : dynamic_cast<const VoxelField*>(field);
    if (voxels) octree = &voxels->octree();
    if (!octree) return out;
    out.leaf = pickLeaf(*octree, p, n);
    if (!out.leaf) return out;
    if (voxels) {
        addVoxel(*voxels, cuts, out);
    } else {
        addPhotons(*octree, view, out);
    }
    return out;
}

} // namespace lightloom
