// SPDX-License-Identifier: Apache-2.0
#include "core/trace/side_elements.h"
#include "core/base/ordering.h"
#include "core/base/sampling.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>

namespace lightloom {
namespace {

constexpr float kLargeCells = 2.0f; ///< a triangle this many cells long is cut
constexpr float kFromEdges = 0.1f;  ///< that sampled points keep, in steps off the surface: many times the rounding

/// Sides (2 * triangle for the front, + 1 for the back) joined into surfaces.
class Surfaces {
public:
    explicit Surfaces(std::uint32_t sides) : parent_(sides) { std::iota(parent_.begin(), parent_.end(), 0u); }

    std::uint32_t of(std::uint32_t side)
    {
        while (parent_[side] != side) side = parent_[side] = parent_[parent_[side]];
        return side;
    }
    void join(std::uint32_t a, std::uint32_t b)
    {
        a = of(a), b = of(b);
        parent_[std::max(a, b)] = std::min(a, b); // the smallest side names the surface, whatever the order of joins
    }

private:
    std::vector<std::uint32_t> parent_;
};

struct Edge {
    std::uint32_t low, high; // welded vertices
    std::uint32_t triangle;
    bool rises; // the triangle's front walks it from low to high
    bool operator<(const Edge& o) const
    {
        return std::tie(low, high, triangle, rises) < std::tie(o.low, o.high, o.triangle, o.rises);
    }
};

/// Calls `body(t)` for each triangle on all workers. False: stopped.
template<class Body>
bool forTriangles(const RayScene& rays, Workers& workers, const std::stop_token& stop, Body body)
{
    constexpr std::size_t kBlock = 16'384;
    const std::size_t count = rays.triangleCount();
    return workers.run((count + kBlock - 1) / kBlock, stop, [&](std::size_t block) {
        for (std::size_t t = block * kBlock; t < std::min(count, (block + 1) * kBlock); ++t) {
            body(static_cast<std::uint32_t>(t));
        }
    });
}

/// Whether `p` lies inside the triangle with unit normal `n`, either way, by at least `distance`: rounding could carry
/// a point of a body's inside over its edge, into the open.
bool isOffEdges(const SceneTriangle& t, glm::vec3 p, glm::vec3 n, float distance)
{
    const auto off = [&](glm::vec3 from, glm::vec3 to) {
        const glm::dvec3 edge = glm::dvec3(to) - glm::dvec3(from);
        const double across = glm::dot(glm::cross(glm::dvec3(n), edge), glm::dvec3(p) - glm::dvec3(from));
        return std::abs(across) >= static_cast<double>(distance) * glm::length(edge);
    };
    return off(t.a, t.b) && off(t.b, t.c) && off(t.c, t.a);
}

/// Whether a long loop is to end; asks every 65536th time only.
bool endsAt(std::size_t i, const std::stop_token& stop) { return i % 65'536 == 0 && stop.stop_requested(); }

/// Number of each triangle corner among the distinct positions of the scene. False: stopped.
bool weld(const RayScene& rays, Workers& workers, const std::stop_token& stop, std::vector<std::uint32_t>& welded)
{
    struct Corner {
        glm::uvec3 bits;
        std::uint32_t number;
    };
    std::vector<Corner> corners(std::size_t(3) * rays.triangleCount());
    const auto bitsOf = [](float v) { return std::bit_cast<std::uint32_t>(v == 0.0f ? 0.0f : v); }; // -0 is 0
    const bool listed = forTriangles(rays, workers, stop, [&](std::uint32_t t) {
        const SceneTriangle& triangle = rays.triangle(t);
        std::uint32_t number = 3 * t;
        for (const glm::vec3 p : {triangle.a, triangle.b, triangle.c}) {
            corners[number] = {{bitsOf(p.x), bitsOf(p.y), bitsOf(p.z)}, number};
            ++number;
        }
    });
    const bool sorted =
        listed && sortOn(workers, stop, corners, [](const Corner& a, const Corner& b) {
            return std::tie(a.bits.x, a.bits.y, a.bits.z, a.number) < std::tie(b.bits.x, b.bits.y, b.bits.z, b.number);
        });
    if (!sorted) return false;
    welded.resize(corners.size());
    std::uint32_t vertex = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (endsAt(i, stop)) return false;
        if (i > 0 && corners[i].bits != corners[i - 1].bits) ++vertex;
        welded[corners[i].number] = vertex;
    }
    return true;
}

/// The edges of all triangles, those between the same two vertices side by side. False: stopped.
bool listEdges(const RayScene& rays, Workers& workers, const std::stop_token& stop, std::vector<Edge>& edges)
{
    std::vector<std::uint32_t> vertex;
    if (!weld(rays, workers, stop, vertex)) return false;
    edges.resize(vertex.size());
    const bool listed = forTriangles(rays, workers, stop, [&](std::uint32_t t) {
        const bool mirrored = rays.scene().instances[rays.triangle(t).instance].isMirrored();
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t a = vertex[3 * t + i], b = vertex[3 * t + (i + 1) % 3];
            edges[3 * t + i] = {std::min(a, b), std::max(a, b), t, (a < b) != mirrored};
        }
    });
    return listed && sortOn(workers, stop, edges, std::less<Edge>());
}

/// Joins the sides of triangles that share an edge. Where three or more meet (a partition on a floor) nothing is
/// joined. False: stopped.
bool joinSides(const RayScene& rays, Workers& workers, const std::stop_token& stop, Surfaces& surfaces)
{
    std::vector<Edge> edges;
    if (!listEdges(rays, workers, stop, edges)) return false;
    std::size_t groups = 0;
    for (std::size_t i = 0; i < edges.size();) {
        if (endsAt(groups++, stop)) return false;
        std::size_t end = i + 1;
        while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
        if (end - i == 2 && edges[i].low != edges[i].high) { // an edge without length joins nothing
            const Edge &a = edges[i], &b = edges[i + 1];
            const std::uint32_t flip =
                a.rises == b.rises ? 1 : 0; // wound alike: one's front continues as the other's back
            surfaces.join(2 * a.triangle, 2 * b.triangle + flip);
            surfaces.join(2 * a.triangle + 1, 2 * b.triangle + (1 - flip));
        }
        i = end;
    }
    return true;
}

} // namespace

std::unique_ptr<const SideElements> SideElements::build(const RayScene& rays, int depth, Workers& workers,
                                                        const std::stop_token& stop)
{
    Surfaces surfaces(2 * rays.triangleCount());
    if (!joinSides(rays, workers, stop, surfaces)) return nullptr;
    std::unique_ptr<SideElements> made(new SideElements(rays, depth));
    std::vector<std::uint32_t> elementOf(made->sides_.size(), 0xFFFFFFFFu); // of each surface
    for (std::uint32_t t = 0; t < rays.triangleCount(); ++t) {
        if (endsAt(t, stop)) return nullptr;
        if (made->isLarge(rays.triangle(t))) {
            made->cut(t);
            continue;
        }
        for (const std::uint32_t side : {2 * t, 2 * t + 1}) made->addSmall(side, elementOf[surfaces.of(side)]);
    }
    return made;
}

SideElements::SideElements(const RayScene& rays, int depth)
    : rays_(rays), lattice_(latticeOver(rays.scene().bounds, depth, 0.0f)), sides_(2 * rays.triangleCount())
{
}

void SideElements::addSmall(std::uint32_t side, std::uint32_t& element)
{
    if (element == 0xFFFFFFFFu) {
        element = count_++;
        members_.emplace_back();
        isPart_.push_back(0);
    }
    sides_[side] = {element, 0};
    members_[element].push_back(side);
}

bool SideElements::isLarge(const SceneTriangle& t) const
{
    const glm::vec3 size = glm::max(t.a, glm::max(t.b, t.c)) - glm::min(t.a, glm::min(t.b, t.c));
    return glm::max(size.x, glm::max(size.y, size.z)) > kLargeCells * lattice_.cellSize();
}

void SideElements::cut(std::uint32_t triangle)
{
    const SceneTriangle& t = rays_.triangle(triangle);
    const auto firstPart = static_cast<std::uint32_t>(parts_.size());
    clipTriangle(t.a, t.b, t.c, lattice_, [&](const CellPolygon& polygon) {
        const auto firstCorner = static_cast<std::uint32_t>(corners_.size());
        for (const glm::dvec3& p : polygon.corners) corners_.emplace_back(p);
        parts_.push_back(
            {mortonCode(polygon.cell), 0, firstCorner, static_cast<std::uint32_t>(polygon.corners.size())});
    });
    std::sort(parts_.begin() + firstPart, parts_.end(), [](const Part& a, const Part& b) { return a.cell < b.cell; });
    const auto parts = static_cast<std::uint32_t>(parts_.size()) - firstPart;
    if (parts == 0) { // longer than a cell, but without area
        for (const std::uint32_t side : {2 * triangle, 2 * triangle + 1}) {
            sides_[side] = {count_++, 0};
            members_.push_back({side});
            isPart_.push_back(0);
        }
        return;
    }
    // the back's parts are copies of the front's with elements of their own
    for (std::uint32_t i = 0; i < parts; ++i) parts_.push_back(parts_[firstPart + i]);
    sides_[2 * triangle] = {firstPart, parts};
    sides_[2 * triangle + 1] = {firstPart + parts, parts};
    for (std::uint32_t i = firstPart; i < firstPart + 2 * parts; ++i) {
        parts_[i].element = count_++;
        members_.push_back({i, i < firstPart + parts ? 2 * triangle : 2 * triangle + 1});
        isPart_.push_back(1);
    }
}

std::uint32_t SideElements::of(const Hit& hit) const
{
    const Range range = sides_[2 * hit.triangle + (hit.isFront ? 0 : 1)];
    if (range.count == 0) return range.first;
    const float cell = lattice_.cellSize();
    const glm::vec3 at = glm::clamp((hit.position - lattice_.lowest) / cell, 0.0f,
                                    static_cast<float>((1u << lattice_.depth) - 1u) + 0.5f);
    const auto first = parts_.begin() + range.first, last = first + range.count;
    const std::uint64_t code = mortonCode(glm::uvec3(at));
    auto found = std::lower_bound(first, last, code, [](const Part& part, std::uint64_t c) { return part.cell < c; });
    if (found == last) --found; // rounding put the hit over a border: any neighbour will do
    return found->element;
}

bool SideElements::sample(std::uint32_t element, Rng& rng, glm::vec3& p, glm::vec3& n) const
{
    const std::vector<std::uint32_t>& members = members_[element];
    std::uint32_t side = 0;
    glm::vec3 a, b, c;
    if (isPart_[element]) {
        const Part& part = parts_[members[0]];
        const auto fan = static_cast<std::uint32_t>(1 + rng.bits() % (part.corners - 2));
        a = corners_[part.firstCorner], b = corners_[part.firstCorner + fan], c = corners_[part.firstCorner + fan + 1];
        side = members[1];
    } else {
        side = members[rng.bits() % members.size()];
        const SceneTriangle& t = rays_.triangle(side / 2);
        a = t.a, b = t.b, c = t.c;
    }
    const float u1 = rng.uniform(), u2 = rng.uniform();
    const glm::vec2 w = sampleTriangle(u1, u2);
    p = a * (1.0f - w.x - w.y) + b * w.x + c * w.y;
    n = normalOf(side);
    return n != glm::vec3(0.0f) && isOffEdges(rays_.triangle(side / 2), p, n, kFromEdges * rays_.offset());
}

bool SideElements::canFace(std::uint32_t element, glm::vec3 p, glm::vec3 n) const
{
    if (!isPart_[element]) return true;
    const Part& part = parts_[members_[element][0]];
    const std::uint32_t side = members_[element][1];
    const glm::vec3 own = normalOf(side);
    const glm::vec3* corner = corners_.data() + part.firstCorner;
    if (!(glm::dot(p - corner[0], own) > 0.0f)) return false; // behind the plane it lies in
    return std::any_of(corner, corner + part.corners,
                       [&](glm::vec3 c) { return glm::dot(c - p, n) > -2.0f * rays_.offset(); });
}

bool SideElements::mayFace(std::uint32_t element, const Bounds& box) const
{
    if (!isPart_[element]) return true;
    const glm::vec3 own = normalOf(members_[element][1]);
    const glm::vec3 farthest = glm::mix(box.low, box.high, glm::greaterThan(own, glm::vec3(0.0f)));
    return glm::dot(farthest - corners_[parts_[members_[element][0]].firstCorner], own) > 0.0f;
}

void SideElements::addJoined(std::uint32_t side, const std::function<bool(std::uint32_t)>& isReached,
                             std::vector<ReachedFacet>& joined) const
{
    const auto parts = std::span(parts_).subspan(sides_[side].first, sides_[side].count);
    std::vector<std::uint32_t> reachedBefore{0}; // each part
    for (const Part& part : parts) reachedBefore.push_back(reachedBefore.back() + (isReached(part.element) ? 1 : 0));
    struct Share {
        std::size_t parts, reached;
    };
    const auto within = [&](glm::uvec3 cell, int depth) {
        const int finer = 3 * (lattice_.depth - depth);
        const std::uint64_t code = mortonCode(cell);
        const auto place = [&](std::uint64_t c) {
            return static_cast<std::size_t>(std::ranges::lower_bound(parts, c, {}, &Part::cell) - parts.begin());
        };
        const std::size_t first = place(code << finer), last = place((code + 1) << finer);
        return Share{last - first, reachedBefore[last] - reachedBefore[first]};
    };
    const auto isOne = [&](glm::uvec3 cell, int depth) {
        const Share share = within(cell, depth);
        return share.reached == 0 || share.reached == share.parts;
    };
    const SceneTriangle& t = rays_.triangle(side / 2);
    clipTriangle(t.a, t.b, t.c, lattice_, isOne, [&](const CellPolygon& polygon, int depth) {
        if (within(polygon.cell, depth).reached == 0) return;
        for (std::size_t i = 1; i + 1 < polygon.corners.size(); ++i) {
            joined.push_back({glm::vec3(polygon.corners[0]), glm::vec3(polygon.corners[i]),
                              glm::vec3(polygon.corners[i + 1]), normalOf(side), side});
        }
    });
}

bool SideElements::listFacets(const std::function<bool(std::uint32_t)>& isReached, const std::stop_token& stop,
                              std::vector<ReachedFacet>& facets, std::vector<ReachedFacet>& joined) const
{
    for (std::uint32_t side = 0; side < sides_.size(); ++side) {
        if (endsAt(side, stop)) return false;
        const SceneTriangle& t = rays_.triangle(side / 2);
        const glm::vec3 n = normalOf(side);
        if (n == glm::vec3(0.0f)) continue;
        const Range range = sides_[side];
        if (range.count == 0) {
            if (isReached(range.first)) facets.push_back({t.a, t.b, t.c, n, side});
            continue;
        }
        const auto part = parts_.begin() + range.first;
        const auto reached = [&](const Part& x) { return isReached(x.element); };
        if (std::all_of(part, part + range.count, reached)) {
            facets.push_back({t.a, t.b, t.c, n, side});
            continue;
        }
        addJoined(side, isReached, joined);
        for (auto x = part; x != part + range.count; ++x) {
            if (!reached(*x)) continue;
            for (std::uint32_t i = 1; i + 1 < x->corners; ++i) {
                const glm::vec3* corner = corners_.data() + x->firstCorner;
                facets.push_back({corner[0], corner[i], corner[i + 1], n, side});
            }
        }
    }
    return true;
}

} // namespace lightloom
