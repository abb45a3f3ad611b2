// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/log.h"
#include "core/base/result.h"
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

namespace lightloom {

/// Where what was computed for a scene is kept: `<scene file>.lightloom-cache/` beside it, then the user's cache folder
/// ($XDG_CACHE_HOME/lightloom or ~/.cache/lightloom). Entries are single files, written whole or not at all; beyond
/// 1 GiB a folder loses those unused for longest. Any number of programs may share a folder. No folders: nothing is
/// found and nothing is kept.
class CacheFolders {
public:
    CacheFolders() = default;
    CacheFolders(const std::filesystem::path& sceneFile, LogSink log);

    /// Calls `visit(path, bytes)` for each entry whose name begins with `prefix`, by folder and name, until it gives
    /// false. An Error from it means that the entry is damaged: it is logged in one line and removed.
    void forEntries(
        const std::string& prefix,
        const std::function<Result<bool>(const std::filesystem::path&, std::span<const std::uint8_t>)>& visit) const;
    /// So that the entry is the last to be dropped.
    static void touch(const std::filesystem::path& entry);
    /// Writes an entry into the first folder that takes it; "" and a log line if none does.
    std::filesystem::path keep(const std::string& name, std::span<const std::uint8_t> bytes) const;

    [[nodiscard]] const std::vector<std::filesystem::path>& list() const { return folders_; }

private:
    std::vector<std::filesystem::path> folders_;
    LogSink log_;
};

} // namespace lightloom
