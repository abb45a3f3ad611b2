// SPDX-License-Identifier: Apache-2.0
#include "core/trace/reference.h"
#include "core/base/sampling.h"
#include "core/base/units.h"
#include "core/trace/path_walk.h"
#include <atomic>
#include <limits>

namespace lightloom {
namespace {

constexpr int kStrata = 8, kBatch = kStrata * kStrata;
constexpr float kFar = std::numeric_limits<float>::infinity();
using Sums = CrossedMean<6>;

std::uint64_t mostBatches(const ReferenceJob& job)
{
    return static_cast<std::uint64_t>(glm::max(2, (job.paths + kBatch - 1) / kBatch));
}

bool isAdaptive(const ReferenceJob& job) { return job.targetError > 0.0f && mostBatches(job) > 2 * Sums::kLeast; }

bool isDone(const Sums& sums, const ReferenceJob& job) { return sums.isEnded() || sums.batches() >= mostBatches(job); }

/// Of three numbers, one per channel, from `first` on.
double luminanceOf(const Sums::Values& v, std::size_t first)
{
    return static_cast<double>(kLumaR) * v[first] + static_cast<double>(kLumaG) * v[first + 1] +
           static_cast<double>(kLumaB) * v[first + 2];
}

ProbeLight lightOf(const Sums& sums)
{
    ProbeLight light;
    for (int c = 0; c < 3; ++c) {
        const auto k = static_cast<std::size_t>(c);
        light.direct[c] = static_cast<float>(sums.mean(k));
        light.indirect[c] = static_cast<float>(sums.mean(k + 3));
        light.directError[c] = static_cast<float>(sums.standardError(k));
        light.indirectError[c] = static_cast<float>(sums.standardError(k + 3));
    }
    return light;
}

/// Traces batches of one probe after another into their sums. Batch b of a probe depends on nothing but the job and the
/// probe: a run may stop and go on between any two.
class ReferenceRun {
public:
    ReferenceRun(const RayScene& rays, const LightSampler& lights, const Mix& mix, const ReferenceJob& job,
                 const CausticLamps& byPhotons)
        : rays_(rays), lights_(lights), mix_(mix), job_(job),
          walk_(rays, lights, mix, job.caustics ? &byPhotons : nullptr)
    {
        int surfaces = 0;
        for (const Emitter& e : lights.emitters()) surfaces += e.kind == Emitter::Kind::surface ? 1 : 0;
        lampSamples_ = glm::max(1, job.directSamples / glm::max(1, surfaces));
    }

    /// Up to `batches`, or until both chains have ended, with a goal. False: stopped before.
    bool refine(const ProbePoint& point, Sums& sums, std::uint64_t batches, glm::dvec2 goal,
                const std::stop_token& stop) const
    {
        const auto isEnough = [goal](const Sums::Values& errors) {
            return luminanceOf(errors, 0) <= goal.x && luminanceOf(errors, 3) <= goal.y;
        };
        while (true) {
            if (goal.x >= 0.0) sums.look(isEnough);
            if (sums.isEnded() || sums.batches() >= batches) return true;
            if (stop.stop_requested()) return false;
            sums.add(batch(point, sums.batches()));
        }
    }

private:
    [[nodiscard]] Sums::Values batch(const ProbePoint& point, std::uint64_t number) const
    {
        Rng rng(job_.seed, point.stream, number);
        glm::dvec3 direct = fromLamps(point, rng), indirect(0.0);
        const Frame frame(point.normal);
        const glm::vec3 start = rays_.leave(point.position, point.normal);
        for (int i = 0; i < kBatch; ++i) {
            const float u1 = (static_cast<float>(i % kStrata) + rng.uniform()) / kStrata;
            const float u2 = (static_cast<float>(i / kStrata) + rng.uniform()) / kStrata;
            const glm::vec3 local = sampleCosineHemisphere(u1, u2), travel = frame.toWorld(local);
            Hit hit;
            if (!rays_.intersect(start, travel, kFar, hit)) continue;
            const Surface surface = surfaceAt(rays_, hit);
            const glm::vec3 emission = walk_.emitted(hit, surface);
            if (emission != glm::vec3(0.0f)) {
                const double lobe = kBatch * static_cast<double>(local.z) / std::numbers::pi;
                const double lamps = lampSamples_ * static_cast<double>(lights_.pdf(point.position, hit));
                direct += glm::dvec3(emission) * (local.z / (lobe + lamps));
            }
            indirect += glm::dvec3(walk_.reflected(hit, surface, travel, job_.pathDepth, rng));
        }
        indirect *= std::numbers::pi / kBatch;
        return {direct.x, direct.y, direct.z, indirect.x, indirect.y, indirect.z};
    }

    /// The share of direct light that samples of the lamps bring; the gather rays of the batch bring the rest.
    [[nodiscard]] glm::dvec3 fromLamps(const ProbePoint& point, Rng& rng) const
    {
        glm::dvec3 sum(0.0);
        const glm::vec3 start = rays_.leave(point.position, point.normal);
        for (std::size_t e = 0; e < lights_.emitters().size(); ++e) {
            const Emitter& emitter = lights_.emitters()[e];
            const glm::dvec3 gain(gainOf(mix_, emitter.group));
            if (gain == glm::dvec3(0.0)) continue;
            const int count = emitter.kind == Emitter::Kind::surface ? lampSamples_ : 1;
            for (int i = 0; i < count; ++i) {
                const glm::vec2 u((static_cast<float>(i) + rng.uniform()) / static_cast<float>(count), rng.uniform());
                LightSample s;
                if (!lights_.sample(static_cast<int>(e), point.position, u, s)) continue;
                const float cosine = glm::dot(point.normal, s.toLight);
                if (!(cosine > 0.0f) || rays_.isBlocked(start, s.end)) continue;
                const double c = static_cast<double>(cosine), lobe = kBatch * c / std::numbers::pi;
                if (s.isPunctual())
                    sum += gain * glm::dvec3(s.illuminance) * c;
                else
                    sum += gain * glm::dvec3(s.radiance) * (c / (lobe + count * static_cast<double>(s.pdf)));
            }
        }
        return sum;
    }

    const RayScene& rays_;
    const LightSampler& lights_;
    const Mix& mix_;
    const ReferenceJob& job_;
    PathWalk walk_;
    int lampSamples_ = 1;
};

/// The errors at which a probe is done: the target's share of the means over all probes.
glm::dvec2 goalOf(const std::vector<Sums>& probes, float target)
{
    glm::dvec2 sum(0.0);
    for (const Sums& s : probes) {
        Sums::Values mean;
        for (std::size_t k = 0; k < mean.size(); ++k) mean[k] = s.mean(k);
        sum += glm::dvec2(luminanceOf(mean, 0), luminanceOf(mean, 3));
    }
    return sum * (static_cast<double>(target) / glm::max(1.0, static_cast<double>(probes.size())));
}

constexpr std::uint64_t kLeastRounds = 16;

/// Rounds of photons that go with the paths.
std::uint64_t roundsOf(const ReferenceJob& job) { return std::max(kLeastRounds, mostBatches(job)); }

CausticJob causticJob(const ReferenceJob& job) { return {job.seed, job.pathDepth}; }

/// True once the errors of the photons' share are within the goal for indirect light, over all probes: one number for
/// all, so that hardly any probe's own noise ends the run. The goal knows the paths' light; the photons' counts, too.
bool isFineEnough(const ReferenceState& state, const ReferenceJob& job)
{
    if (!isAdaptive(job) || state.causticRounds < kLeastRounds) return false;
    double squares = 0.0, light = 0.0;
    for (const CausticSums& s : state.caustics) {
        const double error = static_cast<double>(luminance(glm::vec3(s.standardError())));
        squares += error * error;
        light += static_cast<double>(luminance(glm::vec3(s.mean())));
    }
    const auto count = static_cast<double>(state.caustics.size());
    const double goal = state.goal.y + static_cast<double>(job.targetError) * light / count;
    return squares <= goal * goal * count;
}

/// Goes on with the rounds until there are enough. False: stopped.
bool traceCaustics(const RayScene& rays, const CausticLamps& lamps, const std::vector<ProbePoint>& points,
                   const ReferenceJob& job, ReferenceState& state, Workers& workers, const std::stop_token& stop,
                   const std::function<void(double)>& progress)
{
    state.caustics.resize(points.size());
    const float most = causticRadius(rays, 0);
    std::vector<CatchPoint> discs;
    for (const ProbePoint& p : points) {
        discs.push_back({p.position, p.normal, clearRadius(rays, p.position, p.normal, most)});
    }
    const std::uint64_t rounds = roundsOf(job);
    while (state.causticRounds < rounds) {
        if (isFineEnough(state, job)) return true;
        if (!addCausticRound(rays, lamps, causticJob(job), state.causticRounds, discs, state.caustics, workers, stop))
            return false;
        ++state.causticRounds;
        if (progress) progress(static_cast<double>(state.causticRounds) / static_cast<double>(rounds));
    }
    return true;
}

/// True if the rounds that the job asks for are all there.
bool hasAllRounds(const ReferenceState& state, const ReferenceJob& job)
{
    return state.caustics.empty() || state.causticRounds >= roundsOf(job) || isFineEnough(state, job);
}

void addCaustics(const ReferenceState& state, const ReferenceJob& job, ReferenceResult& result)
{
    if (state.caustics.empty()) return;
    result.causticPhotons = state.causticRounds * causticJob(job).photons;
    double radii = 0.0;
    for (std::size_t i = 0; i < state.caustics.size(); ++i) {
        const CausticSums& sums = state.caustics[i];
        ProbeLight& light = result.probes[i];
        light.caustic = glm::vec3(sums.mean());
        light.indirect += light.caustic;
        const glm::dvec3 paths(light.indirectError), photons = sums.standardError();
        light.indirectError = glm::vec3(glm::sqrt(paths * paths + photons * photons));
        light.causticBlur = static_cast<float>(sums.blurBound());
        radii += sums.radiusSum;
    }
    const double count = static_cast<double>(state.caustics.size()) * static_cast<double>(state.causticRounds);
    result.causticRadius = radii / std::max(1.0, count);
}

} // namespace

std::uint64_t mostCausticPhotons(const ReferenceJob& job) { return roundsOf(job) * causticJob(job).photons; }

ReferenceResult resultOf(const ReferenceState& state, const ReferenceJob& job)
{
    ReferenceResult out;
    out.probes.reserve(state.probes.size());
    bool isWhole = true;
    for (const Sums& s : state.probes) {
        const std::uint64_t paths = s.batches() * kBatch;
        isWhole = isWhole && isDone(s, job);
        out.finished += isWhole ? 1 : 0;
        out.capped += isAdaptive(job) && isDone(s, job) && !s.isEnded() ? 1 : 0;
        out.paths += paths;
        out.leastPaths = out.probes.empty() ? paths : std::min(out.leastPaths, paths);
        out.probes.push_back(lightOf(s));
    }
    addCaustics(state, job, out);
    if (!hasAllRounds(state, job)) out.finished = 0;
    return out;
}

ReferenceResult continueReference(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                  const std::vector<ProbePoint>& points, const ReferenceJob& job, ReferenceState& state,
                                  Workers& workers, const std::stop_token& stop,
                                  const std::function<void(double)>& progress)
{
    state.probes.resize(points.size());
    const CausticLamps lamps(rays, lights, mix);
    const ReferenceRun run(rays, lights, mix, job, lamps);
    const bool byPhotons = job.caustics && !lamps.isEmpty() && !points.empty();
    if (byPhotons) state.caustics.resize(points.size());
    std::atomic<std::size_t> ended = 0;
    const auto sweep = [&](std::uint64_t batches, double from, double to) {
        ended = 0;
        std::atomic<bool> isStopped = false;
        const bool all = workers.run(points.size(), stop, [&, batches, from, to](std::size_t i) {
            if (!run.refine(points[i], state.probes[i], batches, state.goal, stop)) isStopped = true;
            const double part = static_cast<double>(++ended) / static_cast<double>(points.size());
            if (progress) progress(from + (to - from) * part);
        });
        return all && !isStopped;
    };
    double from = 0.0;
    const double end = byPhotons ? 0.5 : 1.0;
    if (isAdaptive(job) && state.goal.x < 0.0) {
        from = 0.1 * end;
        if (!sweep(2 * Sums::kLeast, 0.0, from)) return resultOf(state, job);
        state.goal = goalOf(state.probes, job.targetError);
    }
    if (!sweep(mostBatches(job), from, end) || !byPhotons) return resultOf(state, job);
    static_cast<void>(traceCaustics(rays, lamps, points, job, state, workers, stop, [&](double fraction) {
        if (progress) progress(end + (1.0 - end) * fraction);
    }));
    return resultOf(state, job);
}

ReferenceResult referenceIlluminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                     const std::vector<ProbePoint>& points, const ReferenceJob& job, Workers& workers,
                                     const std::stop_token& stop, const std::function<void(double)>& progress)
{
    ReferenceState state;
    return continueReference(rays, lights, mix, points, job, state, workers, stop, progress);
}

} // namespace lightloom
