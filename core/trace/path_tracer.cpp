// SPDX-License-Identifier: Apache-2.0
#include "core/trace/path_tracer.h"
#include "core/base/sampling.h"
#include "core/base/statistics.h"
#include "core/trace/direct_light.h"
#include "core/trace/emitter_choice.h"
#include <array>
#include <atomic>
#include <limits>

namespace lightloom {
namespace {

constexpr int kSureBounces = 3; ///< roulette from the next one on
constexpr int kStrata = 8, kBatch = kStrata * kStrata;
constexpr int kLeastBatches = 8; ///< before a probe's standard error is believed
constexpr float kFar = std::numeric_limits<float>::infinity();

/// Unidirectional paths with next event estimation. Balance heuristic between the lamps and the lobe (Veach 1997).
class PathWalk {
public:
    PathWalk(const RayScene& rays, const LightSampler& lights, const Mix& mix)
        : rays_(rays), lights_(lights), mix_(mix), choice_(lights, mix)
    {
    }

    /// cd/m2 that `hit` emits towards the ray that came along.
    [[nodiscard]] glm::vec3 emitted(const Hit& hit, const Surface& surface) const
    {
        const int e = lights_.emitterOf(hit.triangle);
        if (e < 0) return glm::vec3(0.0f);
        return surface.emission * gainOf(mix_, lights_.emitters()[static_cast<std::size_t>(e)].group);
    }

    /// cd/m2 that `hit` reflects back along `travel`; what it emits itself is left out.
    glm::vec3 reflected(Hit hit, Surface surface, glm::vec3 travel, int pathDepth, Rng& rng) const
    {
        glm::vec3 light(0.0f), throughput(1.0f);
        for (int depth = 1;; ++depth) {
            const glm::vec3 n = hit.facing(), toEye = -travel, start = rays_.leave(hit.position, n);
            light += throughput * fromLamps(surface, start, n, toEye, rng);
            Scatter next;
            const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
            if (depth >= pathDepth || !scatter(surface, n, toEye, u, next)) return light;
            throughput *= next.weight;
            if (depth > kSureBounces) {
                // the root: paths live twice as long as the light does, which thirds the variance at albedo .8 and
                // halves variance x time there; at .5 it costs a tenth more
                const float chance = glm::min(1.0f, std::sqrt(maxChannel(next.weight)));
                if (!(rng.uniform() < chance)) return light;
                throughput /= chance;
            }
            travel = next.away;
            if (!rays_.intersect(start, travel, kFar, hit)) return light;
            surface = surfaceAt(rays_, hit);
            const glm::vec3 emission = emitted(hit, surface);
            if (emission != glm::vec3(0.0f)) light += throughput * emission * lobeShare(next, start, hit);
        }
    }

private:
    /// One lamp, chosen by what it could give.
    glm::vec3 fromLamps(const Surface& surface, glm::vec3 p, glm::vec3 n, glm::vec3 toEye, Rng& rng) const
    {
        const float u = rng.uniform();
        const glm::vec2 where(rng.uniform(), rng.uniform());
        float chance = 0.0f;
        LightSample s;
        const int e = choice_.pick(p, u, chance);
        if (e < 0 || !lights_.sample(e, p, where, s)) return glm::vec3(0.0f);
        const float cosine = glm::dot(n, s.toLight);
        if (!(cosine > 0.0f)) return glm::vec3(0.0f);
        const glm::vec3 f = brdf(surface, n, s.toLight, toEye);
        if (f == glm::vec3(0.0f) || rays_.isBlocked(p, s.end)) return glm::vec3(0.0f);
        const glm::vec3 reflected = f * gainOf(mix_, lights_.emitters()[static_cast<std::size_t>(e)].group) * cosine;
        if (s.isPunctual()) return reflected * s.illuminance / chance;
        return reflected * s.radiance / (chance * s.pdf + scatterPdf(surface, n, s.toLight, toEye));
    }

    /// The lobe's weight for an emitter that its ray met by chance.
    [[nodiscard]] float lobeShare(const Scatter& lobe, glm::vec3 from, const Hit& hit) const
    {
        if (lobe.isMirror) return 1.0f;
        const float lamps = choice_.chance(from, lights_.emitterOf(hit.triangle)) * lights_.pdf(from, hit);
        return lobe.pdf / (lobe.pdf + lamps);
    }

    const RayScene& rays_;
    const LightSampler& lights_;
    const Mix& mix_;
    EmitterChoice choice_;
};

/// What the batches of one probe have said so far.
struct ProbeSums {
    std::array<RunningMean, 3> direct, indirect;
    int batches = 0;

    void add(glm::dvec3 d, glm::dvec3 i)
    {
        for (int c = 0; c < 3; ++c) {
            direct[static_cast<std::size_t>(c)].add(d[c]);
            indirect[static_cast<std::size_t>(c)].add(i[c]);
        }
        ++batches;
    }
    [[nodiscard]] ProbeLight result() const
    {
        ProbeLight light;
        for (int c = 0; c < 3; ++c) {
            const auto k = static_cast<std::size_t>(c);
            light.direct[c] = static_cast<float>(direct[k].mean());
            light.indirect[c] = static_cast<float>(indirect[k].mean());
            light.directError[c] = static_cast<float>(direct[k].standardError());
            light.indirectError[c] = static_cast<float>(indirect[k].standardError());
        }
        return light;
    }
};

class ReferenceRun {
public:
    ReferenceRun(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                 const std::vector<ProbePoint>& points, const ReferenceJob& job)
        : rays_(rays), lights_(lights), mix_(mix), points_(points), job_(job), walk_(rays, lights, mix),
          sums_(points.size())
    {
        int surfaces = 0;
        for (const Emitter& e : lights.emitters()) surfaces += e.kind == Emitter::Kind::surface ? 1 : 0;
        lampSamples_ = glm::max(1, job.directSamples / glm::max(1, surfaces));
    }

    /// At least two batches: one alone has no spread to tell its error from.
    [[nodiscard]] int mostBatches() const { return glm::max(2, (job_.paths + kBatch - 1) / kBatch); }

    /// Works on a probe until it has `batches` or its errors are small enough. False: stopped.
    bool refine(std::size_t probe, int batches, const ProbeLight& goodEnough, const std::stop_token& stop)
    {
        ProbeSums& sums = sums_[probe];
        while (sums.batches < batches) {
            if (sums.batches >= kLeastBatches && isWithin(sums.result(), goodEnough)) return true;
            if (stop.stop_requested()) return false;
            addBatch(points_[probe], sums);
        }
        return true;
    }

    /// The errors at which a probe is done: the target's share of the means over all probes.
    [[nodiscard]] ProbeLight goal() const
    {
        glm::dvec3 direct(0.0), indirect(0.0);
        for (const ProbeSums& s : sums_) {
            const ProbeLight light = s.result();
            direct += glm::dvec3(light.direct);
            indirect += glm::dvec3(light.indirect);
        }
        const double share = static_cast<double>(job_.targetError) / glm::max<double>(1.0, double(sums_.size()));
        ProbeLight light;
        light.directError = glm::vec3(direct * share);
        light.indirectError = glm::vec3(indirect * share);
        return light;
    }

    [[nodiscard]] ReferenceResult result(std::size_t finished) const
    {
        ReferenceResult out;
        out.finished = finished;
        for (const ProbeSums& s : sums_) {
            out.probes.push_back(s.result());
            const std::uint64_t paths = static_cast<std::uint64_t>(s.batches) * kBatch;
            out.paths += paths;
            out.leastPaths = out.probes.size() == 1 ? paths : std::min(out.leastPaths, paths);
        }
        return out;
    }

private:
    static bool isWithin(const ProbeLight& light, const ProbeLight& goal)
    {
        return luminance(light.directError) <= luminance(goal.directError) &&
               luminance(light.indirectError) <= luminance(goal.indirectError);
    }

    void addBatch(const ProbePoint& point, ProbeSums& sums) const
    {
        Rng rng(job_.seed, point.stream, static_cast<std::uint64_t>(sums.batches));
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
        sums.add(direct, indirect * (std::numbers::pi / kBatch));
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
    const std::vector<ProbePoint>& points_;
    const ReferenceJob& job_;
    PathWalk walk_;
    std::vector<ProbeSums> sums_;
    int lampSamples_ = 1;
};

} // namespace

glm::vec3 tracePath(const RayScene& rays, const LightSampler& lights, const Mix& mix, glm::vec3 origin,
                    glm::vec3 travel, bool withEmission, int pathDepth, Rng& rng)
{
    Hit hit;
    if (!rays.intersect(origin, travel, kFar, hit)) return glm::vec3(0.0f);
    const PathWalk walk(rays, lights, mix);
    const Surface surface = surfaceAt(rays, hit);
    const glm::vec3 own = withEmission ? walk.emitted(hit, surface) : glm::vec3(0.0f);
    return own + walk.reflected(hit, surface, travel, pathDepth, rng);
}

ReferenceResult referenceIlluminance(const RayScene& rays, const LightSampler& lights, const Mix& mix,
                                     const std::vector<ProbePoint>& points, const ReferenceJob& job, Workers& workers,
                                     const std::stop_token& stop, const std::function<void(double)>& progress)
{
    ReferenceRun run(rays, lights, mix, points, job);
    const bool isAdaptive = job.targetError > 0.0f && run.mostBatches() > kLeastBatches;
    std::vector<std::atomic<bool>> isDone(points.size());
    std::atomic<std::size_t> done = 0;
    const auto sweep = [&](int batches, const ProbeLight& goal, double from, double to) {
        done = 0;
        return workers.run(points.size(), stop, [&, batches, goal, from, to](std::size_t i) {
            isDone[i] = run.refine(i, batches, goal, stop);
            const std::size_t ended = ++done;
            if (progress)
                progress(from + (to - from) * static_cast<double>(ended) / static_cast<double>(points.size()));
        });
    };
    ProbeLight never; // a goal no error can meet: work until the batches are full
    never.directError = never.indirectError = glm::vec3(-1.0f);
    bool all = true;
    if (isAdaptive) {
        all = sweep(kLeastBatches, never, 0.0, 0.1);
        for (auto& d : isDone) d = false;
        if (all) all = sweep(run.mostBatches(), run.goal(), 0.1, 1.0);
    } else {
        all = sweep(run.mostBatches(), never, 0.0, 1.0);
    }
    std::size_t finished = 0;
    while (finished < points.size() && isDone[finished]) ++finished;
    return run.result(finished);
}

} // namespace lightloom
