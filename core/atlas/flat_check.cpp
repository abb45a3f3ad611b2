// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/flat_check.h"
#include <algorithm>
#include <cmath>
#include <tuple>

namespace lightloom {
namespace {

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

/// A piece of the border in the plane.
struct Segment {
    glm::dvec2 a, b;
    std::uint32_t from, to; ///< vertices
};

bool doCross(const Segment& s, const Segment& t)
{
    if (s.from == t.from || s.from == t.to || s.to == t.from || s.to == t.to) return false;
    const double a = cross(s.b - s.a, t.a - s.a), b = cross(s.b - s.a, t.b - s.a);
    const double c = cross(t.b - t.a, s.a - t.a), d = cross(t.b - t.a, s.b - t.a);
    return ((a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0)) && ((c > 0.0 && d < 0.0) || (c < 0.0 && d > 0.0));
}

/// Segments in the cells of a grid that their boxes touch; segments that cross share a cell.
bool anyCross(const std::vector<Segment>& segments)
{
    glm::dvec2 low(segments.front().a), high(low);
    for (const Segment& s : segments) {
        low = glm::min(low, glm::min(s.a, s.b));
        high = glm::max(high, glm::max(s.a, s.b));
    }
    const int cells = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(segments.size()))));
    const glm::dvec2 scale = double(cells) / glm::max(high - low, glm::dvec2(1e-300));
    const auto cell = [&](glm::dvec2 p) {
        return glm::clamp(glm::ivec2((p - low) * scale), glm::ivec2(0), glm::ivec2(cells - 1));
    };
    std::vector<std::vector<std::uint32_t>> grid(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells));
    for (std::uint32_t i = 0; i < segments.size(); ++i) {
        const Segment& s = segments[i];
        const glm::ivec2 from = cell(glm::min(s.a, s.b)), to = cell(glm::max(s.a, s.b));
        for (int y = from.y; y <= to.y; ++y) {
            for (int x = from.x; x <= to.x; ++x) {
                auto& here = grid[static_cast<std::size_t>(y * cells + x)];
                for (const std::uint32_t other : here) {
                    if (doCross(s, segments[other])) return true;
                }
                here.push_back(i);
            }
        }
    }
    return false;
}

struct Edge {
    std::uint32_t low, high;
    bool isRising;
};

/// Directed edges that belong to one triangle alone; sets `isManifold` and `edges`.
std::vector<std::pair<std::uint32_t, std::uint32_t>> openEdges(const SurfaceMesh& mesh, SurfaceBorder& border)
{
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const glm::uvec3 t : mesh.triangles) {
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), a < b});
        }
    }
    std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
        return std::tie(a.low, a.high, a.isRising) < std::tie(b.low, b.high, b.isRising);
    });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open;
    for (std::size_t i = 0; i < edges.size(); ++border.edges) {
        std::size_t end = i + 1;
        while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
        const bool isShared = end - i == 2 && edges[i].isRising != edges[i + 1].isRising;
        if (end - i == 1) {
            const Edge& e = edges[i];
            open.emplace_back(e.isRising ? e.low : e.high, e.isRising ? e.high : e.low);
        } else if (!isShared) {
            border.isManifold = false;
        }
        i = end;
    }
    return open;
}

double loopArea(const std::vector<std::uint32_t>& loop, const std::vector<glm::dvec2>& map)
{
    double twice = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        twice += cross(map[loop[i]] - map[loop[0]], map[loop[(i + 1) % loop.size()]] - map[loop[0]]);
    }
    return 0.5 * twice;
}

/// Singular values of the map of one triangle, largest first; `folds` if it is turned over or has lost its area.
glm::dvec2 singularValues(const SurfaceMesh& mesh, glm::uvec3 t, const std::vector<glm::dvec2>& map, bool& folds)
{
    const glm::dvec3 ab = mesh.positions[t.y] - mesh.positions[t.x], ac = mesh.positions[t.z] - mesh.positions[t.x];
    const double length = glm::length(ab);
    const glm::dvec3 x = ab / length;
    const double along = glm::dot(ac, x), height = glm::length(ac - along * x);
    const glm::dvec2 u = map[t.y] - map[t.x], v = map[t.z] - map[t.x];
    const glm::dvec2 dx = u / length, dy = (v - dx * along) / height; // columns of the Jacobian
    const double determinant = cross(dx, dy);
    folds = !(determinant > 1e-6);
    const double squares = glm::dot(dx, dx) + glm::dot(dy, dy);
    const double apart = std::sqrt(std::max(0.0, squares * squares - 4.0 * determinant * determinant));
    return {std::sqrt(0.5 * (squares + apart)), std::sqrt(std::max(0.0, 0.5 * (squares - apart)))};
}

} // namespace

SurfaceBorder borderOf(const SurfaceMesh& mesh)
{
    SurfaceBorder border;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> open = openEdges(mesh, border);
    if (!border.isManifold) return border;
    std::ranges::sort(open);
    std::vector<std::uint8_t> isUsed(open.size(), 0);
    const auto nextFrom = [&](std::uint32_t v) { // of a vertex that is passed twice, any will do: loops stay closed
        auto e = static_cast<std::size_t>(std::ranges::lower_bound(open, std::pair(v, 0u)) - open.begin());
        while (e < open.size() && open[e].first == v && isUsed[e]) ++e;
        return e < open.size() && open[e].first == v ? e : open.size();
    };
    for (std::size_t start = 0; start < open.size(); ++start) {
        if (start > 0 && open[start].first == open[start - 1].first) border.isPinched = true;
        std::vector<std::uint32_t> loop;
        for (std::size_t e = isUsed[start] ? open.size() : start; e < open.size(); e = nextFrom(open[e].second)) {
            isUsed[e] = 1;
            loop.push_back(open[e].first);
        }
        if (!loop.empty()) border.loops.push_back(std::move(loop));
    }
    return border;
}

bool isSimple(const SurfaceBorder& border, const std::vector<glm::dvec2>& map)
{
    std::vector<Segment> segments;
    int around = 0;
    for (const std::vector<std::uint32_t>& loop : border.loops) {
        around += loopArea(loop, map) > 0.0;
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const std::uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
            segments.push_back({map[a], map[b], a, b});
        }
    }
    return around == 1 && !anyCross(segments);
}

void Stretch::add(const Stretch& other)
{
    area += other.area;
    anisotropySum += other.anisotropySum;
    worstAnisotropy = std::max(worstAnisotropy, other.worstAnisotropy);
    leastScale = std::min(leastScale, other.leastScale);
    mostScale = std::max(mostScale, other.mostScale);
    strayArea += other.strayArea;
    folds = folds || other.folds;
}

Stretch stretchOf(const SurfaceMesh& mesh, const std::vector<glm::dvec2>& map)
{
    Stretch stretch;
    for (const glm::uvec3 t : mesh.triangles) {
        const glm::dvec3 a = mesh.positions[t.x];
        const double area = 0.5 * glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a));
        bool folds = false;
        const glm::dvec2 s = singularValues(mesh, t, map, folds);
        stretch.folds = stretch.folds || folds;
        const double anisotropy = s.x / std::max(s.y, 1e-6);
        stretch.area += area;
        stretch.anisotropySum += area * anisotropy;
        stretch.worstAnisotropy = std::max(stretch.worstAnisotropy, anisotropy);
        stretch.leastScale = std::min(stretch.leastScale, s.y);
        stretch.mostScale = std::max(stretch.mostScale, s.x);
        if (!(s.x <= kStrayScale && s.y >= 1.0 / kStrayScale)) stretch.strayArea += area;
    }
    return stretch;
}

} // namespace lightloom
