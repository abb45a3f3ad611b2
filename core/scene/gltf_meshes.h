// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/gltf_data.h"
#include "core/scene/scene.h"
#include <stop_token>

namespace lightloom {

/// A mesh of the file as the scene holds it, and the box around it.
struct GltfMesh {
    std::vector<int> parts; ///< indices into Scene::meshes, one per primitive that has triangles
    glm::dvec3 shift{0.0};  ///< was subtracted from the positions; instances add it back
};

/// Reads each mesh of the file that `wanted` marks into `scene.meshes`. Triangles, strips and fans; points and lines
/// are left out with a warning, triangles without area are left out and counted in one. Vertices that no triangle uses
/// are dropped. A mesh that lies far from its own origin is moved there (`shift`), so that floats keep its detail.
/// Material numbers are the file's; one past the last where a primitive names none. Errors: positions, normals, colours
/// or texture coordinates that are not finite, indices past the vertices, more triangles or vertices than fit;
/// `cancelled` where a stop was seen, between the steps of each primitive.
[[nodiscard]] Result<std::vector<GltfMesh>> readMeshes(const tinygltf::Model& model, const GltfData& data,
                                                       const std::vector<bool>& wanted, Scene& scene,
                                                       GltfWarnings& warnings, const std::stop_token& stop);
[[nodiscard]] Error readingStopped();

inline constexpr std::uint64_t kMostTriangles = 100'000'000; ///< of a scene, instances counted each
inline constexpr std::uint64_t kMostVertices = 100'000'000;  ///< of all meshes together

} // namespace lightloom
