// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

/// Looks a glTF file over before any other reader sees a byte of it. What comes out can be walked without a further
/// thought: every index and every byte range is inside its bounds, the nodes are a forest, all numbers are finite.
namespace lightloom {

/// What a file may cost. Beyond these a clear error, not a crash.
struct GltfLimits {
    std::uint64_t fileBytes = (std::uint64_t{1} << 31) - 1; ///< scene file, and any one file beside it
    std::uint64_t bufferBytes = std::uint64_t{4} << 30;     ///< all buffers together
    std::uint64_t jsonBytes = std::uint64_t{512} << 20;     ///< data: uris included
    std::uint64_t jsonValues = 4'000'000;                   ///< numbers, texts, objects, arrays
    std::uint64_t entries = 1'000'000;                      ///< of any one list: nodes, accessors, primitives of a mesh
    std::uint64_t elements = 100'000'000;                   ///< of one accessor
    int jsonDepth = 64, nodeDepth = 256;
};

/// Where the bytes of an image are: behind `uri`, or in `bytes` (then `uri` is empty).
struct GltfImageSource {
    std::string name, uri;
    std::span<const std::uint8_t> bytes;
};

/// A file that has passed. Moving it keeps the spans good; copying does not.
struct CheckedGltf {
    CheckedGltf() = default;
    CheckedGltf(CheckedGltf&&) = default;
    CheckedGltf& operator=(CheckedGltf&&) = default;

    std::string json; ///< written anew from the tree that was checked; buffers, images, skins, animations taken out
    std::vector<std::span<const std::uint8_t>> buffers; ///< exactly byteLength each
    std::vector<GltfImageSource> images;                ///< uris are not yet opened
    std::vector<std::string> warnings;                  ///< what is in the file and will be ignored, one line each
    std::vector<std::vector<std::uint8_t>> storage;     ///< what the spans point into
};

/// Gives the bytes behind a uri, at most so many; see SceneFolder::read.
using UriReader = std::function<Result<std::vector<std::uint8_t>>(const std::string& uri, std::uint64_t mostBytes)>;

/// Checks `file` (a whole .glb or .gltf) and fetches its buffers through `readUri`. Errors name the place in the file
/// ("accessors[3]: ...") and are `unsupported` where the file is right but asks for what we lack, above all in
/// extensionsRequired. Cost: the JSON tree, the buffers, and linear time.
[[nodiscard]] Result<CheckedGltf> checkGltf(std::vector<std::uint8_t> file, const UriReader& readUri,
                                            const GltfLimits& limits = {});

} // namespace lightloom
