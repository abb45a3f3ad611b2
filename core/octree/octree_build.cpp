// SPDX-License-Identifier: Apache-2.0
#include "core/octree/octree_build.h"

namespace lightloom {
namespace {

std::shared_ptr<OctreeGeometry> build(const CellLattice& lattice, const std::optional<CellsWithin>& within,
                                      const LightReach& reach, Workers& workers, const std::stop_token& stop)
{
    const CellPieces clipped = clipToCells(reach.facets(), lattice, workers, stop, within);
    if (!clipped.complete) return nullptr;
    auto geometry = std::make_shared<OctreeGeometry>();
    geometry->depth = lattice.depth;
    geometry->lowest = lattice.lowest;
    geometry->rootSize = lattice.rootSize;

    CellOrientations orientations(lattice.lowest);
    std::vector<Orientation> ended;
    const std::vector<CellPiece>& pieces = clipped.pieces;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (i % 65'536 == 0 && stop.stop_requested()) return nullptr;
        orientations.add(pieces[i], reach.facets()[pieces[i].facet].normal);
        if (i + 1 < pieces.size() && pieces[i + 1].cell == pieces[i].cell) continue;
        geometry->cells.push_back(pieces[i].cell);
        geometry->firstEntry.push_back(static_cast<std::uint32_t>(geometry->entries.size()));
        ended.clear();
        orientations.finish(ended);
        for (const Orientation& o : ended) geometry->entries.push_back({o.centroid, o.normal, o.area});
    }
    geometry->firstEntry.push_back(static_cast<std::uint32_t>(geometry->entries.size()));
    return geometry;
}

} // namespace

std::shared_ptr<OctreeGeometry> buildOctree(const Bounds& bounds, const LightReach& reach, int depth, float shift,
                                            Workers& workers, const std::stop_token& stop)
{
    return build(latticeOver(bounds, depth, shift), {}, reach, workers, stop);
}

std::shared_ptr<OctreeGeometry> buildLeaves(const CellLattice& lattice, const CellsWithin& within,
                                            const LightReach& reach, Workers& workers, const std::stop_token& stop)
{
    return build(lattice, within, reach, workers, stop);
}

} // namespace lightloom
