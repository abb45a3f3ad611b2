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

/// A reference on disk: for what job, and how far it came.
struct Entry {
    int paths = 0;
    float targetError = 0.0f;
    ReferenceState state;
};

std::vector<std::uint8_t> encode(const Sha256::Digest& key, const ReferenceJob& job, const ReferenceState& state)
{
    ByteWriter out;
    out.put(kMagic);
    out.put(kVersion);
    out.put(key);
    out.put(job.paths);
    out.put(job.targetError);
    out.put(state.goal);
    out.put(state.probes);
    return std::move(out).sealed();
}

Result<Entry> decode(std::span<const std::uint8_t> file, const Sha256::Digest& key, std::size_t probes)
{
    const auto content = openSealed(file);
    if (!content) return Error{Error::Kind::badInput, "its checksum differs"};
    ByteReader in(*content);
    std::uint32_t version = 0;
    Sha256::Digest found{};
    Entry entry;
    const bool isRead = in.expect(kMagic) && in.get(version) && version == kVersion && in.get(found) && found == key &&
                        in.get(entry.paths) && in.get(entry.targetError) && in.get(entry.state.goal) &&
                        in.get(entry.state.probes) && in.isAtEnd() && entry.state.probes.size() == probes;
    if (!isRead) return Error{Error::Kind::badInput, "it holds something else than its name says"};
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

bool isSameJob(const Entry& entry, const ReferenceJob& job)
{
    return entry.paths == job.paths && entry.targetError == job.targetError;
}

bool serves(const Entry& entry, const ReferenceJob& job, ReferenceMatch match)
{
    ReferenceJob own = job;
    own.paths = entry.paths;
    own.targetError = entry.targetError;
    const ReferenceResult result = resultOf(entry.state, own);
    if (result.finished < result.probes.size()) return false;
    if (isSameJob(entry, job) || match == ReferenceMatch::sameBits) return isSameJob(entry, job);
    if (result.leastPaths >= static_cast<std::uint64_t>(job.paths)) return true;
    return job.targetError > 0.0f && meets(result, job.targetError);
}

/// True if going on from `entry` ends where `job` would have come from nothing.
bool leadsTo(const Entry& entry, const ReferenceJob& job, bool resume)
{
    if (isSameJob(entry, job)) return resume;
    return entry.targetError == 0.0f && job.targetError == 0.0f && entry.paths < job.paths;
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

ReferenceStore::ReferenceStore(const fs::path& sceneFile, LogSink log, bool resume)
    : log_(std::move(log)), resume_(resume)
{
    std::error_code error;
    const fs::path scene = fs::absolute(sceneFile, error);
    folders_.push_back((error ? sceneFile : scene).string() + ".lightloom-cache");
    if (const fs::path cache = userCache(); !cache.empty()) folders_.push_back(cache);
}

/// Calls `visit` for every sound entry that begins with `prefix`; damaged ones are told and removed.
template<class Visit>
void ReferenceStore::forEntries(const std::string& prefix, const Visit& visit) const
{
    for (const fs::path& folder : folders_) {
        for (const fs::path& path : entriesIn(folder, prefix)) {
            const Result<std::vector<std::uint8_t>> bytes = readFile(path, kMostFileBytes);
            if (!bytes) continue; // another program may just have pruned it
            const Result<Done> seen = visit(path, std::span(*bytes));
            if (seen) continue;
            log(log_, LogLevel::warning,
                fmt::format("{} is damaged ({}); traced anew", path.string(), seen.error().message));
            std::error_code ignored;
            fs::remove(path, ignored);
        }
    }
}

/// Where it was put; empty: no folder took it.
fs::path ReferenceStore::keep(const fs::path& name, std::span<const std::uint8_t> bytes) const
{
    for (const fs::path& folder : folders_) {
        std::error_code ignored;
        fs::create_directories(folder, ignored);
        if (!writeFile(folder / name, bytes)) continue;
        prune(folder);
        return folder / name;
    }
    if (!folders_.empty()) log(log_, LogLevel::info, "the reference could not be kept: no folder takes it");
    return {};
}

KeptReference ReferenceStore::illuminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                          const std::vector<ProbePoint>& points, const ReferenceJob& job,
                                          ReferenceMatch match, Workers& workers, const std::stop_token& stop,
                                          const std::function<void(double)>& progress) const
{
    const Sha256::Digest key = keyOf(rays, mix, points, job);
    KeptReference kept;
    ReferenceState state;
    forEntries(prefixOf(key), [&](const fs::path& path, std::span<const std::uint8_t> bytes) -> Result<Done> {
        if (kept.wasStored) return Done{};
        Result<Entry> entry = decode(bytes, key, points.size());
        if (!entry) return entry.error();
        if (serves(*entry, job, match)) {
            std::error_code ignored;
            fs::last_write_time(path, fs::file_time_type::clock::now(), ignored); // so that it is pruned last
            ReferenceJob own = job;
            own.paths = entry->paths;
            own.targetError = entry->targetError;
            kept = {resultOf(entry->state, own), true, 0, path};
        } else if (leadsTo(*entry, job, resume_)) {
            const std::uint64_t paths = resultOf(entry->state, job).paths;
            if (paths > kept.resumed) {
                kept.resumed = paths;
                state = std::move(entry->state);
            }
        }
        return Done{};
    });
    if (kept.wasStored) return kept;
    kept.result = continueReference(rays, lights, mix, points, job, state, workers, stop, progress);
    if (kept.result.paths > 0) kept.file = keep(nameOf(key, job), encode(key, job, state));
    return kept;
}

} // namespace lightloom
