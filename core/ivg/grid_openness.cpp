// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_openness.h"
#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <optional>

namespace lightloom {
namespace {

constexpr int kVotes = 4;        ///< of 14 rays
constexpr double kPocket = 0.01; ///< of what rays from a pocket of vertices meet; open rooms have .0005 at most
constexpr int kRows = 4;         ///< of a face, on each side of its vertex
constexpr int kLevels = 2;       ///< of a cell, on each side
constexpr std::size_t kBlock = 256;

constexpr float kFarthest = 255.0f / GridOpenness::kSightUnits; ///< cells along the axes that sight is kept for

/// How near surface is to a vertex: within kFarthest along some axis, within half a cell.
enum Nearness : std::uint8_t { kFar, kSeen, kNear };

/// By vertex: whether a triangle meets the box around it, half a cell or kFarthest to each side.
class NearVertices {
public:
    explicit NearVertices(const GridLattice& lattice) : lattice_(lattice), found_(lattice.vertexCount(), kFar) {}

    void add(const SceneTriangle& t)
    {
        const glm::vec3 a = lattice_.toGrid(t.a), b = lattice_.toGrid(t.b), c = lattice_.toGrid(t.c);
        const glm::vec3 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
        // the plane in grid coordinates, where cells are cubes
        const glm::vec3 normal = glm::cross(b - a, c - a);
        const float reach = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
        const glm::ivec3 first = glm::max(glm::ivec3(glm::ceil(low - kFarthest)), glm::ivec3(0));
        const glm::ivec3 last = glm::min(glm::ivec3(glm::floor(high + kFarthest)), lattice_.cells);
        for (int z = first.z; z <= last.z; ++z) {
            for (int y = first.y; y <= last.y; ++y) {
                for (int x = first.x; x <= last.x; ++x) {
                    const glm::vec3 v(x, y, z);
                    const float off = std::abs(glm::dot(normal, v - a));
                    if (off > reach * kFarthest * 1.001f) continue;
                    const glm::vec3 gap = glm::max(low - v, v - high);
                    const bool isNear = off <= 0.501f * reach && std::max({gap.x, gap.y, gap.z}) <= 0.501f;
                    std::uint8_t& mark = found_[lattice_.index({x, y, z})];
                    mark = std::max<std::uint8_t>(mark, isNear ? kNear : kSeen);
                }
            }
        }
    }
    [[nodiscard]] std::uint8_t of(std::size_t vertex) const { return found_[vertex]; }
    [[nodiscard]] std::size_t nearCount() const
    {
        return static_cast<std::size_t>(std::ranges::count(found_, std::uint8_t{kNear}));
    }

private:
    const GridLattice& lattice_;
    std::vector<std::uint8_t> found_;
};

/// Bits `begin` to `end`, in parts of [0, 1], that an interval touches by more than rounding.
struct Touched {
    int first, last;
    Touched(float begin, float end, int parts)
        : first(std::clamp(static_cast<int>(std::floor(begin * static_cast<float>(parts) + 1e-3f)), 0, parts - 1)),
          last(std::clamp(static_cast<int>(std::ceil(end * static_cast<float>(parts) - 1e-3f)) - 1, 0, parts - 1))
    {
    }
};

class Finder {
public:
    Finder(const RayScene& rays, const LightReach& reach, const GridLattice& lattice, const NearVertices& near,
           GridOpenness& result)
        : rays_(rays), lattice_(lattice), near_(near), result_(result), isReached_(2 * rays.triangleCount(), 0),
          votes_(lattice.vertexCount())
    {
        for (const ReachedFacet& facet : reach.facets()) isReached_[facet.side] = 1;
    }

    void look(std::size_t index)
    {
        const glm::ivec3 vertex = lattice_.vertex(index);
        const glm::vec3 p = lattice_.position(vertex);
        votes_[index] = votesAt(p);
        if (votes_[index].areBehindWall()) {
            shut(index);
            return;
        }
        if (near_.of(index) == kFar) return;
        Spans free;
        for (int axis = 0; axis < 3; ++axis) {
            for (const bool isHigh : {false, true}) {
                const float seen = sightFrom(p, axis, isHigh, kFarthest);
                const std::size_t way = static_cast<std::size_t>(2 * axis + (isHigh ? 1 : 0));
                result_.sight[index][way] = static_cast<std::uint8_t>(seen * GridOpenness::kSightUnits);
                free[way] = std::min(seen, halfOf(vertex, axis, isHigh));
            }
        }
        if (near_.of(index) != kNear) return;
        for (int axis = 0; axis < 3; ++axis) {
            const Open open = openFace(p, vertex, axis, free);
            result_.faceShare[index][axis] = std::min(open.share, 1.0f);
            result_.faceParts[index][static_cast<std::size_t>(axis)] = open.parts;
        }
        const Open open = openCell(p, vertex, free);
        result_.cellShare[index] = std::min(open.share, 1.0f);
        result_.cellParts[index] = open.parts;
    }

    /// Shuts pockets: vertices that see none but each other, and together much surface that light cannot reach. Surface
    /// of small triangles is reached as a whole, also where it goes on through a floor, and lends votes to what lies
    /// beneath.
    void shutPockets()
    {
        std::vector<std::uint8_t> isSeen(votes_.size(), 0);
        std::vector<std::size_t> pocket;
        for (std::size_t first = 0; first < votes_.size(); ++first) {
            if (isSeen[first] != 0 || result_.isOpen[first] == 0) continue;
            pocket.assign(1, first);
            isSeen[first] = 1;
            std::size_t reached = 0, unreached = 0;
            for (std::size_t k = 0; k < pocket.size(); ++k) {
                reached += votes_[pocket[k]].reached, unreached += votes_[pocket[k]].unreached;
                for (std::size_t way = 0; way < 6; ++way) {
                    const std::optional<std::size_t> next = seesNext(pocket[k], way);
                    if (!next || isSeen[*next] != 0) continue;
                    isSeen[*next] = 1;
                    pocket.push_back(*next);
                }
            }
            if (static_cast<double>(unreached) < kPocket * static_cast<double>(reached + unreached)) continue;
            if (unreached > 0) std::ranges::for_each(pocket, [&](std::size_t index) { shut(index); });
        }
    }

private:
    /// What rays from a vertex met.
    struct Votes {
        std::uint8_t reached = 0, unreached = 0;
        [[nodiscard]] bool areBehindWall() const { return unreached >= kVotes || unreached >= reached; }
    };
    using Spans = std::array<float, 6>; ///< along -x +x -y ..., cells
    struct Open {
        float share = 0.0f;
        std::uint64_t parts = 0;

        /// Of a face, what lies in [u0, u1] x [v0, v1], cells from the vertex.
        void addParts(float u0, float u1, float v0, float v1)
        {
            if (u0 >= u1 || v0 >= v1) return;
            const Touched us(0.5f + u0, 0.5f + u1, GridOpenness::kParts),
                vs(0.5f + v0, 0.5f + v1, GridOpenness::kParts);
            for (int j = vs.first; j <= vs.last; ++j) {
                for (int i = us.first; i <= us.last; ++i) parts |= std::uint64_t{1} << (i + GridOpenness::kParts * j);
            }
        }
    };

    void shut(std::size_t index)
    {
        result_.isOpen[index] = 0;
        result_.faceShare[index] = glm::vec3(0.0f);
        result_.cellShare[index] = 0.0f;
    }
    /// The next open vertex along a signed axis, where both see each other.
    [[nodiscard]] std::optional<std::size_t> seesNext(std::size_t index, std::size_t way) const
    {
        glm::ivec3 to = lattice_.vertex(index);
        to[static_cast<int>(way / 2)] += way % 2 == 0 ? -1 : 1;
        if (to != glm::clamp(to, glm::ivec3(0), lattice_.cells)) return {};
        const std::size_t next = lattice_.index(to);
        const auto seesCell = [&](std::size_t from, std::size_t along) {
            return static_cast<float>(result_.sight[from][along]) >= GridOpenness::kSightUnits;
        };
        const bool isNext = result_.isOpen[next] != 0 && seesCell(index, way) && seesCell(next, way ^ 1);
        return isNext ? std::optional(next) : std::nullopt;
    }

    [[nodiscard]] Votes votesAt(glm::vec3 p) const
    {
        Votes votes;
        const auto ask = [&](glm::vec3 way) {
            Hit hit;
            if (!rays_.intersect(p, way, std::numeric_limits<float>::infinity(), hit)) return;
            ++(isReached_[2 * hit.triangle + (hit.isFront ? 0 : 1)] ? votes.reached : votes.unreached);
        };
        // of a cube to its sides and corners, turned: along axes rays would run into edges of what stands square
        const glm::mat3 turned = glm::mat3_cast(glm::normalize(glm::quat(1.0f, 0.31f, 0.17f, 0.43f)));
        for (int axis = 0; axis < 3; ++axis) {
            ask(turned[axis]);
            ask(-turned[axis]);
        }
        const float part = 1.0f / std::sqrt(3.0f);
        for (int corner = 0; corner < 8; ++corner)
            ask(turned * glm::vec3(corner & 1 ? part : -part, corner & 2 ? part : -part, corner & 4 ? part : -part));
        return votes;
    }

    /// Half a cell, or nothing beyond the grid's border.
    [[nodiscard]] float halfOf(glm::ivec3 vertex, int axis, bool isHigh) const
    {
        return vertex[axis] == (isHigh ? lattice_.cells[axis] : 0) ? 0.0f : 0.5f;
    }

    /// Cells along an axis up to the next surface, at most `most`.
    [[nodiscard]] float sightFrom(glm::vec3 p, int axis, bool isHigh, float most) const
    {
        if (most <= 0.0f) return 0.0f;
        glm::vec3 way(0.0f);
        way[axis] = isHigh ? 1.0f : -1.0f;
        Hit hit;
        const float cell = lattice_.cellSize[axis];
        return rays_.intersect(p, way, most * cell, hit) ? std::min(hit.distance / cell, most) : most;
    }

    /// `p` moved along an axis.
    [[nodiscard]] glm::vec3 moved(glm::vec3 p, int axis, float cells) const
    {
        p[axis] += cells * lattice_.cellSize[axis];
        return p;
    }

    /// Calls visit(q, height, begin, end) for rows across the free span along `axis`, `count` on each side of `p`: a
    /// point in the row's middle, and what the row covers, in cells from `p`.
    template<class Visit>
    void rows(glm::vec3 p, int axis, float before, float behind, int count, const Visit& visit) const
    {
        for (const float span : {-before, behind}) {
            if (span == 0.0f) continue;
            for (int row = 0; row < count; ++row) {
                const float a = span * static_cast<float>(row) / static_cast<float>(count);
                const float b = span * static_cast<float>(row + 1) / static_cast<float>(count);
                visit(moved(p, axis, 0.5f * (a + b)), std::abs(b - a), std::min(a, b), std::max(a, b));
            }
        }
    }

    /// Rows along v from the vertex, each as far as it goes along u; where a wall ends them early, also what columns
    /// along u reach beyond: behind a slanted wall there is more. Exact for one straight wall but for the width of
    /// rows.
    [[nodiscard]] Open openFace(glm::vec3 p, glm::ivec3 vertex, int axis, const Spans& free) const
    {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const auto half = [&](int along, bool isHigh) { return halfOf(vertex, along, isHigh); };
        const auto freeOf = [&](int along, bool isHigh) {
            return free[static_cast<std::size_t>(2 * along + (isHigh ? 1 : 0))];
        };
        Open open;
        rows(p, v, freeOf(v, false), freeOf(v, true), kRows, [&](glm::vec3 q, float height, float begin, float end) {
            const float low = sightFrom(q, u, false, half(u, false)), high = sightFrom(q, u, true, half(u, true));
            open.share += height * (low + high);
            open.addParts(-low, high, begin, end);
        });
        const bool isCut = freeOf(v, false) < half(v, false) || freeOf(v, true) < half(v, true);
        if (isCut) {
            rows(p, u, freeOf(u, false), freeOf(u, true), kRows, [&](glm::vec3 q, float width, float begin, float end) {
                const float low = sightFrom(q, v, false, half(v, false)), high = sightFrom(q, v, true, half(v, true));
                open.share += width * (std::max(low - freeOf(v, false), 0.0f) + std::max(high - freeOf(v, true), 0.0f));
                open.addParts(begin, end, -low, high);
            });
        }
        open.share /= (half(u, false) + half(u, true)) * (half(v, false) + half(v, true));
        return open;
    }

    [[nodiscard]] Open openCell(glm::vec3 p, glm::ivec3 vertex, const Spans& free) const
    {
        Open open;
        float whole = 1.0f;
        for (int axis = 0; axis < 3; ++axis) whole *= halfOf(vertex, axis, false) + halfOf(vertex, axis, true);
        rows(p, 2, free[4], free[5], kLevels, [&](glm::vec3 level, float depth, float z0, float z1) {
            const float before = sightFrom(level, 1, false, halfOf(vertex, 1, false));
            const float behind = sightFrom(level, 1, true, halfOf(vertex, 1, true));
            rows(level, 1, before, behind, kLevels, [&](glm::vec3 q, float height, float y0, float y1) {
                const float low = sightFrom(q, 0, false, halfOf(vertex, 0, false));
                const float high = sightFrom(q, 0, true, halfOf(vertex, 0, true));
                open.share += depth * height * (low + high);
                const Touched xs(0.5f - low, 0.5f + high, 4), ys(0.5f + y0, 0.5f + y1, 4), zs(0.5f + z0, 0.5f + z1, 4);
                for (int z = zs.first; z <= zs.last; ++z) {
                    for (int y = ys.first; y <= ys.last; ++y) {
                        for (int x = xs.first; x <= xs.last; ++x)
                            open.parts |= std::uint64_t{1} << (x + 4 * y + 16 * z);
                    }
                }
            });
        });
        open.share /= whole;
        return open;
    }

    const RayScene& rays_;
    const GridLattice& lattice_;
    const NearVertices& near_;
    GridOpenness& result_;
    std::vector<std::uint8_t> isReached_; // by side
    std::vector<Votes> votes_;            // by vertex
};

} // namespace

GridOpenness GridOpenness::everything(const GridLattice& lattice)
{
    constexpr std::uint64_t kAll = ~std::uint64_t{0};
    const std::size_t count = lattice.vertexCount();
    GridOpenness all;
    all.isOpen.assign(count, 1);
    all.faceShare.assign(count, glm::vec3(1.0f));
    all.cellShare.assign(count, 1.0f);
    all.faceParts.assign(count, {kAll, kAll, kAll});
    all.cellParts.assign(count, kAll);
    all.sight.assign(count, {255, 255, 255, 255, 255, 255});
    return all;
}

std::shared_ptr<const GridOpenness> findOpenness(const RayScene& rays, const LightReach& reach,
                                                 const GridLattice& lattice, Workers& workers,
                                                 const std::stop_token& stop)
{
    const auto result = std::make_shared<GridOpenness>(GridOpenness::everything(lattice));
    NearVertices near(lattice);
    for (std::uint32_t i = 0; i < rays.triangleCount(); ++i) {
        if (i % 4096 == 0 && stop.stop_requested()) return nullptr;
        near.add(rays.triangle(i));
    }
    result->nearVertices = near.nearCount();
    Finder finder(rays, reach, lattice, near, *result);
    const std::size_t count = lattice.vertexCount();
    const bool all = workers.run((count + kBlock - 1) / kBlock, stop, [&](std::size_t block) {
        for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) finder.look(i);
    });
    if (!all) return nullptr;
    finder.shutPockets();
    return result;
}

} // namespace lightloom
