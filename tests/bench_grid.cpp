// SPDX-License-Identifier: Apache-2.0
// How far irradiance grids are off the reference under four shifts of the lattice, and what they cost.
//   bench_grid [--probes N] [--paths N] [--shows] [--set NAME=VALUE ...] [SCENE[:TRIANGLES] ...]
// One row per shift; with --shows one per shift, filter and offset. Errors are of indirect luminance, noise is
// the reference's own. CPU-seconds: the whole bake; tracing; depositing; placing and classifying vertices.
#include "core/compare/field_noise.h"
#include "core/compare/field_probe.h"
#include "core/compare/image_error.h"
#include "core/ivg/ivg_solver.h"
#include "tests/bench_clock.h"
#include "tests/bench_judge.h"
#include "tests/bench_scene.h"

using namespace lightloom;

namespace {

double secondsOf(const std::vector<StageCost>& stages, std::string_view name)
{
    double sum = 0.0;
    for (const StageCost& s : stages) sum += s.stage == name ? s.cpuMs / 1000.0 : 0.0;
    return sum;
}

void row(const std::string& name, const BakeParams& params, const IrradianceGrid& grid, const SceneProducts& at,
         const Judge& judge, const WorkCounters& counters)
{
    const double began = cpuSeconds(CpuOf::process);
    int missing = 0;
    for (const ProbePoint& p : judge.points) {
        glm::vec3 lux;
        missing += grid.lookup(p.position, p.normal, lux) ? 0 : 1;
    }
    const double lookup = (cpuSeconds(CpuOf::process) - began) / static_cast<double>(judge.points.size());
    const FieldProbe probe(*at.rays, *at.lights, &grid, params); // gathers where the grid has no answer
    std::vector<double> values;
    for (const ProbePoint& p : judge.points) values.push_back(static_cast<double>(luminance(probe.indirect(p))));
    const Result<ErrorMetrics> e = measureError(values, judge.reference);
    if (!e) {
        fmt::print("{}: {}\n", name, e.error().message);
        return;
    }
    const auto& stages = counters.stages;
    const GridShow& show = grid.show();
    fmt::print(
        "| {} | {} | {} | {} | {} | {} | {} | {:.2f} | {:.4f} | {:+.4f} | {:.3f} | {:.4f} | {:.4f} | {:.2f} | {:.2f} "
        "| {:.2f} | {:.2f} | {:.2f} | {} |\n",
        name, params.gridSize, params.photonCount, params.gridShift,
        kGridEstimatorNames[static_cast<std::size_t>(grid.estimator())],
        kGridRemapNames[static_cast<std::size_t>(show.remap)], kGridFilterNames[static_cast<std::size_t>(show.filter)],
        show.offset, e->relRmse, e->bias, e->perPoint, relativeNoise(judge.noise, e->meanReference),
        statedNoise(grid, judge.surface).value_or(0.0), allCpuSeconds(stages), secondsOf(stages, "shoot"),
        secondsOf(stages, "deposit"), secondsOf(stages, "grid"), lookup * 1e6, missing);
    std::fflush(stdout);
}

std::vector<GridShow> showsOf(const BakeParams& params, bool all)
{
    if (!all) return {gridShow(params)};
    std::vector<GridShow> shows;
    for (const GridFilter filter : {GridFilter::trilinear, GridFilter::bspline}) {
        for (const float offset : {0.0f, 0.5f}) shows.push_back({GridRemap::joined, filter, offset});
    }
    return shows;
}

void measure(const std::string& name, const JudgeSettings& settings, bool allShows)
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
    BakeJob job{scene, settings.params, {}};
    const Result<SceneProducts> at = sceneProducts(job, products, quiet);
    if (!at) return;
    const Judge judge(*at, settings, workers);
    for (const float shift : {0.0f, 0.25f, 0.5f, 0.75f}) {
        job.params.gridShift = shift;
        std::shared_ptr<const IndirectField> field;
        BakeControl control(workers, {[&](const Snapshot& s) { field = s.field; }, {}});
        products.beginRound();
        if (const Result<Done> done = IvgSolver().bake(job, products, control); !done) {
            fmt::print("{}\n", done.error().message);
            return;
        }
        const auto& grid = dynamic_cast<const IrradianceGrid&>(*field);
        for (const GridShow& show : showsOf(settings.params, allShows))
            row(name, job.params, *grid.withShow(show), *at, judge, products.counters);
    }
}

} // namespace

int main(int argc, char** argv)
{
    std::optional<JudgeSettings> settings = JudgeSettings::read(argc, argv);
    if (!settings) return 2;
    const bool allShows = std::erase(settings->words, "--shows") > 0;
    std::vector<std::string> scenes = settings->words;
    if (scenes.empty()) scenes = {"cornell", "two_rooms", "figure", "atrium"};
    fmt::print(
        "| scene | N | photons | shift | estimator | remap | filter | offset | relRMSE | bias | per point | noise | "
        "stated | CPU s | shoot | deposit | grid | us | none |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& name : scenes) measure(name, *settings, allShows);
    return 0;
}
