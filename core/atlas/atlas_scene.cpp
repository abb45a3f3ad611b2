// SPDX-License-Identifier: Apache-2.0
#include "core/atlas/atlas_scene.h"
#include <map>
#include <tuple>

namespace lightloom {
namespace {

using Corners = std::array<glm::vec2, 3>;

/// A mesh with its seams cut, as it grows.
class Cut {
public:
    explicit Cut(const Mesh& from) : from_(from)
    {
        mesh_.name = from.name;
        mesh_.material = from.material;
    }

    /// A triangle at `uv`; from its back: turned over.
    void add(glm::uvec3 corners, const Corners& uv, bool isBack)
    {
        const std::uint32_t a = vertex(corners.x, uv[0], isBack), b = vertex(corners.y, uv[1], isBack);
        const std::uint32_t c = vertex(corners.z, uv[2], isBack);
        mesh_.triangles.emplace_back(isBack ? glm::uvec3(a, c, b) : glm::uvec3(a, b, c));
    }

    Mesh& mesh() { return mesh_; }
    std::vector<glm::vec2>& uv() { return uv_; }

private:
    using Key = std::tuple<std::uint32_t, bool, float, float>;

    std::uint32_t vertex(std::uint32_t v, glm::vec2 uv, bool isBack)
    {
        const auto [known, isNew] =
            known_.try_emplace(Key(v, isBack, uv.x, uv.y), static_cast<std::uint32_t>(uv_.size()));
        if (!isNew) return known->second;
        uv_.push_back(uv);
        const float turn = isBack ? -1.0f : 1.0f;
        mesh_.positions.push_back(from_.positions[v]);
        if (!from_.normals.empty()) mesh_.normals.push_back(turn * from_.normals[v]);
        if (!from_.tangents.empty()) {
            glm::vec4 tangent = from_.tangents[v];
            tangent.w *= turn; // the bitangent stays where it is
            mesh_.tangents.push_back(tangent);
        }
        for (int set = 0; set < 2; ++set) {
            if (!from_.uv[set].empty()) mesh_.uv[set].push_back(from_.uv[set][v]);
        }
        if (!from_.colors.empty()) mesh_.colors.push_back(from_.colors[v]);
        return known->second;
    }

    const Mesh& from_;
    Mesh mesh_;
    std::vector<glm::vec2> uv_;
    std::map<Key, std::uint32_t> known_;
};

class Unwrapper {
public:
    Unwrapper(const RayScene& rays, const Atlas& atlas) : rays_(rays), atlas_(atlas), from_(rays.scene()) {}

    UnwrappedScene run()
    {
        to_.scene = from_;
        to_.scene.meshes.clear();
        for (std::uint32_t i = 0; i < from_.instances.size(); ++i) addInstance(i);
        return std::move(to_);
    }

private:
    [[nodiscard]] const Corners* place(std::uint32_t side) const
    {
        const auto at = atlas_.find(side);
        return at ? &atlas_.uv[*at] : nullptr;
    }

    void addInstance(std::uint32_t number)
    {
        const Mesh& mesh = from_.meshes[static_cast<std::size_t>(from_.instances[number].mesh)];
        const std::uint32_t first = rays_.firstTriangle(number);
        const Corners nowhere{atlas_.voidUv, atlas_.voidUv, atlas_.voidUv};
        bool areApart = false; // both sides of some triangle have places
        for (std::uint32_t t = 0; t < mesh.triangles.size() && !areApart; ++t) {
            areApart = place(2 * (first + t)) && place(2 * (first + t) + 1);
        }
        Cut cut(mesh);
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            const Corners *front = place(2 * (first + t)), *back = place(2 * (first + t) + 1);
            const Corners& here = front ? *front : back ? *back : nowhere;
            cut.add(mesh.triangles[t], here, false);
            if (areApart) cut.add(mesh.triangles[t], back ? *back : here, true);
        }
        if (areApart) cut.mesh().material = singleSided(mesh.material);
        to_.scene.instances[number].mesh = static_cast<int>(to_.scene.meshes.size());
        to_.scene.meshes.push_back(std::move(cut.mesh()));
        to_.uv.push_back(std::move(cut.uv()));
    }

    int singleSided(int material)
    {
        const auto [known, isNew] = singleSided_.try_emplace(material, static_cast<int>(to_.scene.materials.size()));
        if (isNew) {
            to_.scene.materials.push_back(from_.materials[static_cast<std::size_t>(material)]);
            to_.scene.materials.back().doubleSided = false;
        }
        return known->second;
    }

    const RayScene& rays_;
    const Atlas& atlas_;
    const Scene& from_;
    UnwrappedScene to_;
    std::map<int, int> singleSided_;
};

} // namespace

UnwrappedScene unwrappedScene(const RayScene& rays, const Atlas& atlas) { return Unwrapper(rays, atlas).run(); }

} // namespace lightloom
