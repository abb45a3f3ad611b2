// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_surface.h"
#include "core/base/rng.h"
#include "core/base/sampling.h"
#include "core/base/units.h"
#include "core/trace/cell_clip.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr float kPatchesPerCell = 2.0f; ///< along each axis
constexpr int kPieceLevels = 2;         ///< a patch is looked at in pieces a quarter as wide
constexpr float kOffBorders = 0.05f;    ///< of a patch, between walls and borders of patches
constexpr int kLooks = 2;               ///< rays from a piece
constexpr std::size_t kBlock = 1024;    ///< pieces
constexpr std::uint64_t kNoCell = ~std::uint64_t{0};
constexpr float kFar = std::numeric_limits<float>::infinity();

/// The signed axis that a normal is nearest to.
std::uint64_t directionOf(const glm::vec3& n)
{
    const glm::vec3 size = glm::abs(n);
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    return static_cast<std::uint64_t>(2 * axis + (n[axis] > 0.0f ? 1 : 0));
}
std::uint64_t keyOf(std::uint64_t cell, const glm::vec3& n) { return 6 * cell + directionOf(n); }
double areaOf(const ReachedFacet& f)
{
    return 0.5 * glm::length(glm::cross(glm::dvec3(f.b) - glm::dvec3(f.a), glm::dvec3(f.c) - glm::dvec3(f.a)));
}

/// Which pieces lie in the open and not under something that stands on them.
class Look {
public:
    Look(const RayScene& rays, const LightReach& reach) : rays_(rays), isReached_(2 * rays.triangleCount(), 0)
    {
        for (const ReachedFacet& facet : reach.facets()) isReached_[facet.side] = 1;
    }
    [[nodiscard]] bool isOpen(glm::vec3 p, glm::vec3 n, Rng rng) const
    {
        for (int i = 0; i < kLooks; ++i) {
            const float u1 = rng.uniform(), u2 = rng.uniform();
            Hit hit;
            const glm::vec3 way = Frame(n).toWorld(sampleCosineHemisphere(u1, u2));
            if (!rays_.intersect(rays_.leave(p, n), way, kFar, hit)) return true;
            if (isReached_[2 * hit.triangle + (hit.isFront ? 0 : 1)] != 0) return true;
        }
        return false;
    }

private:
    const RayScene& rays_;
    std::vector<std::uint8_t> isReached_; // by side
};

/// Facets that meet the lattice, in grid coordinates, and by facet how much larger its area is in the scene.
struct FacetsInGrid {
    std::vector<ReachedFacet> facets;
    std::vector<double> stretch;

    FacetsInGrid(const LightReach& reach, const GridLattice& lattice)
    {
        for (ReachedFacet f : reach.facets()) {
            const double area = areaOf(f);
            f.a = lattice.toGrid(f.a), f.b = lattice.toGrid(f.b), f.c = lattice.toGrid(f.c);
            const glm::vec3 low = glm::min(f.a, glm::min(f.b, f.c)), high = glm::max(f.a, glm::max(f.b, f.c));
            const bool isNear = glm::all(glm::greaterThanEqual(high, glm::vec3(-1.0f))) &&
                                glm::all(glm::lessThanEqual(low, glm::vec3(lattice.cells + 1)));
            const double inGrid = areaOf(f);
            if (!isNear || !(inGrid > 0.0)) continue;
            facets.push_back(f);
            stretch.push_back(area / inGrid);
        }
    }
};

} // namespace

GridSurface::GridSurface(std::shared_ptr<const RayScene> rays, const GridLattice& lattice) : rays_(std::move(rays))
{
    const Bounds& bounds = rays_->scene().bounds;
    const glm::vec3 low = lattice.toGrid(bounds.low), high = lattice.toGrid(bounds.high);
    for (int axis = 0; axis < 3; ++axis) {
        // a wall that lies in a border of patches would be a toss between them
        const float start = std::floor(low[axis]) - 2.0f;
        const float metres = lattice.lowest[axis] + start * lattice.cellSize[axis];
        const float place = freePlace(
            0.37f, wallFractions(*rays_, axis, metres, lattice.cellSize[axis] / kPatchesPerCell), kOffBorders);
        lowest_[axis] = start + place / kPatchesPerCell;
        blocks_[axis] = static_cast<int>(std::ceil(high[axis] - lowest_[axis])) + 1;
    }
    corner_ = lattice.lowest + lowest_ * lattice.cellSize;
    perMetre_ = kPatchesPerCell / lattice.cellSize;
}

std::shared_ptr<const GridSurface> GridSurface::build(std::shared_ptr<const RayScene> rays, const LightReach& reach,
                                                      const GridLattice& lattice, Workers& workers,
                                                      const std::stop_token& stop)
{
    const std::shared_ptr<GridSurface> surface(new GridSurface(std::move(rays), lattice));
    const FacetsInGrid in(reach, lattice);
    const glm::ivec3 blocks = surface->blocks_;
    const int depth = std::bit_width(static_cast<unsigned>(2 * std::max({blocks.x, blocks.y, blocks.z})));
    const CellLattice cells{surface->lowest_, static_cast<float>(1u << depth) / kPatchesPerCell, depth + kPieceLevels};
    const CellPieces cut = clipToCells(in.facets, cells, workers, stop);
    if (!cut.complete) return nullptr;
    const std::vector<CellPiece>& pieces = cut.pieces;
    const auto place = [&](const CellPiece& piece) { return lattice.lowest + piece.centroid * lattice.cellSize; };
    std::vector<std::uint8_t> isOpen(pieces.size());
    const Look look(*surface->rays_, reach);
    const bool all = workers.run((pieces.size() + kBlock - 1) / kBlock, stop, [&](std::size_t block) {
        for (std::size_t i = block * kBlock; i < std::min(pieces.size(), (block + 1) * kBlock); ++i) {
            const ReachedFacet& facet = in.facets[pieces[i].facet];
            isOpen[i] = look.isOpen(place(pieces[i]), facet.normal, Rng(facet.side, pieces[i].cell)) ? 1 : 0;
        }
    });
    if (!all) return nullptr;

    std::vector<std::uint64_t> keys;
    std::vector<glm::dvec3> positions, normals;
    std::vector<double> areas;
    std::array<std::uint32_t, 6> current{};
    std::uint64_t before = kNoCell;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (isOpen[i] == 0) continue;
        const ReachedFacet& facet = in.facets[pieces[i].facet];
        const std::uint64_t cell = pieces[i].cell >> (3 * kPieceLevels), direction = directionOf(facet.normal);
        if (cell != before) current.fill(kNone);
        before = cell;
        std::uint32_t& patch = current[direction];
        if (patch == kNone) {
            patch = static_cast<std::uint32_t>(keys.size());
            keys.push_back(keyOf(cell, facet.normal));
            positions.emplace_back(0.0), normals.emplace_back(0.0), areas.push_back(0.0);
        }
        const double area = static_cast<double>(pieces[i].area) * in.stretch[pieces[i].facet];
        positions[patch] += area * glm::dvec3(place(pieces[i]));
        normals[patch] += area * glm::dvec3(facet.normal);
        areas[patch] += area;
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
        surface->patches_.push_back(
            {glm::vec3(positions[i] / areas[i]), glm::vec3(glm::normalize(normals[i])), static_cast<float>(areas[i])});
    }
    surface->index(keys);
    return surface;
}

/// `keys` rise, so that the patches of a block of 2 x 2 x 2 cells lie together.
void GridSurface::index(const std::vector<std::uint64_t>& keys)
{
    const std::size_t count =
        static_cast<std::size_t>(blocks_.x) * static_cast<std::size_t>(blocks_.y) * static_cast<std::size_t>(blocks_.z);
    firsts_.assign(count, 0);
    ends_.assign(count, 0);
    for (const std::uint64_t key : keys) {
        const glm::uvec3 cell = mortonCell(key / 6);
        const std::size_t block = blockOf(cell);
        const auto patch = static_cast<std::uint32_t>(codes_.size());
        if (ends_[block] == 0) firsts_[block] = patch;
        ends_[block] = patch + 1;
        codes_.push_back(codeOf(cell, key % 6));
    }
}

std::uint32_t GridSurface::patchOf(const PhotonSegment& way) const
{
    if (way.triangle == PhotonSegment::kNowhere) return kNone;
    glm::vec3 n = rays_->triangleNormal(way.triangle);
    if (glm::dot(n, way.travel) > 0.0f) n = -n;
    const glm::vec3 at = (way.from + way.length * way.travel - corner_) * perMetre_;
    const bool isInside =
        glm::all(glm::greaterThanEqual(at, glm::vec3(0.0f))) && glm::all(glm::lessThan(at, 2.0f * glm::vec3(blocks_)));
    if (!isInside) return kNone;
    const glm::uvec3 cell(at);
    const std::uint8_t code = codeOf(cell, directionOf(n));
    const std::size_t block = blockOf(cell);
    for (std::uint32_t i = firsts_[block]; i < ends_[block]; ++i)
        if (codes_[i] == code) return i;
    return kNone;
}

bool SurfaceLight::add(std::span<const SegmentBlock* const> blocks, Workers& workers, const std::stop_token& stop)
{
    ends_.resize(std::max(ends_.size(), blocks.size()));
    const bool isFound = workers.run(blocks.size(), stop, [&](std::size_t b) {
        const auto& segments = blocks[b]->segments;
        ends_[b].resize(segments.size());
        std::ranges::transform(segments, ends_[b].begin(),
                               [&](const PhotonSegment& way) { return surface_->patchOf(way); });
    });
    if (!isFound) return false;
    const auto ranges = static_cast<std::size_t>(workers.threadCount()); // of patches: each looks at all segments
    const std::size_t step = flux_.size() / ranges + 1;
    return workers.run(ranges, stop, [&](std::size_t range) {
        const std::size_t first = range * step, count = std::min(step, flux_.size() - std::min(first, flux_.size()));
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            const auto& segments = blocks[b]->segments;
            for (std::size_t i = 0; i < segments.size(); ++i) {
                const std::size_t patch = ends_[b][i] - first; // wraps around for those before
                if (patch >= count) continue;
                const auto light = static_cast<double>(luminance(segments[i].flux));
                flux_[first + patch] += glm::dvec4(glm::dvec3(segments[i].flux), light * light);
            }
        }
    });
}

std::vector<LandedLight> SurfaceLight::light(double scale) const
{
    std::vector<LandedLight> landed;
    landed.reserve(flux_.size());
    for (std::size_t i = 0; i < flux_.size(); ++i) {
        const double perArea = scale / static_cast<double>(surface_->patches()[i].area);
        landed.push_back({glm::vec3(glm::dvec3(flux_[i]) * perArea), static_cast<float>(flux_[i].w * scale * scale)});
    }
    return landed;
}

} // namespace lightloom
