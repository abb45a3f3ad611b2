// SPDX-License-Identifier: Apache-2.0
#include "core/trace/light_reach.h"
#include "core/base/sampling.h"
#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <numeric>
#include <tuple>

namespace lightloom {
namespace {

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

/// Number of each triangle corner among the distinct positions of the scene.
std::vector<std::uint32_t> weld(const RayScene& rays)
{
    struct Corner {
        glm::uvec3 bits;
        std::uint32_t number;
    };
    std::vector<Corner> corners;
    corners.reserve(std::size_t(3) * rays.triangleCount());
    const auto bitsOf = [](float v) { return std::bit_cast<std::uint32_t>(v == 0.0f ? 0.0f : v); }; // -0 is 0
    for (std::uint32_t t = 0; t < rays.triangleCount(); ++t) {
        const SceneTriangle& triangle = rays.triangle(t);
        for (const glm::vec3 p : {triangle.a, triangle.b, triangle.c}) {
            corners.push_back({{bitsOf(p.x), bitsOf(p.y), bitsOf(p.z)}, static_cast<std::uint32_t>(corners.size())});
        }
    }
    const auto key = [](const Corner& c) { return std::tie(c.bits.x, c.bits.y, c.bits.z); };
    std::ranges::sort(corners, [&](const Corner& a, const Corner& b) { return key(a) < key(b); });
    std::vector<std::uint32_t> welded(corners.size());
    std::uint32_t vertex = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (i > 0 && key(corners[i]) != key(corners[i - 1])) ++vertex;
        welded[corners[i].number] = vertex;
    }
    return welded;
}

std::vector<Edge> listEdges(const RayScene& rays)
{
    const std::vector<std::uint32_t> vertex = weld(rays);
    std::vector<Edge> edges;
    edges.reserve(vertex.size());
    for (std::uint32_t t = 0; t < rays.triangleCount(); ++t) {
        const bool mirrored = rays.scene().instances[rays.triangle(t).instance].isMirrored();
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t a = vertex[3 * t + i], b = vertex[3 * t + (i + 1) % 3];
            if (a != b) edges.push_back({std::min(a, b), std::max(a, b), t, (a < b) != mirrored});
        }
    }
    std::sort(edges.begin(), edges.end());
    return edges;
}

/// Joins the sides of triangles that share an edge. Where three or more meet (a partition on a floor) nothing is
/// joined.
Surfaces joinSides(const RayScene& rays)
{
    Surfaces surfaces(2 * rays.triangleCount());
    const std::vector<Edge> edges = listEdges(rays);
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i + 1;
        while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
        if (end - i == 2) {
            const Edge &a = edges[i], &b = edges[i + 1];
            const std::uint32_t flip =
                a.rises == b.rises ? 1 : 0; // wound alike: one's front continues as the other's back
            surfaces.join(2 * a.triangle, 2 * b.triangle + flip);
            surfaces.join(2 * a.triangle + 1, 2 * b.triangle + (1 - flip));
        }
        i = end;
    }
    return surfaces;
}

constexpr std::uint32_t kExplorers = 2048, kExplorerBounces = 8;
constexpr std::uint32_t kEnoughHits = 3; ///< a single ray can leak through a vertex; three do not

class Explorer {
public:
    Explorer(const RayScene& rays, const LightSampler& lights, Surfaces& surfaces)
        : rays_(rays), lights_(lights), surface_(2 * rays.triangleCount()), hits_(2 * rays.triangleCount())
    {
        for (std::uint32_t s = 0; s < surface_.size(); ++s) surface_[s] = surfaces.of(s);
        for (std::uint32_t s = 0; s < surface_.size(); ++s) sidesOf_.emplace_back(surface_[s], s);
        std::ranges::sort(sidesOf_);
    }

    /// Random walks from every lamp that lose nothing at the walls.
    bool walkFromLamps(Workers& workers, const std::stop_token& stop)
    {
        const std::size_t groups = rays_.scene().groups.size();
        constexpr std::uint32_t perBlock = 256;
        return workers.run(groups * (kExplorers / perBlock), stop, [&](std::size_t block) {
            const int group = static_cast<int>(block / (kExplorers / perBlock));
            const std::uint64_t first = (block % (kExplorers / perBlock)) * perBlock;
            for (std::uint64_t i = first; i < first + perBlock; ++i) walk(group, i);
        });
    }

    /// Surfaces not reached yet look around; those that see reached ones are reached. Repeats until nothing changes.
    bool lookAround(Workers& workers, const std::stop_token& stop)
    {
        collect();
        for (int round = 0; round < 32; ++round) {
            const std::vector<std::size_t> open = openSurfaces();
            if (open.empty()) return true;
            std::vector<std::uint8_t> sees(open.size(), 0);
            const std::size_t each = std::clamp<std::size_t>((1u << 20) / open.size(), 16, 256);
            const bool all = workers.run(open.size(), stop, [&](std::size_t i) {
                sees[i] = seesReached(open[i], each, static_cast<std::uint64_t>(round)) ? 1 : 0;
            });
            if (!all) return false;
            bool changed = false;
            for (std::size_t i = 0; i < open.size(); ++i) {
                if (!sees[i]) continue;
                reached_[sidesOf_[open[i]].first] = 1;
                changed = true;
            }
            if (!changed) return true;
        }
        return true;
    }

    [[nodiscard]] std::vector<std::uint8_t> result() const
    {
        std::vector<std::uint8_t> sides(surface_.size());
        for (std::size_t s = 0; s < sides.size(); ++s) sides[s] = reached_[surface_[s]];
        return sides;
    }

private:
    void walk(int group, std::uint64_t number)
    {
        Rng rng(0, rays_.scene().groups[static_cast<std::size_t>(group)].key() ^ hashName("light reach"), number);
        EmittedPhoton photon;
        if (!lights_.emit(group, rng, photon)) return;
        glm::vec3 origin = photon.position, travel = photon.travel;
        for (std::uint32_t bounce = 0; bounce < kExplorerBounces; ++bounce) {
            Hit hit;
            if (!rays_.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) return;
            hits_[surface_[sideOf(hit)]].fetch_add(1, std::memory_order_relaxed);
            const float u1 = rng.uniform(), u2 = rng.uniform();
            travel = Frame(hit.facing()).toWorld(sampleCosineHemisphere(u1, u2));
            origin = rays_.leave(hit.position, hit.facing());
        }
    }

    static std::uint32_t sideOf(const Hit& hit) { return 2 * hit.triangle + (hit.isFront ? 0 : 1); }

    void collect()
    {
        reached_.assign(surface_.size(), 0);
        for (std::size_t s = 0; s < surface_.size(); ++s) reached_[s] = hits_[s] >= kEnoughHits ? 1 : 0;
    }

    /// Where in `sidesOf_` the unreached surfaces begin.
    [[nodiscard]] std::vector<std::size_t> openSurfaces() const
    {
        std::vector<std::size_t> open;
        for (std::size_t i = 0; i < sidesOf_.size(); ++i) {
            const bool begins = i == 0 || sidesOf_[i].first != sidesOf_[i - 1].first;
            if (begins && !reached_[sidesOf_[i].first]) open.push_back(i);
        }
        return open;
    }

    [[nodiscard]] bool seesReached(std::size_t begin, std::size_t count, std::uint64_t round) const
    {
        std::size_t end = begin;
        while (end < sidesOf_.size() && sidesOf_[end].first == sidesOf_[begin].first) ++end;
        std::uint32_t seen = 0;
        for (std::size_t i = 0; i < count && seen < kEnoughHits; ++i) {
            Rng rng(round, hashName("light reach"), (std::uint64_t(begin) << 20) + i);
            const std::uint32_t side = sidesOf_[begin + rng.bits() % (end - begin)].second;
            const SceneTriangle& t = rays_.triangle(side / 2);
            const glm::vec3 normal = rays_.triangleNormal(side / 2) * (side % 2 ? -1.0f : 1.0f);
            if (normal == glm::vec3(0.0f)) continue;
            const float u1 = rng.uniform(), u2 = rng.uniform();
            const glm::vec2 b = sampleTriangle(u1, u2);
            const glm::vec3 p = t.a * (1.0f - b.x - b.y) + t.b * b.x + t.c * b.y;
            const float v1 = rng.uniform(), v2 = rng.uniform();
            const glm::vec3 travel = Frame(normal).toWorld(sampleCosineHemisphere(v1, v2));
            Hit hit;
            if (rays_.intersect(rays_.leave(p, normal), travel, std::numeric_limits<float>::infinity(), hit) &&
                reached_[surface_[sideOf(hit)]]) {
                ++seen;
            }
        }
        return seen >= kEnoughHits;
    }

    const RayScene& rays_;
    const LightSampler& lights_;
    std::vector<std::uint32_t> surface_;                           // of each side
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sidesOf_; // (surface, side), sorted
    std::vector<std::atomic<std::uint32_t>> hits_;
    std::vector<std::uint8_t> reached_; // of each surface
};

} // namespace

std::shared_ptr<const LightReach> LightReach::find(const RayScene& rays, const LightSampler& lights, Workers& workers,
                                                   const std::stop_token& stop)
{
    auto reach = std::make_shared<LightReach>();
    if (rays.scene().groups.empty()) {
        reach->sides_.assign(std::size_t(2) * rays.triangleCount(), 1);
        return reach;
    }
    Surfaces surfaces = joinSides(rays);
    Explorer explorer(rays, lights, surfaces);
    if (!explorer.walkFromLamps(workers, stop) || !explorer.lookAround(workers, stop)) return nullptr;
    reach->sides_ = explorer.result();
    return reach;
}

std::vector<SurfacePoint> samplePoints(const RayScene& rays, const LightReach& reach, std::uint64_t count,
                                       std::uint64_t seed)
{
    std::vector<double> sums; // running area over the sides that count
    std::vector<std::uint32_t> sides;
    double total = 0.0;
    for (std::uint32_t side = 0; side < 2 * rays.triangleCount(); ++side) {
        const std::uint32_t t = side / 2;
        const bool counts = side % 2 ? reach.back(t) : reach.front(t);
        const double area = counts ? static_cast<double>(rays.triangleArea(t)) : 0.0;
        if (!(area > 0.0)) continue;
        total += area;
        sums.push_back(total);
        sides.push_back(side);
    }
    std::vector<SurfacePoint> points;
    if (sides.empty()) return points;
    points.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        Rng rng(seed, hashName("probe points"), i);
        const auto at = std::ranges::upper_bound(sums, rng.uniformDouble() * total) - sums.begin();
        const std::uint32_t side = sides[std::min<std::size_t>(static_cast<std::size_t>(at), sides.size() - 1)];
        const SceneTriangle& t = rays.triangle(side / 2);
        const float u1 = rng.uniform(), u2 = rng.uniform();
        const glm::vec2 b = sampleTriangle(u1, u2);
        points.push_back({t.a * (1.0f - b.x - b.y) + t.b * b.x + t.c * b.y,
                          rays.triangleNormal(side / 2) * (side % 2 ? -1.0f : 1.0f), side / 2});
    }
    return points;
}

} // namespace lightloom
