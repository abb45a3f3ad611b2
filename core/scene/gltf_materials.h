// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/gltf_check.h"
#include "core/scene/gltf_data.h"
#include "core/scene/gltf_files.h"
#include "core/scene/scene.h"

namespace lightloom {

/// Fills `scene.materials`, one per material of the file, and `scene.images` with the pictures that the materials
/// marked in `used` need; others are not opened. `used` has one entry more than the file has materials, for glTF's
/// default one (white, metallic and rough), which is added at the end if it is marked.
[[nodiscard]] Result<Done> readMaterials(const tinygltf::Model& model, const CheckedGltf& checked,
                                         const SceneFolder& folder, const std::vector<bool>& used, Scene& scene,
                                         GltfWarnings& warnings);

} // namespace lightloom
