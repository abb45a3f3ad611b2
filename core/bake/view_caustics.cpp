// SPDX-License-Identifier: Apache-2.0
#include "core/bake/view_caustics.h"
#include "core/base/units.h"
#include "core/trace/medium.h"
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint64_t kStream = hashName("render view, caustics"), kMostRounds = 256;
constexpr int kMostMirrors = 32; ///< as many as the paths follow (view_eye)

/// A matt surface that a pixel shows.
struct MattPoint {
    std::size_t pixel;
    glm::vec3 position, normal;
    glm::vec3 weight; ///< radiance towards the eye (cd/m2) for each lux there
};

void lookAlong(const RayScene& rays, glm::vec3 origin, glm::vec3 travel, std::size_t pixel, Rng& rng,
               std::vector<MattPoint>& found)
{
    glm::vec3 throughput(1.0f);
    Medium medium;
    for (int bounce = 0; bounce < kMostMirrors; ++bounce) {
        Hit hit;
        if (!rays.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) return;
        const Surface surface = surfaceAt(rays, hit);
        if (medium.absorbs(hit, surface)) throughput *= medium.transmittance(hit, surface);
        const glm::vec3 n = hit.facing();
        if (surface.diffuse != glm::vec3(0.0f))
            found.push_back({pixel, hit.position, n, throughput * surface.diffuse / kPi});
        Scatter next;
        const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
        if (!surface.isSeenInto() || !scatter(surface, n, -travel, u, next) || !next.isSpecular) return;
        throughput *= next.radianceWeight();
        medium.cross(hit, surface, next);
        origin = rays.leave(hit.position, next.side(n));
        travel = next.away;
    }
}

/// What all pixels show along one ray each, row by row; nothing after a stop.
std::vector<MattPoint> look(const ViewPass& pass, const RayScene& rays, std::uint64_t round)
{
    const auto width = static_cast<std::size_t>(pass.job.width), height = static_cast<std::size_t>(pass.job.height);
    std::vector<std::vector<MattPoint>> rows(height);
    const bool isWhole = pass.workers.run(height, pass.stop, [&](std::size_t y) {
        for (std::size_t x = 0; x < width; ++x) {
            const std::size_t pixel = y * width + x;
            Rng rng(pass.job.seed, mixBits(kStream + pixel), round);
            const float u = rng.uniform(), v = rng.uniform();
            glm::vec3 origin, travel;
            pass.lens.ray(static_cast<int>(x), static_cast<int>(y), {u, v}, origin, travel);
            lookAlong(rays, origin, travel, pixel, rng, rows[y]);
        }
    });
    std::vector<MattPoint> all;
    if (!isWhole) return all;
    for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
    return all;
}

bool addRound(const ViewPass& pass, const RayScene& rays, const CausticLamps& lamps, ViewState& state)
{
    const std::uint64_t round = state.causticRounds;
    const float radius = causticRadius(rays, round);
    const std::vector<MattPoint> seen = look(pass, rays, round);
    if (pass.stop.stop_requested()) return false;
    std::vector<CatchPoint> points;
    points.reserve(seen.size());
    for (const MattPoint& p : seen) points.push_back({p.position, p.normal, radius});
    const CausticDiscs discs(rays, points, lamps.flux());
    const CausticJob job{pass.job.seed, pass.job.pathDepth};
    if (!shootCaustics(rays, lamps, job, round, discs, radius, pass.workers, pass.stop)) return false;
    std::size_t i = 0;
    while (i < seen.size()) { // all of a pixel's points stand together
        const std::size_t pixel = seen[i].pixel;
        glm::dvec3 light(0.0);
        for (; i < seen.size() && seen[i].pixel == pixel; ++i)
            light += glm::dvec3(seen[i].weight) * discs.illuminance(i);
        state.caustics[pixel].sum += light;
        state.caustics[pixel].squares += light * light;
    }
    ++state.causticRounds;
    return true;
}

} // namespace

std::uint64_t causticRounds(const ViewJob& job)
{
    const auto samples = static_cast<std::uint64_t>(job.samples);
    return job.targetError > 0.0f ? kMostRounds : std::min(samples, kMostRounds);
}

bool traceCaustics(const ViewPass& pass, const RayScene& rays, const CausticLamps& lamps, ViewState& state)
{
    state.caustics.resize(pass.pixelCount());
    const std::uint64_t rounds = causticRounds(pass.job);
    while (state.causticRounds < rounds) {
        if (!addRound(pass, rays, lamps, state)) return false;
        if (pass.progress) pass.progress(static_cast<double>(state.causticRounds) / static_cast<double>(rounds));
    }
    return true;
}

void addCaustics(const ViewState& state, const ViewJob& job, View& view)
{
    view.causticRounds = state.causticRounds;
    view.isWhole = view.isWhole && state.causticRounds >= causticRounds(job);
    if (state.causticRounds == 0) return;
    const auto n = static_cast<double>(state.causticRounds);
    for (std::size_t i = 0; i < state.caustics.size(); ++i) {
        const glm::dvec3 mean = state.caustics[i].sum / n;
        view.indirect.pixels[i] += glm::vec3(mean);
        if (n < 2.0) continue;
        const glm::dvec3 spread = glm::max(glm::dvec3(0.0), state.caustics[i].squares - n * mean * mean);
        const glm::dvec3 paths(view.standardError.pixels[i]), variance = spread / (n * (n - 1.0));
        view.standardError.pixels[i] = glm::vec3(glm::sqrt(paths * paths + variance));
    }
}

} // namespace lightloom
