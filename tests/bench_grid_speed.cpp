// SPDX-License-Identifier: Apache-2.0
// What an irradiance grid costs beside what it replaces, in one run and on one thread:
//   bench_grid_speed [--probes N] [--paths N] [--set NAME=VALUE ...] [SCENE[:TRIANGLES] ...]
// Depositing and classifying beside tracing the same photons; a lookup beside density estimation of no less error; the
// indirect part of a picture by lookups, and by Christensen's cache with a final gather of 256 rays that took as much
// time to prepare.
#include "core/bake/view_eye.h"
#include "core/compare/image_error.h"
#include "core/ivg/ivg_solver.h"
#include "core/photonmap/photon_map_solver.h"
#include "tests/bench_clock.h"
#include "tests/bench_judge.h"
#include "tests/bench_scene.h"

using namespace lightloom;

namespace {

constexpr int kGatherRays = 256, kWide = 48, kHigh = 36; ///< pixels of the picture, one point each

double secondsOf(const WorkCounters& counters, std::string_view stage)
{
    double sum = 0.0;
    for (const StageCost& s : counters.stages) sum += s.stage == stage ? s.cpuMs / 1000.0 : 0.0;
    return sum;
}

struct Bake {
    std::shared_ptr<const IndirectField> field;
    WorkCounters counters;
    double cpuSeconds = 0.0; ///< of what follows from the photons, them included
};

Bake bakeWith(Solver& solver, const BakeJob& job, BakeProducts& products, Workers& workers)
{
    Bake bake;
    BakeControl control(workers, {[&](const Snapshot& s) { bake.field = s.field; }, {}});
    products.beginRound();
    if (!solver.bake(job, products, control)) std::exit(1);
    bake.counters = products.counters;
    for (const StageCost& s : bake.counters.stages) {
        const bool isScene = s.stage == "rays" || s.stage == "reach" || s.stage == "lamps"; // alike for all methods
        if (!isScene) bake.cpuSeconds += s.cpuMs / 1000.0;
    }
    return bake;
}

ErrorMetrics errorAt(const IndirectField& field, const std::vector<ProbePoint>& points,
                     const std::vector<double>& reference, double& secondsEach)
{
    std::vector<double> values;
    const double began = cpuSeconds(CpuOf::thread);
    for (const ProbePoint& p : points)
        values.push_back(static_cast<double>(luminance(field.irradiance(p.position, p.normal))));
    secondsEach = (cpuSeconds(CpuOf::thread) - began) / static_cast<double>(points.size());
    return *measureError(values, reference);
}

/// Where the middles of a picture's pixels meet matt surface.
std::vector<ProbePoint> seenPoints(const RayScene& rays, const Camera& camera)
{
    ViewJob job;
    job.camera = camera, job.width = kWide, job.height = kHigh;
    const Lens lens(job);
    std::vector<ProbePoint> points;
    for (int y = 0; y < kHigh; ++y) {
        for (int x = 0; x < kWide; ++x) {
            glm::vec3 origin, travel;
            lens.ray(x, y, glm::vec2(0.5f), origin, travel);
            Hit hit;
            if (!rays.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) continue;
            points.push_back({hit.position, hit.facing(), points.size()});
        }
    }
    return points;
}

std::vector<double> referenceAt(const SceneProducts& at, const std::vector<ProbePoint>& points, int paths,
                                Workers& workers)
{
    ReferenceJob job;
    job.paths = paths;
    std::vector<double> values;
    for (const ProbeLight& light : referenceIlluminance(*at.rays, *at.lights, {}, points, job, workers, {}).probes)
        values.push_back(static_cast<double>(luminance(light.indirect)));
    return values;
}

void deposits(const std::string& name, const Bake& grid)
{
    const double shoot = secondsOf(grid.counters, "shoot"), deposit = secondsOf(grid.counters, "deposit");
    const double place = secondsOf(grid.counters, "grid");
    fmt::print("{}: tracing {:.2f} CPU-s, depositing {:.2f} = {:.2f} x ({:.1f} ns each), classifying {:.3f} = {:.1f} % "
               "of the bake\n",
               name, shoot, deposit, deposit / shoot, 1e9 * deposit / static_cast<double>(grid.counters.deposits),
               place, 100.0 * place / grid.cpuSeconds);
}

/// Ever more photons until density estimation errs no more than the grid does; its lookups beside the grid's.
void lookups(const std::string& name, BakeJob job, const Bake& grid, const Judge& judge, Workers& workers)
{
    double each = 0.0;
    const ErrorMetrics own = errorAt(*grid.field, judge.points, judge.reference, each);
    for (int photons = 50'000; photons <= 3'200'000; photons *= 2) {
        job.params.photonCount = photons;
        BakeProducts products;
        PhotonMapSolver solver;
        const Bake map = bakeWith(solver, job, products, workers);
        double mapEach = 0.0;
        const ErrorMetrics error = errorAt(*map.field, judge.points, judge.reference, mapEach);
        if (error.relRmse > own.relRmse && photons < 3'200'000) continue;
        fmt::print("{}: lookup {:.2f} us at {:.4f}; photon map, {} photons, K {}: {:.2f} us at {:.4f}: {:.0f} x\n",
                   name, 1e6 * each, own.relRmse, photons, job.params.gatherCount, 1e6 * mapEach, error.relRmse,
                   mapEach / each);
        return;
    }
}

void pictures(const std::string& name, const SceneProducts& at, BakeJob job, const Bake& grid, int paths,
              Workers& workers)
{
    const Scene& scene = *job.scene;
    if (scene.cameras.empty()) return;
    const std::vector<ProbePoint> points = seenPoints(*at.rays, scene.cameras.front());
    const std::vector<double> reference = referenceAt(at, points, paths, workers);
    double each = 0.0;
    const ErrorMetrics own = errorAt(*grid.field, points, reference, each);

    job.params.photonLookup = PhotonLookup::christensen;
    job.params.photonCount = 50'000;
    PhotonMapSolver solver;
    Bake cache;
    for (int round = 0; round < 4; ++round) { // as many photons as take as long
        BakeProducts products;
        cache = bakeWith(solver, job, products, workers);
        const double more = grid.cpuSeconds / cache.cpuSeconds;
        if (more > 0.95 && more < 1.05) break;
        if (round < 3) job.params.photonCount = static_cast<int>(job.params.photonCount * more);
    }
    std::vector<double> gathered;
    const CachedIndirect cached = [&](glm::vec3 p, glm::vec3 n, glm::vec3& lux) {
        return cache.field->lookup(p, n, lux);
    };
    const double began = cpuSeconds(CpuOf::thread);
    for (const ProbePoint& p : points) {
        Rng rng(1, p.stream, 0);
        gathered.push_back(static_cast<double>(
            luminance(gatherIndirect(*at.rays, *at.lights, {}, cached, p.position, p.normal, kGatherRays, 1, rng))));
    }
    const double gatherEach = (cpuSeconds(CpuOf::thread) - began) / static_cast<double>(points.size());
    const ErrorMetrics theirs = *measureError(gathered, reference);
    fmt::print(
        "{}: picture of {} points, reference of {} paths; grid {:.2f} CPU-s before, {:.2f} us a point, error {:.4f}; "
        "Christensen {} photons, {:.2f} CPU-s before, {} rays {:.1f} us a point, error {:.4f}: {:.0f} x\n",
        name, points.size(), paths, grid.cpuSeconds, 1e6 * each, own.relRmse, job.params.photonCount, cache.cpuSeconds,
        kGatherRays, 1e6 * gatherEach, theirs.relRmse, gatherEach / each);

    gathered.clear(); // the same gather through the grid
    const CachedIndirect throughGrid = [&](glm::vec3 p, glm::vec3 n, glm::vec3& lux) {
        return grid.field->lookup(p, n, lux);
    };
    const double again = cpuSeconds(CpuOf::thread);
    for (const ProbePoint& p : points) {
        Rng rng(1, p.stream, 0);
        gathered.push_back(static_cast<double>(luminance(
            gatherIndirect(*at.rays, *at.lights, {}, throughGrid, p.position, p.normal, kGatherRays, 1, rng))));
    }
    fmt::print("{}: final gather of {} rays through the grid: {:.1f} us a point, error {:.4f}\n", name, kGatherRays,
               1e6 * (cpuSeconds(CpuOf::thread) - again) / static_cast<double>(points.size()),
               measureError(gathered, reference)->relRmse);
}

void measure(const std::string& name, const JudgeSettings& settings)
{
    const Result<Scene> made = benchScene(name);
    if (!made) {
        fmt::print("{}\n", made.error().message);
        return;
    }
    Workers one(1), all;
    BakeJob job{std::make_shared<const Scene>(*made), settings.params, {}};
    BakeProducts products;
    IvgSolver solver;
    const Bake grid = bakeWith(solver, job, products, one);
    deposits(name, grid);
    BakeControl control(all, {});
    const Result<SceneProducts> at = sceneProducts(job, products, control);
    if (!at) return;
    const Judge judge(*at, settings, all);
    lookups(name, job, grid, judge, one);
    pictures(name, *at, job, grid, settings.paths, one);
    std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv)
{
    std::optional<JudgeSettings> settings = JudgeSettings::read(argc, argv);
    if (!settings) return 2;
    std::vector<std::string> scenes = settings->words;
    if (scenes.empty()) scenes = {"cornell", "two_rooms", "figure:70000", "figure:1000"};
    for (const std::string& name : scenes) measure(name, *settings);
    return 0;
}
