// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/scene/scene.h"
#include <cstdint>
#include <filesystem>
#include <vector>

namespace lightloom {

/// A baked texture of the illuminance on all surfaces, for the writer.
struct GltfLightmap {
    Image image;                            ///< linear, of 255: illuminance over `intensity`
    float intensity = 1.0f;                 ///< lux
    std::vector<std::vector<glm::vec2>> uv; ///< by mesh: as many as positions, (0,0) at the top left
    std::string hdrFile;                    ///< name of the same picture in lux, beside the glb
    std::string light;                      ///< what it holds: "indirect" or "direct+indirect"
    std::string incomplete;                 ///< in what way it is less than was asked for; empty: it is all
};

/// `scene` as a binary glTF 2.0 file. Reading it back gives the same triangles, materials, lamps, groups and cameras.
/// - Node paths become nodes; instances that share path and matrix are primitives of one mesh. Meshes nobody places
///   are left out.
/// - `Scene::origin` goes into the nodes' translations, in double: vertices keep their float precision.
/// - Lamps: KHR_lights_punctual. Emission: emissiveFactor x KHR_materials_emissive_strength. Textures: PNG inside the
///   file, KHR_texture_transform. Transmission, ior and volume where set.
/// - Ours, in `extras.lightloom`: `group` on nodes whose lamps are joined, `exposure` (EV) on the scene.
/// - A lightmap goes on TEXCOORD_1 of every mesh and into every material as MOZ_lightmap (index, texCoord, intensity: a
///   texel times intensity is the illuminance, which a matt surface reflects albedo / pi of), and into
///   `extras.lightloom.lightmap` of the scene. What textures read from the second set before moves to TEXCOORD_2.
/// The same scene gives the same bytes. Errors: more than 4 GiB (glb counts in 32 bits), a PNG that cannot be made.
[[nodiscard]] Result<std::vector<std::uint8_t>> gltfBytes(const Scene& scene, const GltfLightmap* lightmap = nullptr);

/// The same into a file, whole or not at all.
Result<Done> writeGltf(const Scene& scene, const std::filesystem::path& path);

} // namespace lightloom
