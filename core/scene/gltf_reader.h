// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/log.h"
#include "core/base/result.h"
#include "core/scene/scene.h"
#include <filesystem>
#include <memory>
#include <stop_token>

namespace lightloom {

/// Reads a .glb or .gltf file, its default scene. Nothing outside the file's folder is opened. What the file has and we
/// read differently or not at all is said once per kind in Scene::warnings and to `log`.
/// Supported: triangles, strips, fans; every component type, strides, sparse accessors, KHR_mesh_quantization; node
/// trees with TRS or matrices, mirrored ones too; instancing; metallic-roughness materials with PNG and JPEG textures,
/// KHR_texture_transform, KHR_materials_emissive_strength; KHR_lights_punctual; perspective cameras; extras.lightloom
/// (`group` on a node, `exposure` on the scene). KHR_materials_transmission, _ior and _volume, their factors without
/// textures. Scene::origin is the centre of the bound, subtracted in double. Errors: one sentence that begins with
/// the file's name. A scene without triangles is one. Any thread; hostile files cost no more than their limits
/// (GltfLimits). A stop is seen between steps of a few milliseconds per million triangles; the error is `cancelled`.
[[nodiscard]] Result<std::shared_ptr<const Scene>> readScene(const std::filesystem::path& file, const LogSink& log = {},
                                                             const std::stop_token& stop = {});

/// The same from memory: `bytes` as of a file in `folder`, where its other files are looked for.
[[nodiscard]] Result<std::shared_ptr<const Scene>>
readScene(std::vector<std::uint8_t> bytes, const std::filesystem::path& folder, const std::stop_token& stop = {});

} // namespace lightloom
