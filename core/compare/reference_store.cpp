// SPDX-License-Identifier: Apache-2.0
#include "core/compare/reference_store.h"
#include "core/base/atomic_file.h"
#include "core/base/byte_stream.h"
#include "core/base/units.h"
#include <cstdlib>
#include <fmt/format.h>
#include <unistd.h>

namespace lightloom {
namespace fs = std::filesystem;

namespace {

/// Rises whenever the reference computes another number, or the file's form changes: older entries are then not found.
constexpr std::uint32_t kVersion = 1;
constexpr std::string_view kMagic = "LLREF\n";
constexpr std::string_view kExtension = ".llref";
constexpr std::uint64_t kMostFileBytes = 1ull << 30, kMostFolderBytes = 1ull << 30;

/// Everything that all jobs of one question share. Two references with one key differ in how long they were traced.
Sha256::Digest keyOf(const RayScene& rays, const Mix& mix, const std::vector<ProbePoint>& points,
                     const ReferenceJob& job)
{
    Sha256 sum;
    sum.add(kVersion);
    const Sha256::Digest scene = sceneHash(rays.scene());
    sum.add(scene.data(), scene.size());
    sum.add(std::string(rays.isaName()));
    for (std::size_t g = 0; g < rays.scene().groups.size(); ++g) {
        const glm::vec3 gain = gainOf(mix, static_cast<int>(g));
        sum.add(gain.x).add(gain.y).add(gain.z);
    }
    sum.add(job.seed).add(job.pathDepth).add(job.directSamples);
    sum.add(static_cast<std::uint64_t>(points.size()));
    for (const ProbePoint& point : points) {
        for (const glm::vec3 v : {point.position, point.normal}) sum.add(v.x).add(v.y).add(v.z);
        sum.add(point.stream);
    }
    return sum.finish();
}

/// "probes-<key>-<paths>-<target>": the name alone tells what an entry may serve.
std::string prefixOf(const Sha256::Digest& key) { return fmt::format("probes-{}-", toHex(std::span(key).first(16))); }

fs::path nameOf(const Sha256::Digest& key, const ReferenceJob& job)
{
    return fmt::format("{}{}-{}{}", prefixOf(key), job.paths, job.targetError, kExtension);
}

std::vector<std::uint8_t> encode(const Sha256::Digest& key, const ReferenceJob& job, const ReferenceResult& result)
{
    ByteWriter out;
    out.put(kMagic);
    out.put(kVersion);
    out.put(key);
    out.put(job.paths);
    out.put(job.targetError);
    out.put(result.paths);
    out.put(result.leastPaths);
    out.put(result.probes);
    return std::move(out).sealed();
}

struct Entry {
    int paths = 0;
    float targetError = 0.0f;
    ReferenceResult result;
};

Result<Entry> decode(std::span<const std::uint8_t> file, const Sha256::Digest& key, std::size_t probes)
{
    const auto content = openSealed(file);
    if (!content) return Error{Error::Kind::badInput, "its checksum differs"};
    ByteReader in(*content);
    std::uint32_t version = 0;
    Sha256::Digest found{};
    Entry entry;
    ReferenceResult& r = entry.result;
    const bool isRead = in.expect(kMagic) && in.get(version) && version == kVersion && in.get(found) && found == key &&
                        in.get(entry.paths) && in.get(entry.targetError) && in.get(r.paths) && in.get(r.leastPaths) &&
                        in.get(r.probes) && in.isAtEnd() && r.probes.size() == probes;
    if (!isRead) return Error{Error::Kind::badInput, "it holds something else than its name says"};
    r.finished = probes;
    return entry;
}

/// Rms over the probes of the luminance of an error is at most `target` of the mean over all probes, direct and
/// indirect each.
bool meets(const ReferenceResult& result, float target)
{
    glm::dvec2 means(0.0), squares(0.0);
    for (const ProbeLight& p : result.probes) {
        means += glm::dvec2(luminance(p.direct), luminance(p.indirect));
        const glm::dvec2 error(luminance(p.directError), luminance(p.indirectError));
        squares += error * error;
    }
    const double count = static_cast<double>(result.probes.size());
    const glm::dvec2 rms = glm::sqrt(squares / count), goal = means / count * static_cast<double>(target);
    return rms.x <= goal.x && rms.y <= goal.y;
}

bool serves(const Entry& entry, const ReferenceJob& job, ReferenceMatch match)
{
    const bool isSame = entry.paths == job.paths && entry.targetError == job.targetError;
    if (isSame || match == ReferenceMatch::sameBits) return isSame;
    if (entry.result.leastPaths >= static_cast<std::uint64_t>(job.paths)) return true;
    return job.targetError > 0.0f && meets(entry.result, job.targetError);
}

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

/// Removes the entries unused for longest until the folder holds no more than it should.
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

ReferenceStore::ReferenceStore(const fs::path& sceneFile, LogSink log) : log_(std::move(log))
{
    std::error_code error;
    const fs::path scene = fs::absolute(sceneFile, error);
    folders_.push_back((error ? sceneFile : scene).string() + ".lightloom-cache");
    if (const fs::path cache = userCache(); !cache.empty()) folders_.push_back(cache);
}

KeptReference ReferenceStore::illuminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                          const std::vector<ProbePoint>& points, const ReferenceJob& job,
                                          ReferenceMatch match, Workers& workers, const std::stop_token& stop,
                                          const std::function<void(double)>& progress) const
{
    const Sha256::Digest key = keyOf(rays, mix, points, job);
    KeptReference kept;
    for (const fs::path& folder : folders_) {
        for (const fs::path& path : entriesIn(folder, prefixOf(key))) {
            const Result<std::vector<std::uint8_t>> bytes = readFile(path, kMostFileBytes);
            if (!bytes) continue; // another program may just have pruned it
            Result<Entry> entry = decode(*bytes, key, points.size());
            if (!entry) {
                log(log_, LogLevel::warning,
                    fmt::format("{} is damaged ({}); traced anew", path.string(), entry.error().message));
                std::error_code ignored;
                fs::remove(path, ignored);
                continue;
            }
            if (!serves(*entry, job, match)) continue;
            std::error_code ignored;
            fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
            return {std::move(entry->result), true, path};
        }
    }
    kept.result = referenceIlluminance(rays, lights, mix, points, job, workers, stop, progress);
    if (kept.result.finished < points.size()) return kept;
    const std::vector<std::uint8_t> bytes = encode(key, job, kept.result);
    for (const fs::path& folder : folders_) {
        std::error_code ignored;
        fs::create_directories(folder, ignored);
        const fs::path path = folder / nameOf(key, job);
        if (!writeFile(path, std::span(bytes))) continue;
        prune(folder);
        kept.file = path;
        return kept;
    }
    if (!folders_.empty()) log(log_, LogLevel::info, "the reference could not be kept: no folder takes it");
    return kept;
}

} // namespace lightloom
