// SPDX-License-Identifier: Apache-2.0
#include "core/transport/surface_voxels.h"
#include "core/base/rng.h"
#include "core/base/sampling.h"
#include <algorithm>
#include <bit>
#include <cassert>
#include <unordered_map>

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

    /// A voxel as another surface has it; `numberOf` its facets here.
    void copy(const SurfaceVoxels& from, std::size_t voxel, std::span<const std::uint32_t> numberOf)
    {
        out_.voxels.push_back(from.voxels[voxel]);
        out_.firstEntry.push_back(static_cast<std::uint32_t>(out_.entries.size()));
        for (std::uint32_t e = from.firstEntry[voxel]; e < from.firstEntry[voxel + 1]; ++e) {
            out_.entries.push_back(from.entries[e]);
            out_.firstPiece.push_back(static_cast<std::uint32_t>(out_.pieces.size()));
            for (std::uint32_t i = from.firstPiece[e]; i < from.firstPiece[e + 1]; ++i) {
                out_.pieces.push_back(from.pieces[i]);
                out_.pieces.back().facet = numberOf[from.pieces[i].facet];
            }
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

ReachedFacet movedOut(ReachedFacet f, float cell)
{
    const glm::vec3 way = kMovedOut * cell * f.normal;
    f.a += way, f.b += way, f.c += way;
    return f;
}

constexpr std::uint32_t kGone = 0xFFFFFFFFu;

/// Numbers in `now` of the facets of `before` that are there still, kGone for others: rising, so that what is sorted by
/// one is sorted by the other. `added`: the rest of `now`.
std::vector<std::uint32_t> facetsNow(std::span<const ReachedFacet> before, std::span<const ReachedFacet> now,
                                     std::vector<std::uint32_t>& added)
{
    struct Place {
        glm::vec3 a, b, c, normal;
        bool operator==(const Place&) const = default;
    };
    struct Hash {
        std::size_t operator()(const Place& place) const
        {
            std::uint64_t hash = 0;
            for (const glm::vec3 v : {place.a, place.b, place.c, place.normal})
                for (int axis = 0; axis < 3; ++axis)
                    hash = mixBits(hash ^ std::bit_cast<std::uint32_t>(v[axis] + 0.0f)); // -0 equals 0
            return hash;
        }
    };
    std::unordered_map<Place, std::vector<std::uint32_t>, Hash> where; // numbers before, the largest first
    where.reserve(before.size());
    for (std::size_t f = before.size(); f-- > 0;)
        where[{before[f].a, before[f].b, before[f].c, before[f].normal}].push_back(static_cast<std::uint32_t>(f));
    std::vector<std::uint32_t> numbers(before.size(), kGone);
    std::uint32_t next = 0;
    for (std::uint32_t f = 0; f < now.size(); ++f) {
        const auto found = where.find({now[f].a, now[f].b, now[f].c, now[f].normal});
        std::vector<std::uint32_t>* olds = found == where.end() ? nullptr : &found->second;
        while (olds && !olds->empty() && olds->back() < next) olds->pop_back();
        if (!olds || olds->empty()) {
            added.push_back(f);
            continue;
        }
        next = olds->back() + 1;
        numbers[olds->back()] = f;
    }
    return numbers;
}

/// Pieces of those facets of `reach`, by their numbers there. Not complete: stopped.
CellPieces cutUp(const LightReach& reach, std::span<const std::uint32_t> facets, const CellLattice& lattice,
                 Workers& workers, const std::stop_token& stop)
{
    std::vector<ReachedFacet> moved;
    for (const std::uint32_t f : facets) moved.push_back(movedOut(reach.facets()[f], lattice.cellSize()));
    CellPieces cut = clipToCells(moved, lattice, workers, stop);
    for (CellPiece& piece : cut.pieces) piece.facet = facets[piece.facet];
    return cut;
}

glm::dvec3 areaOf(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) { return glm::cross(b - a, c - a); } // twice a triangle's

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

glm::vec3 SurfaceVoxels::pointOn(std::size_t e, glm::vec3 u, const LightReach& reach, std::uint32_t& facet) const
{
    const auto own = std::span(pieces).subspan(firstPiece[e], firstPiece[e + 1] - firstPiece[e]);
    float rest = u.x * entries[e].area;
    std::size_t number = 0;
    while (number + 1 < own.size() && (rest -= own[number].area) >= 0.0f) ++number;
    const CellPiece& piece = own[number];
    facet = piece.facet;
    const ReachedFacet f = movedOut(reach.facets()[facet], cellSize());
    std::array<glm::dvec3, 9> corners;
    const std::size_t count = clipToCell(f.a, f.b, f.c, lattice, mortonCell(piece.cell), corners);
    const auto doubled = [&](std::size_t i) { return glm::length(areaOf(corners[0], corners[i - 1], corners[i])); };
    double all = 0.0;
    for (std::size_t i = 2; i < count; ++i) all += doubled(i);
    if (!(all > 0.0)) return piece.centroid;
    std::size_t i = 2;
    for (double left = static_cast<double>(u.y) * all; i + 1 < count && (left -= doubled(i)) >= 0.0; ++i) {
    }
    // the place within the fan's triangle: what `u.y` has left over is uniform again
    double before = 0.0;
    for (std::size_t k = 2; k < i; ++k) before += doubled(k);
    const double within = glm::clamp((static_cast<double>(u.y) * all - before) / doubled(i), 0.0, 1.0);
    const glm::vec2 b = sampleTriangle(static_cast<float>(within), u.z);
    return glm::vec3(corners[0] + static_cast<double>(b.x) * (corners[i - 1] - corners[0]) +
                     static_cast<double>(b.y) * (corners[i] - corners[0]));
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

std::uint32_t SurfaceVoxels::entryAt(glm::vec3 p, glm::vec3 normal) const
{
    const std::size_t voxel = voxelAt(p, normal);
    std::uint32_t best = kNoEntry;
    if (voxel == voxels.size()) return best;
    float bestCosine = 0.0f;
    for (std::uint32_t e = firstEntry[voxel]; e < firstEntry[voxel + 1]; ++e) {
        const float cosine = glm::dot(entries[e].normal, normal);
        if (cosine > bestCosine) bestCosine = cosine, best = e;
    }
    return best;
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
    std::vector<ReachedFacet> facets = reach.facets();
    for (ReachedFacet& f : facets) f = movedOut(f, out->cellSize());
    const CellPieces clipped = clipToCells(facets, out->lattice, workers, stop);
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

std::shared_ptr<const SurfaceVoxels> revoxelise(const SurfaceVoxels& before, const LightReach& reachBefore,
                                                const Bounds& bounds, const LightReach& reach, int cells, float shift,
                                                Workers& workers, const std::stop_token& stop, std::size_t* clipped)
{
    const auto out = std::make_shared<SurfaceVoxels>();
    out->lattice = voxelLattice(bounds, cells, shift);
    out->cells = cells;
    if (clipped) *clipped = reach.facets().size();
    if (before.cells != cells || before.lattice.lowest != out->lattice.lowest ||
        before.lattice.rootSize != out->lattice.rootSize)
        return voxelise(bounds, reach, cells, shift, workers, stop);

    std::vector<std::uint32_t> added;
    const std::vector<std::uint32_t> numberOf = facetsNow(reachBefore.facets(), reach.facets(), added);
    if (clipped) *clipped = added.size();
    const CellPieces cut = cutUp(reach, added, out->lattice, workers, stop);
    if (!cut.complete) return nullptr;
    VoxelBuilder builder(reach.facets(), *out);
    std::vector<CellPiece> mixed;
    auto next = cut.pieces.begin(); // of what has come
    const auto addUpTo = [&](std::uint64_t code) {
        while (next != cut.pieces.end() && next->cell < code) {
            const auto first = next;
            while (next != cut.pieces.end() && next->cell == first->cell) ++next;
            builder.add({first, next});
        }
    };
    for (std::size_t v = 0; v < before.voxels.size(); ++v) {
        if (v % 65'536 == 0 && stop.stop_requested()) return nullptr;
        const std::uint64_t code = mortonCode(glm::uvec3(before.voxels[v]));
        addUpTo(code);
        const std::span<const CellPiece> pieces = before.piecesOf(v);
        const bool isWhole =
            std::ranges::none_of(pieces, [&](const CellPiece& p) { return numberOf[p.facet] == kGone; });
        if (isWhole && (next == cut.pieces.end() || next->cell != code)) {
            builder.copy(before, v, numberOf);
            continue;
        }
        mixed.clear();
        for (const CellPiece& piece : pieces) {
            if (numberOf[piece.facet] == kGone) continue;
            mixed.push_back(piece);
            mixed.back().facet = numberOf[piece.facet];
        }
        for (; next != cut.pieces.end() && next->cell == code; ++next) mixed.push_back(*next);
        std::ranges::sort(mixed, {}, &CellPiece::facet);
        if (!mixed.empty()) builder.add(mixed);
    }
    addUpTo(~std::uint64_t{0});
    builder.finish();
    return out;
}

SurfaceVoxels withMeanNormals(const SurfaceVoxels& voxels)
{
    SurfaceVoxels out = voxels;
    out.entries.clear(), out.firstEntry.clear(), out.firstPiece.clear();
    for (std::uint32_t v = 0; v < voxels.voxels.size(); ++v) {
        const std::uint32_t first = voxels.firstEntry[v], end = voxels.firstEntry[v + 1];
        Orientation mean{glm::vec3(0.0f), glm::vec3(0.0f), 0.0f};
        for (std::uint32_t e = first; e < end; ++e) {
            const Orientation& o = voxels.entries[e];
            mean.centroid += o.area * (o.centroid - voxels.lattice.lowest);
            mean.normal += o.area * o.normal;
            mean.area += o.area;
        }
        mean.centroid = voxels.lattice.lowest + mean.centroid / mean.area;
        const float length = glm::length(mean.normal);
        mean.normal = length > 1e-3f * mean.area ? mean.normal / length : voxels.entries[first].normal;
        out.firstEntry.push_back(static_cast<std::uint32_t>(out.entries.size()));
        out.firstPiece.push_back(voxels.firstPiece[first]);
        out.entries.push_back(mean);
    }
    out.firstEntry.push_back(static_cast<std::uint32_t>(out.entries.size()));
    out.firstPiece.push_back(static_cast<std::uint32_t>(out.pieces.size()));
    return out;
}

} // namespace lightloom
