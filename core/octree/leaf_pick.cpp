// SPDX-License-Identifier: Apache-2.0
#include "core/octree/leaf_pick.h"
#include "core/octree/detail_union.h"
#include "core/octree/layer_fit.h"
#include "core/octree/octree_blend.h"
#include "core/trace/cell_clip.h"
#include <algorithm>

namespace lightloom {
namespace {

constexpr float kAside = 0.01f; ///< cells; surfaces lie on the faces of cells, where rounding decides

/// The leaf at the point, just behind or just before it, or -1.
std::int64_t leafNear(const OctreeGeometry& geometry, glm::vec3 p, glm::vec3 n)
{
    for (const float aside : {0.0f, -kAside, kAside}) {
        const glm::vec3 at = (p - geometry.lowest) / geometry.cellSize() + aside * n;
        if (!(glm::length(at) < 4e6f)) return -1;
        const std::int64_t leaf = geometry.leafAt(glm::ivec3(glm::floor(at)));
        if (leaf >= 0) return leaf;
    }
    return -1;
}

/// Number of the entry among those of its leaf, or -1.
int answering(const OctreeGeometry& geometry, std::int64_t leaf, const LeafPick& pick)
{
    const glm::vec3 fromMiddle = (pick.point - 0.5f * (pick.low + pick.high)) / geometry.cellSize();
    const std::int64_t entry = entryFor(geometry, leaf, pick.normal, fromMiddle).entry;
    return entry < 0 ? -1 : static_cast<int>(entry - geometry.firstEntry[static_cast<std::size_t>(leaf)]);
}

} // namespace

std::optional<LeafPick> pickLeaf(const LightOctree& octree, glm::vec3 p, glm::vec3 n)
{
    std::size_t level = octree.deeper().size();
    const auto leaves = [&]() -> const OctreeGeometry& {
        return level == 0 ? octree.geometry() : octree.deeper()[level - 1].geometry;
    };
    std::int64_t found = leafNear(leaves(), p, n); // the deepest of any lamp
    while (found < 0 && level > 0) {
        --level;
        found = leafNear(leaves(), p, n);
    }
    if (found < 0) return std::nullopt;
    const OctreeGeometry& geometry = leaves();
    const auto leaf = static_cast<std::size_t>(found);
    LeafPick pick;
    pick.point = p;
    pick.normal = n;
    pick.depth = geometry.depth;
    pick.cell = glm::ivec3(mortonCell(geometry.cells[leaf]));
    pick.low = geometry.lowest + glm::vec3(pick.cell) * geometry.cellSize();
    pick.high = pick.low + geometry.cellSize();
    int most = 1;
    for (const auto& layer : octree.layers()) most = layer ? std::max(most, layer->count) : most;
    for (std::uint32_t e = geometry.firstEntry[leaf]; e < geometry.firstEntry[leaf + 1]; ++e) {
        if (octree.show() == OctreeShow::colour || octree.flatShare() > 0.0f) { // voxels
            pick.entries.push_back({geometry.entries[e], {}, octree.mixedColour({e, level})});
            continue;
        }
        PickedEntry entry{geometry.entries[e], octree.mixed({e, level}, most), glm::vec3(0.0f)};
        std::erase_if(entry.lights, [](const Vdl& vdl) { return vdl.colour == glm::vec3(0.0f); });
        for (const Vdl& vdl : entry.lights) {
            entry.lux += vdl.colour * glm::max(0.0f, glm::dot(entry.surface.normal, vdl.toLight));
        }
        pick.entries.push_back(std::move(entry));
    }
    pick.answers = answering(geometry, found, pick);
    pick.isLit = octree.lookup(p, n, pick.lux);
    return pick;
}

std::vector<glm::vec3> gatheredPhotons(const LightOctree& octree, const LeafPick& leaf, int entry, const PhotonMap& map,
                                       const SurfaceArea& area, const BakeParams& params)
{
    const OctreeGeometry& whole = octree.geometry();
    int depth = leaf.depth;
    glm::ivec3 cell = leaf.cell;
    const auto own = [&](int d) { // the lamp's leaves of that depth, null where it has none
        const std::size_t level = static_cast<std::size_t>(d - whole.depth);
        for (std::size_t g = 0; level > 0 && g < octree.layers().size(); ++g) {
            if (octree.layers()[g] && octree.layers()[g]->group == map.paths().group)
                return level <= octree.detail(g).size() ? octree.detail(g)[level - 1].geometry.get() : nullptr;
        }
        return level == 0 ? &whole : nullptr;
    };
    while (depth > whole.depth && (!own(depth) || own(depth)->leafAt(cell) < 0)) --depth, cell = cell >> 1;
    // where this lamp's light does not call for a leaf as deep, what stands above
    const OctreeGeometry& from = *own(depth);
    const std::int64_t at = from.leafAt(cell);
    if (at < 0) return {};
    const OctreeEntry& asked = leaf.entries[static_cast<std::size_t>(entry)].surface;
    const glm::vec3 middle = whole.lowest + (glm::vec3(cell) + 0.5f) * from.cellSize();
    const std::int64_t entryThere = entryFor(from, at, asked.normal, (asked.centroid - middle) / from.cellSize()).entry;
    if (entryThere < 0) return {};
    OctreeGeometry alone{depth, whole.lowest, whole.rootSize, {mortonCode(glm::uvec3(cell))}, {0, 1}, {}, {}, {}};
    alone.take(from, static_cast<std::size_t>(entryThere));
    const auto layer = emptyLayer(alone, 0, params);
    FitScratch scratch;
    (void)LayerFit(alone, map, area, params, *layer).fit(0, scratch);
    std::vector<glm::vec3> positions;
    for (const std::uint32_t photon : scratch.gathered.photons) positions.push_back(map.photon(photon).position);
    return positions;
}

} // namespace lightloom
