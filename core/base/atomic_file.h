// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace lightloom {

/// Writes `bytes` to `path` so that `path` holds either its old content or all of the new one, whatever happens:
/// temporary file beside it, every write checked, fsync, rename, fsync of the folder. Nothing else in Lightloom writes
/// user files. Existing permissions of `path` are kept.
Result<Done> writeFile(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);
Result<Done> writeFile(const std::filesystem::path& path, std::string_view text);

/// The whole of a regular file of at most `mostBytes`. Folders, devices and pipes are refused, not read.
Result<std::vector<std::uint8_t>> readFile(const std::filesystem::path& path, std::uint64_t mostBytes);

} // namespace lightloom
