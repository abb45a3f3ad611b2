// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/gltf_check.h"
#include "core/scene/gltf_json.h"

/// The parts of `checkGltf`, in the order they run. Each reports to `GltfFile::faults`; after a part that did, the rest
/// is not run, so each may trust what the ones before it have checked.
namespace lightloom::detail {

struct GltfFile {
    const Json& root;
    const GltfLimits& limits;
    Faults& faults;
    std::vector<std::span<const std::uint8_t>> buffers;

    /// The top-level list, empty where there is none; too long or no list is a fault.
    [[nodiscard]] const Json& list(const char* name) const;
    /// Entry `i` of the top-level list.
    [[nodiscard]] JsonObject entry(const char* name, std::uint64_t i) const;
    /// Entries of the list; 0 where it is missing.
    [[nodiscard]] std::uint64_t size(const char* name) const;
};

/// Bytes of one component; 0: no such component type.
[[nodiscard]] std::uint64_t componentBytes(std::uint64_t componentType);

void checkBufferViews(const GltfFile& file); ///< ranges inside their buffers, strides
void checkAccessors(const GltfFile& file);   ///< types, ranges inside their views, sparse indices below their counts
void checkMeshes(const GltfFile& file);      ///< attributes of fitting type and equal count
void checkNodes(const GltfFile& file);       ///< a forest: one parent, no cycle; transforms; what they refer to
void checkMaterials(const GltfFile& file);   ///< factors in range; textures, samplers, images that exist
void checkLampsAndCameras(const GltfFile& file);

/// The bytes of buffer view `index`.
[[nodiscard]] std::span<const std::uint8_t> viewBytes(const GltfFile& file, std::uint64_t index);

} // namespace lightloom::detail
