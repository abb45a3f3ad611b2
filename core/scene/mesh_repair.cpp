// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mesh_repair.h"
#include <algorithm>
#include <limits>

namespace lightloom {
namespace {

glm::dvec3 at(const Mesh& mesh, std::uint32_t vertex) { return glm::dvec3(mesh.positions[vertex]); }

/// Twice the area, along the normal.
glm::dvec3 areaVector(const Mesh& mesh, glm::uvec3 t)
{
    return glm::cross(at(mesh, t.y) - at(mesh, t.x), at(mesh, t.z) - at(mesh, t.x));
}

bool isFlat(const Mesh& mesh, glm::uvec3 t)
{
    constexpr double kLeastSine = 1e-10;
    const glm::dvec3 ab = at(mesh, t.y) - at(mesh, t.x), ac = at(mesh, t.z) - at(mesh, t.x), bc = ac - ab;
    const double longest = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
    return !(glm::length(glm::cross(ab, ac)) > kLeastSine * longest);
}

template<class T>
void keepOnly(std::vector<T>& values, const std::vector<std::uint32_t>& newIndex, std::size_t kept)
{
    if (values.empty()) return;
    for (std::size_t i = 0; i < newIndex.size(); ++i) {
        if (newIndex[i] != std::numeric_limits<std::uint32_t>::max()) values[newIndex[i]] = values[i];
    }
    values.resize(kept);
}

} // namespace

std::uint64_t dropFlatTriangles(Mesh& mesh)
{
    return std::erase_if(mesh.triangles, [&](glm::uvec3 t) { return isFlat(mesh, t); });
}

void dropUnusedVertices(Mesh& mesh)
{
    constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> newIndex(mesh.positions.size(), kUnused);
    for (const glm::uvec3 t : mesh.triangles) newIndex[t.x] = newIndex[t.y] = newIndex[t.z] = 0;
    std::uint32_t kept = 0;
    for (std::uint32_t& index : newIndex) {
        if (index != kUnused) index = kept++;
    }
    if (kept == newIndex.size()) return;
    keepOnly(mesh.positions, newIndex, kept); // a new index is never above the old one
    keepOnly(mesh.normals, newIndex, kept);
    keepOnly(mesh.tangents, newIndex, kept);
    keepOnly(mesh.uv[0], newIndex, kept);
    keepOnly(mesh.uv[1], newIndex, kept);
    keepOnly(mesh.colors, newIndex, kept);
    for (glm::uvec3& t : mesh.triangles) t = {newIndex[t.x], newIndex[t.y], newIndex[t.z]};
}

void completeNormals(Mesh& mesh)
{
    const auto hasLength = [](glm::dvec3 v) { return glm::dot(v, v) > 1e-30; };
    if (!std::all_of(mesh.normals.begin(), mesh.normals.end(), [&](glm::vec3 n) { return hasLength(glm::dvec3(n)); })) {
        std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
        for (const glm::uvec3 t : mesh.triangles) {
            const glm::dvec3 n = glm::normalize(areaVector(mesh, t));
            for (const std::uint32_t v : {t.x, t.y, t.z}) {
                sums[v] += n;
                if (!hasLength(sums[v])) sums[v] = n; // two sheets back to back: take one side
            }
        }
        for (std::size_t i = 0; i < sums.size(); ++i) {
            if (!hasLength(glm::dvec3(mesh.normals[i]))) mesh.normals[i] = glm::vec3(glm::normalize(sums[i]));
        }
    }
    for (glm::vec3& n : mesh.normals) n = glm::vec3(glm::normalize(glm::dvec3(n)));
    for (glm::vec4& tangent : mesh.tangents) {
        const glm::dvec3 along(tangent.x, tangent.y, tangent.z);
        if (!hasLength(along)) {
            mesh.tangents.clear();
            return;
        }
        tangent = glm::vec4(glm::vec3(glm::normalize(along)), tangent.w < 0.0f ? -1.0f : 1.0f);
    }
}

} // namespace lightloom
