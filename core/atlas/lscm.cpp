// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/lscm.h"
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <cmath>

namespace lightloom {
namespace {

/// The two vertices that lie farthest apart along the longest axis of the bound.
std::array<std::uint32_t, 2> farVertices(const std::vector<glm::dvec3>& positions)
{
    std::array<std::uint32_t, 2> best{0, 0};
    double longest = -1.0;
    for (int axis = 0; axis < 3; ++axis) {
        std::uint32_t low = 0, high = 0;
        for (std::uint32_t v = 0; v < positions.size(); ++v) {
            if (positions[v][axis] < positions[low][axis]) low = v;
            if (positions[v][axis] > positions[high][axis]) high = v;
        }
        const double length = positions[high][axis] - positions[low][axis];
        if (length > longest) longest = length, best = {low, high};
    }
    return best;
}

/// Corners of a triangle in its own plane: the first at the origin, the second on the x axis.
std::array<glm::dvec2, 3> flat(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c)
{
    const glm::dvec3 ab = b - a, ac = c - a;
    const double length = glm::length(ab);
    const glm::dvec3 x = ab / length;
    const double along = glm::dot(ac, x);
    return {glm::dvec2(0.0), glm::dvec2(length, 0.0), glm::dvec2(along, glm::length(ac - along * x))};
}

} // namespace

std::optional<std::vector<glm::dvec2>> conformalMap(const SurfaceMesh& mesh)
{
    using Matrix = Eigen::SparseMatrix<double>;
    const std::size_t vertices = mesh.positions.size();
    const std::array<std::uint32_t, 2> pins = farVertices(mesh.positions);
    if (pins[0] == pins[1]) return {};
    const double apart = glm::length(mesh.positions[pins[1]] - mesh.positions[pins[0]]);
    const std::array<glm::dvec2, 2> pinned{glm::dvec2(0.0), glm::dvec2(apart, 0.0)};

    std::vector<int> unknown(vertices, -1);
    int unknowns = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
        if (v != pins[0] && v != pins[1]) unknown[v] = unknowns++;
    }

    // One complex equation per triangle: sum over corners of W_j (u_j + i v_j) = 0, W_j the edge opposite corner j over
    // the root of twice the area. Pinned corners go to the right-hand side.
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(mesh.triangles.size() * 12);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(2 * mesh.triangles.size()));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::uvec3 c = mesh.triangles[t];
        const std::array<glm::dvec2, 3> p = flat(mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z]);
        const double twiceArea = p[1].x * p[2].y;
        if (!(twiceArea > 0.0)) continue;
        const auto re = static_cast<int>(2 * t), im = re + 1;
        for (int j = 0; j < 3; ++j) {
            const glm::dvec2 w = (p[static_cast<std::size_t>((j + 2) % 3)] - p[static_cast<std::size_t>((j + 1) % 3)]) /
                                 std::sqrt(twiceArea);
            if (const int k = unknown[c[j]]; k >= 0) {
                entries.emplace_back(re, 2 * k, w.x), entries.emplace_back(re, 2 * k + 1, -w.y);
                entries.emplace_back(im, 2 * k, w.y), entries.emplace_back(im, 2 * k + 1, w.x);
            } else {
                const glm::dvec2 u = pinned[c[j] == pins[0] ? 0 : 1];
                right[re] -= w.x * u.x - w.y * u.y;
                right[im] -= w.y * u.x + w.x * u.y;
            }
        }
    }
    Matrix equations(right.size(), 2 * unknowns);
    equations.setFromTriplets(entries.begin(), entries.end());
    const Matrix normal = equations.transpose() * equations;
    Eigen::SimplicialLDLT<Matrix> solver(normal);
    if (solver.info() != Eigen::Success) return {};
    const Eigen::VectorXd solved = solver.solve(equations.transpose() * right);
    if (solver.info() != Eigen::Success || !solved.allFinite()) return {};

    std::vector<glm::dvec2> map(vertices);
    for (std::size_t v = 0; v < vertices; ++v) {
        const int k = unknown[v];
        map[v] = k >= 0 ? glm::dvec2(solved[2 * k], solved[2 * k + 1]) : pinned[v == pins[0] ? 0 : 1];
    }
    return map;
}

std::vector<glm::dvec2> projected(const SurfaceMesh& mesh, glm::dvec3 normal)
{
    const glm::dvec3 axis = std::abs(normal.x) < 0.6 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 x = glm::normalize(glm::cross(axis, normal)), y = glm::cross(normal, x);
    std::vector<glm::dvec2> map;
    map.reserve(mesh.positions.size());
    for (const glm::dvec3 p : mesh.positions) map.emplace_back(glm::dot(p, x), glm::dot(p, y));
    return map;
}

} // namespace lightloom
