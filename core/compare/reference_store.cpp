// SPDX-License-Identifier: Apache-2.0
#include "core/compare/reference_store.h"
#include "core/base/byte_stream.h"
#include "core/base/units.h"
#include <cassert>
#include <fmt/format.h>

namespace lightloom {
namespace fs = std::filesystem;

namespace {

/// Rises whenever the reference computes another number, or a file's form changes: older entries are then not found.
constexpr std::uint32_t kVersion = 6;
constexpr std::string_view kMagic = "LLREF\n";

/// Everything that all jobs of one question share. Two references with one key differ in how long they were traced.
class Key {
public:
    Key(std::string kind, const RayScene& rays, const Mix& mix) : kind_(std::move(kind))
    {
        sum_.add(kVersion);
        const Sha256::Digest scene = sceneHash(rays.scene());
        sum_.add(scene.data(), scene.size());
        sum_.add(std::string(rays.isaName()));
        for (std::size_t g = 0; g < rays.scene().groups.size(); ++g) add(gainOf(mix, static_cast<int>(g)));
    }
    Key& add(glm::vec3 v)
    {
        sum_.add(v.x).add(v.y).add(v.z);
        return *this;
    }
    template<class T>
    Key& add(const T& value)
    {
        sum_.add(value);
        return *this;
    }
    const Sha256::Digest& finish() { return digest_ = sum_.finish(); }
    [[nodiscard]] const Sha256::Digest& digest() const { return digest_; }
    /// Entries with this key begin so.
    [[nodiscard]] std::string prefix() const
    {
        return fmt::format("{}-{}-", kind_, toHex(std::span(digest_).first(16)));
    }
    [[nodiscard]] std::string name(int most, float target) const
    {
        return fmt::format("{}{}-{}", prefix(), most, target);
    }

private:
    std::string kind_;
    Sha256 sum_;
    Sha256::Digest digest_{};
};

/// What stands in front of every entry.
struct Head {
    int most = 0; ///< paths or samples asked for
    float target = 0.0f;

    void write(ByteWriter& out, const Sha256::Digest& key) const
    {
        out.put(kMagic);
        out.put(kVersion);
        out.put(key);
        out.put(most);
        out.put(target);
    }
    [[nodiscard]] bool read(ByteReader& in, const Sha256::Digest& key)
    {
        std::uint32_t version = 0;
        Sha256::Digest found{};
        return in.expect(kMagic) && in.get(version) && version == kVersion && in.get(found) && found == key &&
               in.get(most) && in.get(target);
    }
    bool operator==(const Head&) const = default;
};

Error damaged(const char* why) { return {Error::Kind::badInput, why}; }
constexpr const char* kWrongSum = "its checksum differs";
constexpr const char* kWrongContent = "it holds something else than its name says";

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

/// Looks through the entries of one question about probes.
class ProbeSearch {
public:
    ProbeSearch(const Sha256::Digest& key, std::size_t probes, const ReferenceJob& job, ReferenceMatch match,
                bool resume)
        : key_(key), probes_(probes), job_(job), match_(match), resume_(resume)
    {
    }
    KeptReference kept;   ///< what was found whole
    ReferenceState state; ///< else the best to go on with

    Result<bool> look(const fs::path& path, std::span<const std::uint8_t> file)
    {
        const auto content = openSealed(file);
        if (!content) return damaged(kWrongSum);
        ByteReader in(*content);
        Head head;
        ReferenceState found;
        if (!head.read(in, key_) || !in.get(found.goal) || !in.get(found.probes) || !in.get(found.caustics) ||
            !in.get(found.causticRounds) || !in.isAtEnd() || found.probes.size() != probes_) {
            return damaged(kWrongContent);
        }
        ReferenceJob own = job_;
        own.paths = head.most;
        own.targetError = head.target;
        ReferenceResult result = resultOf(found, own);
        if (serves(head, result)) {
            CacheFolders::touch(path);
            kept = {std::move(result), true, 0, path};
            return false;
        }
        if (leadsTo(head) && result.paths > kept.resumed) {
            kept.resumed = result.paths;
            state = std::move(found);
        }
        return true;
    }

private:
    [[nodiscard]] bool serves(const Head& head, const ReferenceResult& result) const
    {
        if (result.finished < probes_) return false;
        const bool isSame = head == Head{job_.paths, job_.targetError};
        if (isSame || match_ == ReferenceMatch::sameBits) return isSame;
        const bool hasPhotons = result.causticPhotons == 0 || result.causticPhotons >= mostCausticPhotons(job_);
        if (hasPhotons && result.leastPaths >= static_cast<std::uint64_t>(job_.paths)) return true;
        return job_.targetError > 0.0f && meets(result, job_.targetError);
    }
    /// True if going on from the entry ends where the job would have come from nothing.
    [[nodiscard]] bool leadsTo(const Head& head) const
    {
        if (head == Head{job_.paths, job_.targetError}) return resume_;
        return head.target == 0.0f && job_.targetError == 0.0f && head.most < job_.paths;
    }

    const Sha256::Digest& key_;
    std::size_t probes_;
    const ReferenceJob& job_;
    ReferenceMatch match_;
    bool resume_;
};

/// A whole picture as it is kept: its pixels, and nothing to go on with.
ViewState whole(const View& view, const ViewState& state)
{
    ViewState kept;
    kept.ended.resize(view.direct.pixels.size());
    for (std::size_t i = 0; i < kept.ended.size(); ++i) {
        const auto samples = state.ended.empty() ? static_cast<std::uint32_t>(view.samples) : state.ended[i].samples;
        kept.ended[i] = {view.direct.pixels[i], view.indirect.pixels[i], view.standardError.pixels[i], samples};
    }
    kept.causticRounds = state.causticRounds;
    return kept;
}

/// Looks through the entries of one question about a camera.
class ViewSearch {
public:
    ViewSearch(const Sha256::Digest& key, const ViewJob& job, ReferenceMatch match, bool resume)
        : key_(key), job_(job), match_(match), resume_(resume)
    {
    }
    KeptView kept;
    ViewState state;

    Result<bool> look(const fs::path& path, std::span<const std::uint8_t> file)
    {
        const auto content = openSealed(file);
        if (!content) return damaged(kWrongSum);
        ByteReader in(*content);
        Head head;
        std::uint32_t isWhole = 0;
        ViewState found;
        const std::size_t pixels = static_cast<std::size_t>(job_.width) * static_cast<std::size_t>(job_.height);
        if (!head.read(in, key_) || !in.get(isWhole) || !in.get(found.pixels) || !in.get(found.ended) ||
            !in.get(found.caustics) || !in.get(found.causticRounds) || !in.isAtEnd() ||
            found.pixels.size() + found.ended.size() != pixels) {
            return damaged(kWrongContent);
        }
        const bool isSame = head == Head{job_.samples, job_.targetError};
        if (isWhole && (isSame || (match_ == ReferenceMatch::asGood && isAsGood(head)))) {
            CacheFolders::touch(path);
            kept = {viewOf(job_, found.ended), true, 0, path};
            kept.result.causticRounds = found.causticRounds;
            return false;
        }
        if (!isWhole && isSame && resume_) {
            for (const PixelSums& p : found.pixels) kept.resumed += p.samples;
            for (const PixelLight& p : found.ended) kept.resumed += p.samples;
            state = std::move(found);
        }
        return true;
    }

private:
    [[nodiscard]] bool isAsGood(const Head& head) const
    {
        if (job_.targetError > 0.0f) return head.target > 0.0f && head.target <= job_.targetError;
        return head.target == 0.0f && head.most >= job_.samples;
    }
    const Sha256::Digest& key_;
    const ViewJob& job_;
    ReferenceMatch match_;
    bool resume_;
};

} // namespace

KeptReference ReferenceStore::illuminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                          const std::vector<ProbePoint>& points, const ReferenceJob& job,
                                          ReferenceMatch match, Workers& workers, const std::stop_token& stop,
                                          const std::function<void(double)>& progress) const
{
    Key key("probes", rays, mix);
    key.add(job.seed).add(job.pathDepth).add(job.directSamples).add(job.caustics);
    key.add(static_cast<std::uint64_t>(points.size()));
    for (const ProbePoint& point : points) key.add(point.position).add(point.normal).add(point.stream);
    const Sha256::Digest& digest = key.finish();

    ProbeSearch search(digest, points.size(), job, match, resume_);
    folders_.forEntries(key.prefix(), [&](const auto& path, auto bytes) { return search.look(path, bytes); });
    KeptReference& kept = search.kept;
    if (kept.wasStored) return std::move(kept);
    kept.result = continueReference(rays, lights, mix, points, job, search.state, workers, stop, progress);
    if (kept.result.paths == 0) return std::move(kept);
    ByteWriter out;
    Head{job.paths, job.targetError}.write(out, digest);
    out.put(search.state.goal);
    out.put(search.state.probes);
    out.put(search.state.caustics);
    out.put(search.state.causticRounds);
    kept.file = folders_.keep(key.name(job.paths, job.targetError), std::move(out).sealed());
    return std::move(kept);
}

namespace {

class ViewKey : public Key {
public:
    ViewKey(const RayScene& rays, const Mix& mix, const ViewJob& job) : Key("view", rays, mix)
    {
        assert(job.indirect == ViewJob::Indirect::paths && job.withDirect);
        const Camera& c = job.camera;
        add(job.seed).add(job.pathDepth).add(job.directSamples).add(job.caustics);
        add(job.width).add(job.height).add(c.position);
        for (int i = 0; i < 4; ++i) add(c.orientation[i]);
        add(c.yFov).add(c.nearPlane);
        finish();
    }
};

} // namespace

ReferenceStore::FoundView ReferenceStore::findPicture(const RayScene& rays, const Mix& mix, const ViewJob& job,
                                                      ReferenceMatch match) const
{
    const ViewKey key(rays, mix, job);
    ViewSearch search(key.digest(), job, match, resume_);
    folders_.forEntries(key.prefix(), [&](const auto& path, auto bytes) { return search.look(path, bytes); });
    return {std::move(search.kept), std::move(search.state)};
}

fs::path ReferenceStore::keepPicture(const RayScene& rays, const Mix& mix, const ViewJob& job, const View& view,
                                     const ViewState& state) const
{
    const ViewKey key(rays, mix, job);
    ByteWriter out;
    Head{job.samples, job.targetError}.write(out, key.digest());
    out.put(static_cast<std::uint32_t>(view.isWhole));
    const ViewState end = view.isWhole ? whole(view, state) : ViewState();
    const ViewState& kept = view.isWhole ? end : state;
    out.put(kept.pixels);
    out.put(kept.ended);
    out.put(kept.caustics);
    out.put(kept.causticRounds);
    return folders_.keep(key.name(job.samples, job.targetError), std::move(out).sealed());
}

KeptView ReferenceStore::picture(const RayScene& rays, const LightSampler& lights, const Mix& mix, const ViewJob& job,
                                 ReferenceMatch match, Workers& workers, const std::stop_token& stop,
                                 const std::function<void(double)>& progress) const
{
    FoundView found = findPicture(rays, mix, job, match);
    KeptView& kept = found.kept;
    if (kept.wasStored) return std::move(kept);
    kept.result = continueView(rays, lights, mix, nullptr, job, found.state, workers, stop, progress);
    if (kept.result.rays > 0) kept.file = keepPicture(rays, mix, job, kept.result, found.state);
    return std::move(kept);
}

} // namespace lightloom
