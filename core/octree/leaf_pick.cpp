// SPDX-License-Identifier: Apache-2.0
#include "core/octree/leaf_pick.h"
#include "core/octree/layer_fit.h"
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

int answering(const std::vector<PickedEntry>& entries, glm::vec3 n)
{
    int best = -1;
    float bestCosine = kCompatibleCosine;
    for (std::size_t e = 0; e < entries.size(); ++e) {
        const float cosine = glm::dot(entries[e].surface.normal, n);
        if (cosine > bestCosine) bestCosine = cosine, best = static_cast<int>(e);
    }
    return best;
}

} // namespace

std::optional<LeafPick> pickLeaf(const LightOctree& octree, glm::vec3 p, glm::vec3 n)
{
    const OctreeGeometry& geometry = octree.geometry();
    const std::int64_t found = leafNear(geometry, p, n);
    if (found < 0) return std::nullopt;
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
        PickedEntry entry{geometry.entries[e], octree.mixed(e, most), glm::vec3(0.0f)};
        std::erase_if(entry.lights, [](const Vdl& vdl) { return vdl.colour == glm::vec3(0.0f); });
        for (const Vdl& vdl : entry.lights) {
            entry.lux += vdl.colour * glm::max(0.0f, glm::dot(entry.surface.normal, vdl.toLight));
        }
        pick.entries.push_back(std::move(entry));
    }
    pick.answers = answering(pick.entries, n);
    pick.isLit = octree.lookup(p, n, pick.lux);
    return pick;
}

std::vector<glm::vec3> gatheredPhotons(const LightOctree& octree, const LeafPick& leaf, int entry, const PhotonMap& map,
                                       const SurfaceArea& area, const BakeParams& params)
{
    const OctreeGeometry& whole = octree.geometry();
    OctreeGeometry alone{whole.depth, whole.lowest, whole.rootSize, {mortonCode(glm::uvec3(leaf.cell))}, {0, 1}, {}};
    alone.entries.push_back(leaf.entries[static_cast<std::size_t>(entry)].surface);
    const auto layer = emptyLayer(alone, 0, params);
    FitScratch scratch;
    (void)LayerFit(alone, map, area, params, *layer).fit(0, scratch);
    std::vector<glm::vec3> positions;
    for (const std::uint32_t photon : scratch.gathered.photons) positions.push_back(map.photon(photon).position);
    return positions;
}

} // namespace lightloom
