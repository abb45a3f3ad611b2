// SPDX-License-Identifier: Apache-2.0
#include "core/compare/cache_folders.h"
#include "core/base/atomic_file.h"
#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>

namespace lightloom {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kExtension = ".llref";
constexpr std::uint64_t kMostFileBytes = 1ull << 30, kMostFolderBytes = 1ull << 30;

fs::path userCache()
{
    const char* cache = std::getenv("XDG_CACHE_HOME"); // NOLINT(concurrency-mt-unsafe): nobody sets it meanwhile
    if (cache && *cache == '/') return fs::path(cache) / "lightloom";
    const char* home = std::getenv("HOME"); // NOLINT(concurrency-mt-unsafe)
    return home && *home == '/' ? fs::path(home) / ".cache" / "lightloom" : fs::path();
}

std::vector<fs::path> entriesIn(const fs::path& folder, const std::string& prefix)
{
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (name.starts_with(prefix) && name.ends_with(kExtension)) found.push_back(at->path());
    }
    std::ranges::sort(found); // not in the disk's order
    return found;
}

void prune(const fs::path& folder)
{
    struct File {
        fs::file_time_type used;
        std::uint64_t bytes;
        fs::path path;
    };
    std::vector<File> files;
    std::uint64_t sum = 0;
    std::error_code error;
    for (const fs::path& path : entriesIn(folder, "")) {
        const std::uint64_t bytes = fs::file_size(path, error);
        if (error) continue;
        files.push_back({fs::last_write_time(path, error), bytes, path});
        sum += bytes;
    }
    std::ranges::sort(files, {}, &File::used);
    for (const File& file : files) {
        if (sum <= kMostFolderBytes) return;
        if (fs::remove(file.path, error)) sum -= file.bytes;
    }
}

} // namespace

CacheFolders::CacheFolders(const fs::path& sceneFile, LogSink log) : log_(std::move(log))
{
    std::error_code error;
    const fs::path scene = fs::absolute(sceneFile, error);
    folders_.push_back((error ? sceneFile : scene).string() + ".lightloom-cache");
    if (const fs::path cache = userCache(); !cache.empty()) folders_.push_back(cache);
}

void CacheFolders::forEntries(
    const std::string& prefix,
    const std::function<Result<bool>(const fs::path&, std::span<const std::uint8_t>)>& visit) const
{
    for (const fs::path& folder : folders_) {
        for (const fs::path& path : entriesIn(folder, prefix)) {
            const Result<std::vector<std::uint8_t>> bytes = readFile(path, kMostFileBytes);
            if (!bytes) continue; // another program may just have pruned it
            const Result<bool> goesOn = visit(path, std::span(*bytes));
            if (goesOn && !*goesOn) return;
            if (goesOn) continue;
            log(log_, LogLevel::warning,
                fmt::format("{} is damaged ({}); traced anew", path.string(), goesOn.error().message));
            std::error_code ignored;
            fs::remove(path, ignored);
        }
    }
}

void CacheFolders::touch(const fs::path& entry)
{
    std::error_code ignored;
    fs::last_write_time(entry, fs::file_time_type::clock::now(), ignored);
}

fs::path CacheFolders::keep(const std::string& name, std::span<const std::uint8_t> bytes) const
{
    if (folders_.empty()) return {};
    for (const fs::path& folder : folders_) {
        if (bytes.size() > kMostFolderBytes / 2) break;
        std::error_code ignored;
        fs::create_directories(folder, ignored);
        const fs::path path = folder / (name + std::string(kExtension));
        if (!writeFile(path, bytes)) continue;
        prune(folder);
        return path;
    }
    log(log_, LogLevel::info, fmt::format("{} could not be kept: no folder takes its {} bytes", name, bytes.size()));
    return {};
}

} // namespace lightloom
