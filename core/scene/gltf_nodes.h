// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/gltf_data.h"
#include "core/scene/scene.h"

namespace lightloom {

/// A node of the default scene in its place.
struct PlacedNode {
    int node = 0;            ///< index in the file
    std::string path;        ///< "Room/Lamp"; unique, by "#2", "#3" where names repeat
    std::string group;       ///< extras.lightloom.group, or ""
    glm::dmat4 toWorld{1.0}; ///< to the file's space
};

/// The nodes of the file's default scene (its first one, or all roots where it has none), parents before children, in
/// the file's order. Nodes without a name are called "node7" after their index. Error: a place that is not finite.
[[nodiscard]] Result<std::vector<PlacedNode>> placeNodes(const tinygltf::Model& model, GltfWarnings& warnings);

/// The lamp at `node`, false where it has none. Position still in the file's space: `at` gets it.
[[nodiscard]] bool readLamp(const tinygltf::Model& model, const PlacedNode& node, PunctualLight& lamp, glm::dvec3& at,
                            GltfWarnings& warnings);

/// The perspective camera at `node`, likewise.
[[nodiscard]] bool readCamera(const tinygltf::Model& model, const PlacedNode& node, Camera& camera, glm::dvec3& at,
                              GltfWarnings& warnings);

} // namespace lightloom
