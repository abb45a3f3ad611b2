// SPDX-License-Identifier: Apache-2.0
#include "core/bake/bake_grids.h"
#include "core/bake/leaf_grids.h"
#include <fmt/format.h>

namespace lightloom {
namespace {

std::string prefixOf(int depth) { return fmt::format("voxel-lightcuts/d{}/", depth); }
constexpr const char *kDepth = "lightloom.depth", *kCells = "lightloom.voxels", *kAlbedo = "geometry/albedo",
                     *kMatt = "geometry/albedo_matt", *kByRays = "/indirect_by_rays", *kSpecular = "/specular",
                     *kTowards = "/indirect_towards";

std::shared_ptr<const VoxelLayer> readLayer(const VdbFile& file, const LeafReader& leaves, const std::string& group,
                                            int number, bool hasRays, bool hasSpecular)
{
    const std::size_t entries = leaves.geometry()->entries.size();
    std::vector<glm::vec3> direct(entries), indirect(entries);
    leaves.vectors(group + "/direct", [&](std::size_t n, glm::vec3 v) { direct[n] = v; });
    leaves.vectors(group + "/indirect", [&](std::size_t n, glm::vec3 v) { indirect[n] = v; });
    const bool leans = file.contains(leaves.nameOf(group + kTowards, 0)); // older files have none
    std::vector<glm::vec3> towards(leans ? entries : 0);
    if (leans) leaves.vectors(group + kTowards, [&](std::size_t n, glm::vec3 v) { towards[n] = v; });
    std::vector<glm::vec3> byRays(hasRays ? entries : 0);
    if (hasRays) leaves.vectors(group + kByRays, [&](std::size_t n, glm::vec3 v) { byRays[n] = v; });
    std::vector<glm::vec3> specular(hasSpecular ? entries : 0);
    if (hasSpecular) leaves.vectors(group + kSpecular, [&](std::size_t n, glm::vec3 v) { specular[n] = v; });
    return std::make_shared<const VoxelLayer>(
        VoxelLayer{std::move(direct), leaningLayer(number, std::move(indirect), towards, *leaves.geometry()),
                   std::move(byRays), std::move(specular)});
}

} // namespace

void storeVoxels(const VoxelField& field, const Scene& scene, VdbFile& file)
{
    const VoxelSurface& surface = field.surface();
    file.set(kDepth, std::int64_t(surface.leaves->depth));
    file.set(kCells, std::int64_t(surface.cells));
    storeRoot(*surface.leaves, file);
    LeafWriter leaves(*surface.leaves, prefixOf(surface.leaves->depth), scene, file);
    leaves.geometry();
    leaves.values(kAlbedo, [&](std::uint32_t n) { return surface.albedo[n]; });
    if (!surface.matt.empty()) leaves.values(kMatt, [&](std::uint32_t n) { return surface.matt[n]; });
    for (std::size_t g = 0; g < field.layers().size(); ++g) {
        if (!field.layers()[g]) continue;
        const VoxelLayer& layer = *field.layers()[g];
        const std::string group = escaped(scene.groups[g].id);
        leaves.values(group + "/direct", [&](std::uint32_t n) { return layer.direct[n]; });
        leaves.values(group + "/indirect", [&](std::uint32_t n) { return layer.indirect->scalar[n]; });
        if (!layer.indirect->vdls.empty())
            leaves.values(group + kTowards, [&](std::uint32_t n) { return layer.indirect->vdls[n].toLight; });
        if (!layer.specular.empty())
            leaves.values(group + kSpecular, [&](std::uint32_t n) { return layer.specular[n]; });
        if (!layer.byRays.empty()) leaves.values(group + kByRays, [&](std::uint32_t n) { return layer.byRays[n]; });
    }
}

std::shared_ptr<const VoxelField> readVoxels(const VdbFile& file, const Scene& scene, const std::vector<bool>& isOn,
                                             const BakeParams& params)
{
    const bool hasRays = params.voxelRays > 0;
    const int depth = static_cast<int>(file.integer(kDepth));
    const LeafReader leaves(file, depth, prefixOf(depth));
    auto surface = std::make_shared<VoxelSurface>();
    surface->cells = static_cast<int>(file.integer(kCells));
    surface->leaves = leaves.geometry();
    surface->albedo.resize(surface->leaves->entries.size());
    leaves.vectors(kAlbedo, [&](std::size_t n, glm::vec3 v) { surface->albedo[n] = v; });
    const bool hasMatt = file.contains(leaves.nameOf(kMatt, 0));
    if (hasMatt) {
        surface->matt.resize(surface->albedo.size());
        leaves.vectors(kMatt, [&](std::size_t n, glm::vec3 v) { surface->matt[n] = v; });
    }
    const bool hasSpecular = hasMatt && params.voxelPhotons > 0;
    std::vector<std::shared_ptr<const VoxelLayer>> layers;
    for (std::size_t g = 0; g < isOn.size(); ++g) {
        const std::string group = escaped(scene.groups[g].id);
        layers.push_back(isOn[g] ? readLayer(file, leaves, group, static_cast<int>(g), hasRays, hasSpecular) : nullptr);
    }
    return std::make_shared<const VoxelField>(std::move(surface), std::move(layers), Mix{});
}

} // namespace lightloom
