// SPDX-License-Identifier: Apache-2.0
#include "core/octree/octree_build.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

/// One orientation while its pieces are being added.
struct Gathering {
    glm::dvec3 normal{0.0}, moment{0.0}; // area-weighted sums; `moment` of positions relative to the lattice's corner
    double area = 0.0;
};

class LeafBuilder {
public:
    LeafBuilder(const std::vector<ReachedFacet>& facets, glm::vec3 lowest, OctreeGeometry& out)
        : facets_(facets), lowest_(lowest), out_(out)
    {
    }

    void add(const CellPiece& piece)
    {
        const glm::vec3 n = facets_[piece.facet].normal;
        Gathering& to = bestFor(n);
        const double area = static_cast<double>(piece.area);
        to.normal += area * glm::dvec3(n);
        to.moment += area * (glm::dvec3(piece.centroid) - glm::dvec3(lowest_));
        to.area += area;
    }

    void finish(std::uint64_t cell)
    {
        std::ranges::stable_sort(open_, [](const Gathering& a, const Gathering& b) { return a.area > b.area; });
        out_.cells.push_back(cell);
        out_.firstEntry.push_back(static_cast<std::uint32_t>(out_.entries.size()));
        for (const Gathering& g : open_) {
            const glm::dvec3 centroid = glm::dvec3(lowest_) + g.moment / g.area;
            out_.entries.push_back(
                {glm::vec3(centroid), glm::vec3(glm::normalize(g.normal)), static_cast<float>(g.area)});
        }
        open_.clear();
    }

private:
    Gathering& bestFor(glm::vec3 n)
    {
        Gathering* best = nullptr;
        double bestCosine = -2.0;
        for (Gathering& g : open_) {
            // sums within 53 degrees of their mean never cancel: the length is positive
            const double cosine = glm::dot(glm::normalize(g.normal), glm::dvec3(n));
            if (cosine > bestCosine) bestCosine = cosine, best = &g;
        }
        const bool joins =
            best && (bestCosine >= static_cast<double>(kSameOrientation) || open_.size() >= kMostEntries);
        if (joins) return *best;
        return open_.emplace_back();
    }

    const std::vector<ReachedFacet>& facets_;
    glm::vec3 lowest_;
    OctreeGeometry& out_;
    std::vector<Gathering> open_;
};

std::shared_ptr<OctreeGeometry> build(const CellLattice& lattice, const std::optional<CellsWithin>& within,
                                      const LightReach& reach, Workers& workers, const std::stop_token& stop)
{
    const CellPieces clipped = clipToCells(reach.facets(), lattice, workers, stop, within);
    if (!clipped.complete) return nullptr;
    auto geometry = std::make_shared<OctreeGeometry>();
    geometry->depth = lattice.depth;
    geometry->lowest = lattice.lowest;
    geometry->rootSize = lattice.rootSize;

    LeafBuilder builder(reach.facets(), lattice.lowest, *geometry);
    const std::vector<CellPiece>& pieces = clipped.pieces;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (i % 65'536 == 0 && stop.stop_requested()) return nullptr;
        builder.add(pieces[i]);
        if (i + 1 == pieces.size() || pieces[i + 1].cell != pieces[i].cell) builder.finish(pieces[i].cell);
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
