// SPDX-License-Identifier: Apache-2.0
#include "core/transport/surface_voxels.h"
#include <algorithm>
#include <bit>
#include <cassert>

namespace lightloom {
namespace {

/// Takes in the pieces of one voxel after the other.
class VoxelBuilder {
public:
    VoxelBuilder(const std::vector<ReachedFacet>& facets, SurfaceVoxels& out)
        : facets_(facets), orientations_(out.lattice.lowest), out_(out)
    {
    }

    void add(std::span<const CellPiece> pieces)
    {
        numbers_.clear();
        for (const CellPiece& piece : pieces) numbers_.push_back(orientations_.add(piece, facets_[piece.facet].normal));
        out_.voxels.emplace_back(mortonCell(pieces.front().cell));
        out_.firstEntry.push_back(static_cast<std::uint32_t>(out_.entries.size()));
        for (const std::size_t orientation : orientations_.finish(out_.entries)) {
            out_.firstPiece.push_back(static_cast<std::uint32_t>(out_.pieces.size()));
            for (std::size_t i = 0; i < pieces.size(); ++i)
                if (numbers_[i] == orientation) out_.pieces.push_back(pieces[i]);
        }
    }

    void finish()
    {
        out_.firstEntry.push_back(static_cast<std::uint32_t>(out_.entries.size()));
        out_.firstPiece.push_back(static_cast<std::uint32_t>(out_.pieces.size()));
    }

private:
    const std::vector<ReachedFacet>& facets_;
    CellOrientations orientations_;
    SurfaceVoxels& out_;
    std::vector<std::size_t> numbers_; // of the pieces' orientations
};

/// How far surface is moved out of itself, in cells: a wall in a plane between cells then lies in those before it, as
/// the walls do that it meets. Else light from its corners would not find these.
constexpr float kMovedOut = 1e-3f;

std::vector<ReachedFacet> movedOut(std::vector<ReachedFacet> facets, float cell)
{
    for (ReachedFacet& f : facets) {
        const glm::vec3 way = kMovedOut * cell * f.normal;
        f.a += way, f.b += way, f.c += way;
    }
    return facets;
}

} // namespace

CellLattice voxelLattice(const Bounds& bounds, int cells, float shift)
{
    assert(cells >= 1 && cells <= kMostVoxels);
    const float padded = glm::max(bounds.longestSide(), 1e-30f) * 1.002f, count = static_cast<float>(cells);
    float size = padded / count;
    if (shift > 0.0f) size = cells > 1 ? padded / (count - 1.0f) : 2.0f * padded;
    CellLattice lattice;
    lattice.depth = std::bit_width(static_cast<unsigned>(cells - 1));
    lattice.rootSize = size * static_cast<float>(1u << lattice.depth);
    lattice.lowest = bounds.centre() - glm::vec3(0.5f * padded + shift * size);
    return lattice;
}

std::size_t SurfaceVoxels::voxelAt(glm::vec3 p, glm::vec3 normal) const
{
    const glm::vec3 place = (p - lattice.lowest) / cellSize() + kMovedOut * normal;
    const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(place)), 0, cells - 1);
    const std::uint64_t code = mortonCode(glm::uvec3(cell));
    const auto codeOf = [](glm::ivec3 voxel) { return mortonCode(glm::uvec3(voxel)); };
    const auto found = std::ranges::lower_bound(voxels, code, {}, codeOf);
    const bool isThere = found != voxels.end() && *found == cell;
    return isThere ? static_cast<std::size_t>(found - voxels.begin()) : voxels.size();
}

std::size_t SurfaceVoxels::memoryBytes() const
{
    return voxels.size() * sizeof(glm::ivec3) + entries.size() * sizeof(Orientation) +
           pieces.size() * sizeof(CellPiece) + (firstEntry.size() + firstPiece.size()) * sizeof(std::uint32_t);
}

std::shared_ptr<const SurfaceVoxels> voxelise(const Bounds& bounds, const LightReach& reach, int cells, float shift,
                                              Workers& workers, const std::stop_token& stop)
{
    const auto out = std::make_shared<SurfaceVoxels>();
    out->lattice = voxelLattice(bounds, cells, shift);
    out->cells = cells;
    const CellPieces clipped = clipToCells(movedOut(reach.facets(), out->cellSize()), out->lattice, workers, stop);
    if (!clipped.complete) return nullptr;
    VoxelBuilder builder(reach.facets(), *out);
    const std::span<const CellPiece> pieces = clipped.pieces;
    for (std::size_t first = 0, end = 0; first < pieces.size(); first = end) {
        while (end < pieces.size() && pieces[end].cell == pieces[first].cell) ++end;
        builder.add(pieces.subspan(first, end - first));
        if (out->voxels.size() % 65'536 == 0 && stop.stop_requested()) return nullptr;
    }
    builder.finish();
    return out;
}

} // namespace lightloom
