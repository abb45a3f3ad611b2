// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lightloom {

/// What a `uri` in a glTF file points at, and the only way to it: nothing outside the scene's folder is ever opened.
class SceneFolder {
public:
    /// `folder` holds the scene file.
    explicit SceneFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

    /// The bytes behind `uri`: decoded base64 of a `data:` uri, or a regular file below the folder. Error: no such
    /// file; a folder, pipe or device; more than `mostBytes`; a path that leads out of the folder, be it by "..", from
    /// the root, with a scheme or through a symbolic link.
    [[nodiscard]] Result<std::vector<std::uint8_t>> read(const std::string& uri, std::uint64_t mostBytes) const;

private:
    std::filesystem::path folder_;
};

/// True for `data:` uris.
[[nodiscard]] bool isDataUri(std::string_view uri);

/// The path that a relative uri names, percent-decoded. Error: empty, absolute, with a scheme, a "..", a backslash or
/// a NUL in it, or a broken percent code.
[[nodiscard]] Result<std::filesystem::path> relativePath(std::string_view uri);

/// The bytes of a base64 `data:` uri. Error: not base64, or more than `mostBytes`.
[[nodiscard]] Result<std::vector<std::uint8_t>> decodeDataUri(std::string_view uri, std::uint64_t mostBytes);

} // namespace lightloom
