// SPDX-License-Identifier: Apache-2.0
#include "core/scene/shapes.h"
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace lightloom {
namespace {

/// Point on the unit circle number `i` of `n`, rounded once from double.
glm::dvec2 onCircle(int i, int n)
{
    const double angle = 2.0 * std::numbers::pi * i / n;
    return {std::cos(angle), std::sin(angle)};
}

void turnInside(Mesh& mesh)
{
    for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    for (glm::vec3& n : mesh.normals) n = -n;
}

void addTriangle(Mesh& mesh, std::size_t a, std::size_t b, std::size_t c)
{
    mesh.triangles.emplace_back(static_cast<unsigned>(a), static_cast<unsigned>(b), static_cast<unsigned>(c));
}

void addVertex(Mesh& mesh, glm::vec3 position, glm::vec3 normal)
{
    mesh.positions.push_back(position);
    mesh.normals.push_back(normal);
}

void addCap(Mesh& mesh, glm::vec3 centre, float radius, int segments, float up)
{
    const std::size_t first = mesh.positions.size(), n = static_cast<std::size_t>(segments);
    addVertex(mesh, centre, {0.0f, up, 0.0f});
    for (int i = 0; i < segments; ++i) {
        const glm::vec2 c(onCircle(i, segments));
        addVertex(mesh, centre + radius * glm::vec3(c.x, 0.0f, c.y), {0.0f, up, 0.0f});
    }
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t a = first + 1 + i, b = first + 1 + (i + 1) % n;
        if (up > 0.0f)
            addTriangle(mesh, first, b, a);
        else
            addTriangle(mesh, first, a, b);
    }
}

} // namespace

Mesh quadMesh(glm::vec3 corner, glm::vec3 u, glm::vec3 v)
{
    Mesh mesh;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

Mesh texturedQuadMesh(glm::vec3 corner, glm::vec3 u, glm::vec3 v, glm::vec2 repeats)
{
    Mesh mesh = quadMesh(corner, u, v);
    const float top = 1.0f - repeats.y;
    mesh.uv[0] = {{0.0f, 1.0f}, {repeats.x, 1.0f}, {repeats.x, top}, {0.0f, top}};
    return mesh;
}

Mesh boxMesh(glm::vec3 low, glm::vec3 high, Facing facing)
{
    Mesh mesh;
    for (unsigned i = 0; i < 8; ++i) {
        mesh.positions.emplace_back(i & 1u ? high.x : low.x, i & 2u ? high.y : low.y, i & 4u ? high.z : low.z);
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    if (facing == Facing::in) turnInside(mesh);
    return mesh;
}

Mesh sphereMesh(glm::vec3 centre, float radius, int rings, Facing facing)
{
    assert(rings >= 2);
    Mesh mesh;
    const int around = 2 * rings;
    const auto add = [&](glm::dvec3 n) { addVertex(mesh, centre + radius * glm::vec3(n), glm::vec3(n)); };
    add({0.0, 1.0, 0.0});
    for (int r = 1; r < rings; ++r) {
        const double polar = std::numbers::pi * r / rings;
        for (int i = 0; i < around; ++i) {
            const glm::dvec2 c = onCircle(i, around);
            add({std::sin(polar) * c.x, std::cos(polar), std::sin(polar) * c.y});
        }
    }
    add({0.0, -1.0, 0.0});
    const std::size_t n = static_cast<std::size_t>(around), last = mesh.positions.size() - 1;
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t next = (i + 1) % n;
        addTriangle(mesh, 0, 1 + next, 1 + i);
        for (std::size_t r = 0; r + 2 < static_cast<std::size_t>(rings); ++r) {
            const std::size_t a = 1 + r * n + i, b = 1 + r * n + next, c = a + n, d = b + n;
            addTriangle(mesh, a, b, d);
            addTriangle(mesh, a, d, c);
        }
        addTriangle(mesh, last, last - n + i, last - n + next);
    }
    if (facing == Facing::in) turnInside(mesh);
    return mesh;
}

Mesh cylinderMesh(glm::vec3 foot, float radius, float height, int segments)
{
    assert(segments >= 3);
    Mesh mesh;
    const glm::vec3 up(0.0f, height, 0.0f);
    for (int i = 0; i < segments; ++i) {
        const glm::vec2 c(onCircle(i, segments));
        const glm::vec3 n(c.x, 0.0f, c.y);
        addVertex(mesh, foot + radius * n, n);
        addVertex(mesh, foot + up + radius * n, n);
    }
    const std::size_t n = static_cast<std::size_t>(segments);
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t a = 2 * i, b = 2 * ((i + 1) % n);
        addTriangle(mesh, a, a + 1, b + 1);
        addTriangle(mesh, a, b + 1, b);
    }
    addCap(mesh, foot + up, radius, segments, 1.0f);
    addCap(mesh, foot, radius, segments, -1.0f);
    return mesh;
}

Mesh bandMesh(glm::vec3 foot, float inner, float outer, float height, int segments)
{
    assert(segments >= 3 && inner < outer);
    // the section's corners, run through so that the strip between each and the next looks out of the band
    const std::array<glm::vec2, 4> corners{{{outer, 0.0f}, {outer, height}, {inner, height}, {inner, 0.0f}}};
    const std::array<glm::vec2, 4> normals{{{1.0f, 0.0f}, {0.0f, 1.0f}, {-1.0f, 0.0f}, {0.0f, -1.0f}}};
    Mesh mesh;
    for (std::size_t side = 0; side < 4; ++side) {
        const std::size_t first = mesh.positions.size(), n = static_cast<std::size_t>(segments);
        const glm::vec2 a = corners[side], b = corners[(side + 1) % 4], out = normals[side];
        for (int i = 0; i < segments; ++i) {
            const glm::vec2 c(onCircle(i, segments));
            for (const glm::vec2 p : {a, b})
                addVertex(mesh, foot + glm::vec3(c.x * p.x, p.y, c.y * p.x), {c.x * out.x, out.y, c.y * out.x});
        }
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t here = first + 2 * i, next = first + 2 * ((i + 1) % n);
            addTriangle(mesh, here, here + 1, next + 1);
            addTriangle(mesh, here, next + 1, next);
        }
    }
    return mesh;
}

Mesh torusMesh(glm::vec3 centre, glm::vec3 axis, float radius, float tube, int segments, int tubeSegments)
{
    assert(segments >= 3 && tubeSegments >= 3);
    const glm::vec3 side = std::abs(axis.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
    const glm::vec3 u = glm::normalize(glm::cross(side, axis)), v = glm::cross(axis, u);
    Mesh mesh;
    for (int i = 0; i < segments; ++i) {
        const glm::vec2 c(onCircle(i, segments));
        const glm::vec3 outward = u * c.x + v * c.y;
        for (int j = 0; j < tubeSegments; ++j) {
            const glm::vec2 d(onCircle(j, tubeSegments));
            const glm::vec3 n = outward * d.x + axis * d.y;
            addVertex(mesh, centre + radius * outward + tube * n, n);
        }
    }
    const std::size_t n = static_cast<std::size_t>(segments), m = static_cast<std::size_t>(tubeSegments);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < m; ++j) {
            const std::size_t nextI = (i + 1) % n, nextJ = (j + 1) % m;
            const std::size_t a = i * m + j, b = nextI * m + j, c = nextI * m + nextJ, d = i * m + nextJ;
            addTriangle(mesh, a, b, c);
            addTriangle(mesh, a, c, d);
        }
    }
    return mesh;
}

void append(Mesh& mesh, const Mesh& part)
{
    const bool empty = mesh.positions.empty();
    assert(empty || (mesh.normals.empty() == part.normals.empty() && mesh.uv[0].empty() == part.uv[0].empty()));
    const unsigned first = static_cast<unsigned>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
    mesh.uv[0].insert(mesh.uv[0].end(), part.uv[0].begin(), part.uv[0].end());
    for (const glm::uvec3 t : part.triangles) mesh.triangles.push_back(t + first);
    if (empty) mesh.material = part.material;
}

double areaOf(const Mesh& mesh)
{
    double sum = 0.0;
    for (const glm::uvec3 t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        sum += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return sum;
}

double volumeOf(const Mesh& mesh)
{
    double sum = 0.0;
    for (const glm::uvec3 t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        sum += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    return sum;
}

} // namespace lightloom
