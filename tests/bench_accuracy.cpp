// SPDX-License-Identifier: Apache-2.0
// How far the caches are off the reference, and what they cost: the accuracy tables of docs/measurements.md.
//   bench_accuracy [--probes N] [--paths N] [--set NAME=VALUE ...] [SCENE[:TRIANGLES] ...]
// Probes are area-uniform over reached surface, seed 1; errors are of indirect luminance; noise is the reference's own;
// stated noise is what the bake says of itself, rank how its map goes with the true errors (Spearman).
#include "core/base/statistics.h"
#include "core/compare/field_noise.h"
#include "core/compare/image_error.h"
#include "core/ivg/ivg_solver.h"
#include "core/octree/octree_solver.h"
#include "core/photonmap/photon_map_solver.h"
#include "tests/bench_clock.h"
#include "tests/bench_judge.h"
#include "tests/bench_scene.h"

using namespace lightloom;

namespace {

void row(std::string_view scene, const IndirectField& field, const Judge& judge, int level, double cpu)
{
    std::vector<double> values, stated, errors;
    for (const ProbePoint& p : judge.points) {
        values.push_back(static_cast<double>(luminance(field.irradiance(p.position, p.normal))));
        stated.push_back(static_cast<double>(field.noise(p.position, p.normal).value_or(0.0f)));
        errors.push_back(std::abs(values.back() - judge.reference[errors.size()]));
    }
    const Result<ErrorMetrics> e = measureError(values, judge.reference);
    if (!e) {
        fmt::print("{}: {}\n", scene, e.error().message);
        return;
    }
    fmt::print("| {} | {}{} | {:.2f} | {:.4f} | {:+.4f} | {:.3f} | {:.4f} | {:.4f} | {:.2f} |\n", scene, field.method(),
               level > 0 ? fmt::format(" d{}", level) : "", cpu, e->relRmse, e->bias, e->perPoint,
               relativeNoise(judge.noise, e->meanReference), statedNoise(field, judge.surface).value_or(0.0),
               rankCorrelation(stated, errors));
    std::fflush(stdout);
}

void measure(const std::string& name, const JudgeSettings& settings)
{
    const Result<Scene> made = benchScene(name);
    if (!made) {
        fmt::print("{}\n", made.error().message);
        return;
    }
    const auto scene = std::make_shared<const Scene>(*made);
    Workers workers;
    BakeProducts products;
    BakeControl quiet(workers, {});
    const BakeJob job{scene, settings.params, {}};
    const Result<SceneProducts> at = sceneProducts(job, products, quiet);
    if (!at) return;
    const Judge judge(*at, settings, workers);
    PhotonMapSolver photonMap;
    IvgSolver grid;
    OctreeSolver octree;
    for (Solver* solver :
         {static_cast<Solver*>(&octree), static_cast<Solver*>(&grid), static_cast<Solver*>(&photonMap)}) {
        double began = cpuSeconds(CpuOf::process);
        BakeControl control(workers, {[&](Snapshot s) {
                                          const double cpu = cpuSeconds(CpuOf::process) - began;
                                          row(name, *s.field, judge, s.level, cpu);
                                          began = cpuSeconds(CpuOf::process) - cpu; // judging is not baking
                                      },
                                      {}});
        BakeProducts fresh;
        if (const Result<Done> done = solver->bake(job, fresh, control); !done)
            fmt::print("{}\n", done.error().message);
        for (const StageCost& s : fresh.counters.stages)
            fmt::print(stderr, "{} {} {:.0f} ms\n", name, s.stage, s.wallMs);
    }
}

} // namespace

int main(int argc, char** argv)
{
    const std::optional<JudgeSettings> settings = JudgeSettings::read(argc, argv);
    if (!settings) return 2;
    std::vector<std::string> scenes = settings->words;
    if (scenes.empty()) scenes = {"cornell", "two_rooms", "figure", "atrium", "gallery"};
    fmt::print("| scene | method | CPU s | relRMSE | bias | per point | noise | stated noise | rank "
               "|\n|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& name : scenes) measure(name, *settings);
    return 0;
}
