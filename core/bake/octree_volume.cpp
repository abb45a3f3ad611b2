// SPDX-License-Identifier: Apache-2.0
#include "core/bake/octree_volume.h"
#include "core/bake/volume_file.h"
#include "core/base/units.h"
#include "core/octree/detail_union.h"
#include "core/trace/cell_clip.h"
#include <fmt/format.h>

namespace lightloom {
namespace {

/// What each leaf shows of its entries.
struct Leaves {
    std::vector<glm::ivec3> cells;
    std::vector<std::uint32_t> largest; ///< entry
    std::vector<glm::vec3> irradiance;
    std::vector<float> illuminance, area;
};

/// Of the octree's own depth (level 0), or of a deeper level.
const OctreeGeometry& geometryAt(const LightOctree& octree, std::size_t level)
{
    return level == 0 ? octree.geometry() : octree.deeper()[level - 1].geometry;
}

Leaves leavesOf(const LightOctree& octree, std::size_t level)
{
    const OctreeGeometry& geometry = geometryAt(octree, level);
    std::vector<glm::vec3> lux; // of each entry on its own surface, all lamps under the mix
    for (std::size_t e = 0; e < geometry.entries.size(); ++e) lux.push_back(octree.mixedColour({e, level}));
    Leaves leaves;
    for (std::size_t i = 0; i < geometry.cells.size(); ++i) {
        glm::dvec3 sum(0.0);
        double area = 0.0;
        std::uint32_t largest = geometry.firstEntry[i];
        for (std::uint32_t e = geometry.firstEntry[i]; e < geometry.firstEntry[i + 1]; ++e) {
            const OctreeEntry& entry = geometry.entries[e];
            sum += glm::dvec3(lux[e]) * double(entry.area);
            area += double(entry.area);
            if (entry.area > geometry.entries[largest].area) largest = e;
        }
        const glm::vec3 mean = area > 0.0 ? glm::vec3(sum / area) : lux[largest];
        leaves.cells.emplace_back(mortonCell(geometry.cells[i]));
        leaves.largest.push_back(largest);
        leaves.irradiance.push_back(mean);
        leaves.illuminance.push_back(luminance(mean));
        leaves.area.push_back(static_cast<float>(area));
    }
    return leaves;
}

/// The grids of one level; those of deeper leaves have their depth in their names.
void addLevel(const LightOctree& octree, std::size_t level, const Scene& scene, VdbFile& file)
{
    const OctreeGeometry& geometry = geometryAt(octree, level);
    const VdbFile::Lattice lattice{scene.toFile(geometry.lowest), glm::dvec3(double(geometry.cellSize()))};
    const Leaves leaves = leavesOf(octree, level);
    const std::string suffix = level == 0 ? "" : fmt::format("_depth{}", geometry.depth);
    const auto add = [&](const std::string& name, const auto& values) {
        file.add(name + suffix, lattice, leaves.cells, std::span(values));
    };
    add("irradiance", leaves.irradiance);
    add("illuminance", leaves.illuminance);
    add("area", leaves.area);

    int most = 1;
    for (const auto& layer : octree.layers()) most = layer ? std::max(most, layer->count) : most;
    std::vector<glm::vec3> normals;
    std::vector<std::vector<glm::vec3>> colours(static_cast<std::size_t>(most)), directions(colours);
    for (const std::uint32_t e : leaves.largest) {
        normals.push_back(geometry.entries[e].normal);
        std::vector<Vdl> vdls = octree.mixed({e, level}, most);
        vdls.resize(static_cast<std::size_t>(most));
        for (std::size_t j = 0; j < vdls.size(); ++j) {
            colours[j].push_back(vdls[j].colour);
            directions[j].push_back(vdls[j].toLight);
        }
    }
    add("normal", normals);
    for (std::size_t j = 0; j < colours.size(); ++j) {
        add(fmt::format("vdl{}_colour", j), colours[j]);
        add(fmt::format("vdl{}_direction", j), directions[j]);
    }
}

} // namespace

Result<std::vector<std::uint8_t>> octreeVolume(const LightOctree& octree, const BakeInfo& info, const Scene& scene)
{
    return volumeBytes(info, [&](VdbFile& file) {
        for (std::size_t level = 0; level <= octree.deeper().size(); ++level) addLevel(octree, level, scene, file);
    });
}

} // namespace lightloom
