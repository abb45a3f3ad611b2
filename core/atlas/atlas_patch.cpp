// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/atlas_patch.h"
#include <algorithm>
#include <limits>
#include <queue>
#include <tuple>

namespace lightloom {
namespace {

using Neighbours = std::array<std::int32_t, 3>;

constexpr double kBendCost = 8.0; ///< a step across a right angle is so many times longer, plus one

/// Numbers the positions of the corners; equal positions share one.
void weld(const std::vector<std::array<glm::vec3, 3>>& faces, PatchMesh& mesh)
{
    std::vector<std::uint32_t> order(3 * faces.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    const auto at = [&](std::uint32_t i) { return faces[i / 3][i % 3]; };
    const auto key = [&](std::uint32_t i) { return std::tuple(at(i).x, at(i).y, at(i).z); };
    std::ranges::sort(order,
                      [&](std::uint32_t a, std::uint32_t b) { return std::tuple(key(a), a) < std::tuple(key(b), b); });
    mesh.corners.resize(faces.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || key(order[i]) != key(order[i - 1])) mesh.positions.emplace_back(at(order[i]));
        mesh.corners[order[i] / 3][static_cast<int>(order[i] % 3)] =
            static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }
}

/// The edge from corner `k` of a face, and where it belongs.
struct HalfEdge {
    std::uint32_t low, high, face;
    int k;
    bool isRising; ///< runs from the lower vertex to the higher one
};

std::vector<HalfEdge> sortedEdges(const PatchMesh& mesh)
{
    std::vector<HalfEdge> edges;
    edges.reserve(3 * mesh.corners.size());
    for (std::uint32_t f = 0; f < mesh.corners.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.corners[f][k], b = mesh.corners[f][(k + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), f, k, a < b});
        }
    }
    std::ranges::sort(edges, [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high, a.face, a.k) < std::tie(b.low, b.high, b.face, b.k);
    });
    return edges;
}

std::vector<Neighbours> joinedNeighbours(const PatchMesh& mesh)
{
    std::vector<Neighbours> neighbours(mesh.corners.size(), Neighbours{-1, -1, -1});
    const std::vector<HalfEdge> edges = sortedEdges(mesh);
    for (std::size_t first = 0, last; first < edges.size(); first = last) {
        for (last = first; last < edges.size(); ++last) {
            if (edges[last].low != edges[first].low || edges[last].high != edges[first].high) break;
        }
        if (last - first != 2) continue;
        const HalfEdge &a = edges[first], &b = edges[first + 1];
        if (a.isRising == b.isRising || glm::dot(mesh.normals[a.face], mesh.normals[b.face]) < kCreaseCosine) continue;
        neighbours[a.face][static_cast<std::size_t>(a.k)] = static_cast<std::int32_t>(b.face);
        neighbours[b.face][static_cast<std::size_t>(b.k)] = static_cast<std::int32_t>(a.face);
    }
    return neighbours;
}

/// The part of a patch whose faces have `owner`, renumbered.
Patch part(const Patch& whole, const std::vector<std::uint32_t>& owners, std::uint32_t owner)
{
    Patch found;
    found.mesh = whole.mesh;
    std::vector<std::int32_t> numbers(owners.size(), -1);
    for (std::size_t f = 0; f < owners.size(); ++f) {
        if (owners[f] != owner) continue;
        numbers[f] = static_cast<std::int32_t>(found.faces.size());
        found.faces.push_back(whole.faces[f]);
    }
    found.neighbours.reserve(found.faces.size());
    for (std::size_t f = 0; f < owners.size(); ++f) {
        if (numbers[f] < 0) continue;
        Neighbours mapped = whole.neighbours[f];
        for (std::int32_t& n : mapped) n = n < 0 ? -1 : numbers[static_cast<std::size_t>(n)];
        found.neighbours.push_back(mapped);
    }
    return found;
}

/// Distances over the faces of a patch.
class Growth {
public:
    explicit Growth(const Patch& patch) : patch_(patch)
    {
        for (const std::uint32_t f : patch.faces) {
            const glm::uvec3 c = patch.mesh->corners[f];
            centres_.push_back((corner(c.x) + corner(c.y) + corner(c.z)) / 3.0);
        }
    }

    /// Grows regions from `seeds` until they meet; `owners` gets the number of each face's seed.
    void run(const std::vector<std::uint32_t>& seeds)
    {
        distances_.assign(centres_.size(), std::numeric_limits<double>::infinity());
        owners_.assign(centres_.size(), 0);
        std::priority_queue<Step, std::vector<Step>, std::greater<>> queue;
        for (std::uint32_t s = 0; s < seeds.size(); ++s) queue.emplace(0.0, seeds[s], s);
        while (!queue.empty()) {
            const auto [distance, face, owner] = queue.top();
            queue.pop();
            if (!(distance < distances_[face])) continue;
            distances_[face] = distance;
            owners_[face] = owner;
            for (int k = 0; k < 3; ++k) {
                const std::int32_t next = patch_.neighbours[face][static_cast<std::size_t>(k)];
                if (next < 0) continue;
                const auto n = static_cast<std::uint32_t>(next);
                const double there = distance + step(face, n, k);
                if (there < distances_[n]) queue.emplace(there, n, owner);
            }
        }
    }

    [[nodiscard]] std::uint32_t farthest() const
    {
        return static_cast<std::uint32_t>(std::ranges::max_element(distances_) - distances_.begin());
    }

    /// The face of a region that lies nearest to the region's centre of mass.
    [[nodiscard]] std::uint32_t middle(std::uint32_t owner) const
    {
        glm::dvec3 sum(0.0);
        double area = 0.0;
        for (std::size_t f = 0; f < owners_.size(); ++f) {
            if (owners_[f] != owner) continue;
            sum += centres_[f] * areaOf(f);
            area += areaOf(f);
        }
        std::size_t best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t f = 0; f < owners_.size(); ++f) {
            const double away = glm::length(centres_[f] - sum / area);
            if (owners_[f] != owner || !(away < least)) continue;
            least = away;
            best = f;
        }
        return static_cast<std::uint32_t>(best);
    }

    [[nodiscard]] const std::vector<std::uint32_t>& owners() const { return owners_; }

private:
    using Step = std::tuple<double, std::uint32_t, std::uint32_t>; // distance, face, seed

    [[nodiscard]] glm::dvec3 corner(std::uint32_t v) const { return patch_.mesh->positions[v]; }
    [[nodiscard]] double areaOf(std::size_t f) const { return patch_.mesh->areas[patch_.faces[f]]; }

    [[nodiscard]] double step(std::uint32_t from, std::uint32_t to, int edge) const
    {
        const std::uint32_t f = patch_.faces[from], t = patch_.faces[to];
        const glm::uvec3 c = patch_.mesh->corners[f];
        const glm::dvec3 gate = 0.5 * (corner(c[edge]) + corner(c[(edge + 1) % 3]));
        const double length = glm::length(gate - centres_[from]) + glm::length(gate - centres_[to]);
        return length * (1.0 + kBendCost * (1.0 - glm::dot(patch_.mesh->normals[f], patch_.mesh->normals[t])));
    }

    const Patch& patch_;
    std::vector<glm::dvec3> centres_;
    std::vector<double> distances_;
    std::vector<std::uint32_t> owners_;
};

} // namespace

PatchMesh patchMesh(const RayScene& rays, const std::vector<std::uint32_t>& sides)
{
    PatchMesh mesh;
    std::vector<std::array<glm::vec3, 3>> faces;
    for (const std::uint32_t side : sides) {
        const SceneTriangle& t = rays.triangle(side / 2);
        const glm::dvec3 a(t.a), across = glm::cross(glm::dvec3(t.b) - a, glm::dvec3(t.c) - a);
        const double twice = glm::length(across);
        if (!(twice > 0.0) || rays.triangleNormal(side / 2) == glm::vec3(0.0f)) continue;
        // in mirrored instances a, b, c run clockwise as seen from the front
        const bool isClockwise = glm::dot(across, glm::dvec3(rays.triangleNormal(side / 2))) < 0.0;
        const bool isTurned = isClockwise != (side % 2 != 0);
        faces.push_back(isTurned ? std::array{t.a, t.c, t.b} : std::array{t.a, t.b, t.c});
        mesh.sides.push_back(side);
        mesh.isTurned.push_back(isTurned);
        mesh.normals.push_back(across / (isTurned ? -twice : twice));
        mesh.areas.push_back(0.5 * twice);
    }
    weld(faces, mesh);
    return mesh;
}

std::vector<Patch> connectedPatches(const PatchMesh& mesh)
{
    const std::vector<Neighbours> all = joinedNeighbours(mesh);
    std::vector<std::int32_t> numbers(all.size(), -1); // within its patch
    std::vector<Patch> patches;
    for (std::uint32_t start = 0; start < all.size(); ++start) {
        if (numbers[start] >= 0) continue;
        Patch patch;
        patch.mesh = &mesh;
        numbers[start] = 0;
        patch.faces.push_back(start);
        for (std::size_t i = 0; i < patch.faces.size(); ++i) {
            for (const std::int32_t n : all[patch.faces[i]]) {
                if (n < 0 || numbers[static_cast<std::size_t>(n)] >= 0) continue;
                numbers[static_cast<std::size_t>(n)] = 0;
                patch.faces.push_back(static_cast<std::uint32_t>(n));
            }
        }
        std::ranges::sort(patch.faces);
        for (std::size_t i = 0; i < patch.faces.size(); ++i) numbers[patch.faces[i]] = static_cast<std::int32_t>(i);
        for (const std::uint32_t f : patch.faces) {
            Neighbours mapped = all[f];
            for (std::int32_t& n : mapped) n = n < 0 ? -1 : numbers[static_cast<std::size_t>(n)];
            patch.neighbours.push_back(mapped);
        }
        patches.push_back(std::move(patch));
    }
    return patches;
}

std::pair<Patch, Patch> halved(const Patch& patch)
{
    Growth growth(patch);
    growth.run({0});
    const std::uint32_t one = growth.farthest();
    growth.run({one});
    const std::uint32_t other = growth.farthest();
    growth.run({one, other});
    const std::uint32_t a = growth.middle(0), b = growth.middle(1);
    if (a != b) growth.run({a, b}); // once more from the middle of each half: rounder pieces
    return {part(patch, growth.owners(), 0), part(patch, growth.owners(), 1)};
}

} // namespace lightloom
