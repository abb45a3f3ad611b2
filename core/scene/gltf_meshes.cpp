// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf_meshes.h"
#include "core/scene/gltf_json.h"
#include "core/scene/mesh_repair.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <tiny_gltf.h>

namespace lightloom {
namespace {

Error bad(std::string message) { return {Error::Kind::badInput, std::move(message)}; }

/// Corners in pairs of three, whatever the primitive's mode.
std::vector<glm::uvec3> trianglesOf(const std::vector<std::uint32_t>& corners, int mode)
{
    std::vector<glm::uvec3> triangles;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        triangles.reserve(corners.size() / 3);
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
            triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
        }
        return triangles;
    }
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
        const std::size_t odd = i % 2; // every second triangle of a strip runs the other way round
        if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
            triangles.emplace_back(corners[i], corners[i + 1 + odd], corners[i + 2 - odd]);
        } else {
            triangles.emplace_back(corners[i + 1], corners[i + 2], corners[0]);
        }
    }
    return triangles;
}

/// Reads one primitive at a time; keeps the totals that limits are held against.
class PrimitiveReader {
public:
    PrimitiveReader(const tinygltf::Model& model, const GltfData& data, GltfWarnings& warnings,
                    const std::stop_token& stop)
        : model_(model), data_(data), warnings_(warnings), stop_(stop)
    {
    }

    /// A mesh without triangles where the primitive has none.
    Result<Mesh> read(const tinygltf::Primitive& primitive, const std::string& name)
    {
        Mesh mesh;
        mesh.name = name;
        mesh.material = primitive.material >= 0 ? primitive.material : static_cast<int>(model_.materials.size());
        const int mode = primitive.mode >= 0 ? primitive.mode : TINYGLTF_MODE_TRIANGLES;
        const int position = accessor(primitive, "POSITION");
        if (mode < TINYGLTF_MODE_TRIANGLES) {
            warnings_.add("points and lines are ignored: they have no surface");
            return mesh;
        }
        if (position < 0) {
            warnings_.add("meshes without POSITION are ignored");
            return mesh;
        }
        vertices_ += data_.count(position);
        if (vertices_ > kMostVertices) {
            return Error{Error::Kind::outOfMemory, fmt::format("the meshes have more than {} vertices", kMostVertices)};
        }
        if (const Result<Done> done = readAttributes(primitive, mesh); !done) return done.error();
        if (const Result<Done> done = readTriangles(primitive, mode, mesh); !done) return done.error();
        if (const Result<Done> done = repair(mesh); !done) return done.error();
        return mesh;
    }

    [[nodiscard]] std::uint64_t droppedTriangles() const { return dropped_; }

private:
    Result<Done> repair(Mesh& mesh)
    {
        if (stop_.stop_requested()) return readingStopped();
        dropped_ += dropFlatTriangles(mesh);
        if (stop_.stop_requested()) return readingStopped();
        dropUnusedVertices(mesh);
        if (stop_.stop_requested()) return readingStopped();
        completeNormals(mesh);
        return Done{};
    }

    static int accessor(const tinygltf::Primitive& primitive, const char* name)
    {
        const auto found = primitive.attributes.find(name);
        return found == primitive.attributes.end() ? -1 : found->second;
    }

    /// `to` gets the attribute, or stays empty where the primitive has none.
    template<class Vec>
    Result<Done> readAttribute(const tinygltf::Primitive& primitive, const char* name, std::vector<Vec>& to) const
    {
        const int index = accessor(primitive, name);
        if (index < 0) return Done{};
        if (stop_.stop_requested()) return readingStopped();
        const std::vector<float> values = data_.floats(index);
        const auto width = static_cast<std::size_t>(data_.components(index));
        to.resize(values.size() / width, Vec(1.0f)); // colours may come without alpha
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (!std::isfinite(values[i])) {
                return bad(fmt::format("{} of vertex {} is not a finite number", name, i / width));
            }
            to[i / width][static_cast<int>(i % width)] = values[i];
        }
        return Done{};
    }

    Result<Done> readAttributes(const tinygltf::Primitive& primitive, Mesh& mesh) const
    {
        for (const Result<Done>& done :
             {readAttribute(primitive, "POSITION", mesh.positions), readAttribute(primitive, "NORMAL", mesh.normals),
              readAttribute(primitive, "TANGENT", mesh.tangents), readAttribute(primitive, "TEXCOORD_0", mesh.uv[0]),
              readAttribute(primitive, "TEXCOORD_1", mesh.uv[1]), readAttribute(primitive, "COLOR_0", mesh.colors)}) {
            if (!done) return done;
        }
        for (glm::vec4& colour : mesh.colors) colour = glm::clamp(colour, 0.0f, 1.0f);
        return Done{};
    }

    Result<Done> readTriangles(const tinygltf::Primitive& primitive, int mode, Mesh& mesh)
    {
        if (stop_.stop_requested()) return readingStopped();
        std::vector<std::uint32_t> corners;
        if (primitive.indices >= 0) {
            corners = data_.indices(primitive.indices);
            const auto past = std::find_if(corners.begin(), corners.end(),
                                           [&](std::uint32_t v) { return v >= mesh.positions.size(); });
            if (past != corners.end()) {
                return bad(fmt::format("index {} of its triangles names vertex {} of {}", past - corners.begin(), *past,
                                       mesh.positions.size()));
            }
        } else {
            corners.resize(mesh.positions.size());
            for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
        }
        if (mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0) {
            warnings_.add("corners left over after the last whole triangle of a mesh are ignored");
        }
        if (stop_.stop_requested()) return readingStopped();
        mesh.triangles = trianglesOf(corners, mode);
        triangles_ += mesh.triangles.size();
        if (triangles_ <= kMostTriangles) return Done{};
        return Error{Error::Kind::outOfMemory, fmt::format("the meshes have more than {} triangles", kMostTriangles)};
    }

    const tinygltf::Model& model_;
    const GltfData& data_;
    GltfWarnings& warnings_;
    const std::stop_token& stop_;
    std::uint64_t vertices_ = 0, triangles_ = 0, dropped_ = 0;
};

/// Moves all parts of a mesh to its own origin if they lie far from it for their size; gives what was subtracted.
glm::dvec3 moveHome(Scene& scene, const std::vector<int>& parts)
{
    glm::dvec3 low(std::numeric_limits<double>::max()), high(-low);
    for (const int part : parts) {
        for (const glm::vec3 p : scene.meshes[static_cast<std::size_t>(part)].positions) {
            low = glm::min(low, glm::dvec3(p));
            high = glm::max(high, glm::dvec3(p));
        }
    }
    constexpr double kFar = 8.0; // sizes away: three bits of a float's 24 are gone
    const glm::dvec3 centre = 0.5 * (low + high);
    if (parts.empty() || !(glm::length(centre) > kFar * glm::length(high - low))) return glm::dvec3(0.0);
    for (const int part : parts) {
        for (glm::vec3& p : scene.meshes[static_cast<std::size_t>(part)].positions) {
            p = glm::vec3(glm::dvec3(p) - centre);
        }
    }
    return centre;
}

} // namespace

Error readingStopped() { return {Error::Kind::cancelled, "reading it was cancelled"}; }

Result<std::vector<GltfMesh>> readMeshes(const tinygltf::Model& model, const GltfData& data,
                                         const std::vector<bool>& wanted, Scene& scene, GltfWarnings& warnings,
                                         const std::stop_token& stop)
{
    PrimitiveReader reader(model, data, warnings, stop);
    std::vector<GltfMesh> meshes(model.meshes.size());
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        if (!wanted[m]) continue;
        const tinygltf::Mesh& from = model.meshes[m];
        const std::string name = from.name.empty() ? fmt::format("mesh {}", m) : plainName(from.name);
        for (std::size_t i = 0; i < from.primitives.size(); ++i) {
            Result<Mesh> part = reader.read(from.primitives[i], i == 0 ? name : fmt::format("{} part {}", name, i + 1));
            if (!part) return part.error().in(fmt::format("mesh \"{}\", part {}", name, i + 1));
            if (part->triangles.empty()) continue;
            meshes[m].parts.push_back(static_cast<int>(scene.meshes.size()));
            scene.meshes.push_back(*std::move(part));
        }
        meshes[m].shift = moveHome(scene, meshes[m].parts);
    }
    if (const std::uint64_t dropped = reader.droppedTriangles(); dropped > 0) {
        warnings.add(fmt::format("{} triangles without area are left out", dropped));
    }
    return meshes;
}

} // namespace lightloom
