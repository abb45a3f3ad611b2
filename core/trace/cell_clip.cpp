// SPDX-License-Identifier: Apache-2.0
#include "core/trace/cell_clip.h"
#include "core/base/ordering.h"
#include <algorithm>
#include <array>
#include <tuple>

namespace lightloom {
namespace {

std::uint64_t spread(std::uint64_t v) // each bit moves to three times its place
{
    v &= 0x1FFFFF;
    v = (v | v << 32) & 0x1F00000000FFFFull;
    v = (v | v << 16) & 0x1F0000FF0000FFull;
    v = (v | v << 8) & 0x100F00F00F00F00Full;
    v = (v | v << 4) & 0x10C30C30C30C30C3ull;
    return (v | v << 2) & 0x1249249249249249ull;
}

unsigned gather(std::uint64_t v)
{
    v &= 0x1249249249249249ull;
    v = (v | v >> 2) & 0x10C30C30C30C30C3ull;
    v = (v | v >> 4) & 0x100F00F00F00F00Full;
    v = (v | v >> 8) & 0x1F0000FF0000FFull;
    v = (v | v >> 16) & 0x1F00000000FFFFull;
    return static_cast<unsigned>((v | v >> 32) & 0x1FFFFF);
}

/// A convex polygon in lattice coordinates (root cell = unit cube), double so that halving loses nothing.
struct Polygon {
    std::array<glm::dvec3, 16> points; // a triangle gains at most one corner a cut, and loses as it gets smaller
    int count = 0;

    void add(glm::dvec3 p)
    {
        if (count < static_cast<int>(points.size())) points[static_cast<std::size_t>(count++)] = p;
    }

    /// Centroid; `area` half the length of the area vector.
    [[nodiscard]] glm::dvec3 centroid(double& area) const
    {
        glm::dvec3 sum(0.0);
        double total = 0.0;
        for (int i = 2; i < count; ++i) {
            const glm::dvec3 &a = points[0], &b = points[static_cast<std::size_t>(i) - 1],
                             &c = points[static_cast<std::size_t>(i)];
            const double part = 0.5 * glm::length(glm::cross(b - a, c - a));
            sum += part * (a + b + c) / 3.0;
            total += part;
        }
        area = total;
        return total > 0.0 ? sum / total : points[0];
    }
};

/// In units of the root cell. Rounding may put a point a hair outside: the border cell takes it.
glm::dvec3 inLattice(glm::vec3 p, const CellLattice& lattice)
{
    return glm::clamp((glm::dvec3(p) - glm::dvec3(lattice.lowest)) / static_cast<double>(lattice.rootSize), 0.0, 1.0);
}

/// Splits by the plane x[axis] = at; points on it go above, so that a polygon in the plane is above as a whole.
void split(const Polygon& polygon, int axis, double at, Polygon& below, Polygon& above)
{
    below.count = above.count = 0;
    for (int i = 0; i < polygon.count; ++i) {
        const glm::dvec3 a = polygon.points[static_cast<std::size_t>(i)];
        const glm::dvec3 b = polygon.points[static_cast<std::size_t>((i + 1) % polygon.count)];
        const bool aUp = a[axis] >= at, bUp = b[axis] >= at;
        (aUp ? above : below).add(a);
        if (aUp == bUp) continue;
        glm::dvec3 cut = a + (b - a) * ((at - a[axis]) / (b[axis] - a[axis]));
        cut[axis] = at;
        below.add(cut);
        above.add(cut);
    }
}

/// `Visit` takes a part and its depth; `IsOne` says which cells are not halved further, whatever their depth.
template<class Visit, class IsOne>
class Clipper {
    static constexpr int kLevelsAtOnce = 5; // a thousand cells, less than a millisecond between looks at the stop

public:
    Clipper(const CellLattice& lattice, const IsOne& isOne, const Visit& visit, const std::stop_token& stop,
            const std::optional<CellsWithin>& within = {})
        : lattice_(lattice), isOne_(isOne), visit_(visit), stop_(stop), within_(within), lowest_(lattice.lowest),
          size_(static_cast<double>(lattice.rootSize))
    {
    }

    void add(glm::vec3 a, glm::vec3 b, glm::vec3 c)
    {
        Polygon polygon;
        for (const glm::vec3 p : {a, b, c}) polygon.add(inLattice(p, lattice_));
        descend(polygon, glm::uvec3(0), 0);
    }

private:
    void descend(const Polygon& polygon, glm::uvec3 cell, int depth)
    {
        if (polygon.count < 3) return;
        if (within_ && depth == within_->depth && !std::ranges::binary_search(within_->cells, mortonCode(cell))) return;
        if (depth == lattice_.depth || isOne_(cell, depth)) return emit(polygon, cell, depth);
        if (lattice_.depth - depth == kLevelsAtOnce && stop_.stop_requested()) return;
        const double half = 1.0 / static_cast<double>(2u << depth);
        Polygon x[2], y[2], z[2];
        split(polygon, 0, (2.0 * cell.x + 1.0) * half, x[0], x[1]);
        for (unsigned i = 0; i < 2; ++i) {
            if (x[i].count < 3) continue;
            split(x[i], 1, (2.0 * cell.y + 1.0) * half, y[0], y[1]);
            for (unsigned j = 0; j < 2; ++j) {
                if (y[j].count < 3) continue;
                split(y[j], 2, (2.0 * cell.z + 1.0) * half, z[0], z[1]);
                for (unsigned k = 0; k < 2; ++k) {
                    const Polygon part = z[k];
                    descend(part, 2u * cell + glm::uvec3(i, j, k), depth + 1);
                }
            }
        }
    }

    void emit(Polygon polygon, glm::uvec3 cell, int depth)
    {
        CellPolygon part;
        const glm::dvec3 centre = polygon.centroid(part.area);
        if (!(part.area > 0.0)) return;
        for (int i = 0; i < polygon.count; ++i) {
            glm::dvec3& p = polygon.points[static_cast<std::size_t>(i)];
            p = lowest_ + p * size_;
        }
        part.cell = cell;
        part.corners = std::span(polygon.points).first(static_cast<std::size_t>(polygon.count));
        part.area *= size_ * size_;
        part.centroid = lowest_ + centre * size_;
        visit_(part, depth);
    }

    const CellLattice& lattice_;
    const IsOne& isOne_;
    const Visit& visit_;
    const std::stop_token& stop_;
    std::optional<CellsWithin> within_;
    glm::dvec3 lowest_;
    double size_;
};

constexpr auto kAllHalved = [](glm::uvec3, int) { return false; };

} // namespace

std::uint64_t mortonCode(glm::uvec3 cell) { return spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2; }
glm::uvec3 mortonCell(std::uint64_t code) { return {gather(code), gather(code >> 1), gather(code >> 2)}; }

CellLattice latticeOver(const Bounds& bounds, int depth, float shift)
{
    const float side = glm::max(bounds.longestSide(), 1e-30f);
    const float padded = side * 1.002f;
    CellLattice lattice;
    lattice.depth = depth;
    const auto cells = static_cast<float>(1u << depth);
    lattice.rootSize = shift > 0.0f ? padded * cells / glm::max(cells - 1.0f, 1.0f) : padded;
    if (shift > 0.0f && depth == 0) lattice.rootSize = 2.0f * padded;
    const glm::vec3 low = bounds.centre() - glm::vec3(0.5f * padded);
    lattice.lowest = low - glm::vec3(shift * lattice.cellSize());
    return lattice;
}

void clipTriangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, const CellLattice& lattice,
                  const std::function<void(const CellPolygon&)>& visit, const std::stop_token& stop)
{
    const auto visitPart = [&](const CellPolygon& part, int) { visit(part); };
    Clipper(lattice, kAllHalved, visitPart, stop).add(a, b, c);
}

void clipTriangle(glm::vec3 a, glm::vec3 b, glm::vec3 c, const CellLattice& lattice,
                  const std::function<bool(glm::uvec3, int)>& isOne,
                  const std::function<void(const CellPolygon&, int depth)>& visit)
{
    const std::stop_token never;
    Clipper(lattice, isOne, visit, never).add(a, b, c);
}

std::size_t clipToCell(glm::vec3 a, glm::vec3 b, glm::vec3 c, const CellLattice& lattice, glm::uvec3 cell,
                       std::array<glm::dvec3, 9>& corners)
{
    Polygon inside, rest;
    for (const glm::vec3 p : {a, b, c}) inside.add(inLattice(p, lattice));
    const double cells = static_cast<double>(1u << lattice.depth);
    for (int axis = 0; axis < 3 && inside.count > 0; ++axis) {
        Polygon above;
        split(inside, axis, cell[axis] / cells, rest, above);
        if (cell[axis] + 1 < 1u << lattice.depth)
            split(above, axis, (cell[axis] + 1.0) / cells, inside, rest);
        else
            inside = above;
    }
    if (inside.count < 3 || inside.count > 9) return 0;
    const auto count = static_cast<std::size_t>(inside.count);
    for (std::size_t i = 0; i < count; ++i)
        corners[i] = glm::dvec3(lattice.lowest) + inside.points[i] * static_cast<double>(lattice.rootSize);
    return count;
}

CellPieces clipToCells(const std::vector<ReachedFacet>& facets, const CellLattice& lattice, Workers& workers,
                       const std::stop_token& stop, const std::optional<CellsWithin>& within)
{
    constexpr std::size_t kBlock = 16; // a large triangle has a million cells: few in one worker's hands
    const std::size_t blocks = (facets.size() + kBlock - 1) / kBlock;
    std::vector<std::vector<CellPiece>> parts(blocks);
    const bool all = workers.run(blocks, stop, [&](std::size_t block) {
        for (std::size_t f = block * kBlock; f < std::min(facets.size(), (block + 1) * kBlock); ++f) {
            if (stop.stop_requested()) return;
            const auto keep = [&](const CellPolygon& part, int) {
                parts[block].push_back({mortonCode(part.cell), static_cast<std::uint32_t>(f),
                                        static_cast<float>(part.area), glm::vec3(part.centroid)});
            };
            Clipper(lattice, kAllHalved, keep, stop, within).add(facets[f].a, facets[f].b, facets[f].c);
        }
    }) && !stop.stop_requested();
    if (!all) return {};
    CellPieces result;
    for (std::size_t block = 0; block < blocks; ++block) {
        if (block % 1024 == 0 && stop.stop_requested()) return {};
        result.pieces.insert(result.pieces.end(), parts[block].begin(), parts[block].end());
    }
    result.complete = sortOn(workers, stop, result.pieces, [](const CellPiece& a, const CellPiece& b) {
        return std::tie(a.cell, a.facet) < std::tie(b.cell, b.facet);
    });
    return result;
}

} // namespace lightloom
