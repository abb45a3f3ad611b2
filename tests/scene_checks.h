// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"
#include <array>
#include <map>
#include <string>
#include <vector>

/// What tests ask of a scene's geometry.
namespace lightloom::test {

struct PlacedTriangle {
    std::array<glm::vec3, 3> corner; ///< scene space, in the order that faces front
    int instance;
    [[nodiscard]] glm::dvec3 areaVector() const
    {
        const glm::dvec3 a(corner[0]), b(corner[1]), c(corner[2]);
        return 0.5 * glm::cross(b - a, c - a);
    }
};

/// All triangles of the instances whose node path begins with `nodes`.
inline std::vector<PlacedTriangle> triangles(const Scene& scene, const std::string& nodes = {})
{
    std::vector<PlacedTriangle> found;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (instance.node.rfind(nodes, 0) != 0) continue;
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        for (glm::uvec3 t : mesh.triangles) {
            if (instance.isMirrored()) std::swap(t.y, t.z);
            const auto at = [&](unsigned v) {
                return glm::vec3(instance.toWorld * glm::vec4(mesh.positions[v], 1.0f));
            };
            found.push_back({{at(t.x), at(t.y), at(t.z)}, static_cast<int>(i)});
        }
    }
    return found;
}

inline double area(const std::vector<PlacedTriangle>& all)
{
    double sum = 0.0;
    for (const PlacedTriangle& t : all) sum += glm::length(t.areaVector());
    return sum;
}

/// Positive for closed bodies that face out.
inline double volume(const std::vector<PlacedTriangle>& all)
{
    double sum = 0.0;
    for (const PlacedTriangle& t : all) sum += glm::dot(glm::dvec3(t.corner[0]), t.areaVector()) / 3.0;
    return sum;
}

/// Edges without a partner that runs the other way, vertices joined by position: 0 for closed, oriented bodies.
inline std::size_t openEdges(const std::vector<PlacedTriangle>& all)
{
    using Point = std::array<float, 3>;
    std::map<std::array<Point, 2>, int> balance;
    for (const PlacedTriangle& t : all) {
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3 a = t.corner[k], b = t.corner[(k + 1) % 3];
            const Point p{a.x, a.y, a.z}, q{b.x, b.y, b.z};
            if (p < q)
                ++balance[{p, q}];
            else
                --balance[{q, p}];
        }
    }
    std::size_t open = 0;
    for (const auto& entry : balance) open += entry.second != 0;
    return open;
}

/// Lumen per m2 and channel times area, of all surfaces that glow without a texture.
inline glm::dvec3 surfaceFlux(const Scene& scene)
{
    glm::dvec3 sum(0.0);
    for (const PlacedTriangle& t : triangles(scene)) {
        const Instance& instance = scene.instances[static_cast<std::size_t>(t.instance)];
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
        const double sides = material.doubleSided ? 2.0 : 1.0;
        sum += glm::dvec3(material.emission) * (sides * 3.14159265358979323846 * glm::length(t.areaVector()));
    }
    return sum;
}

} // namespace lightloom::test
