// SPDX-License-Identifier: Apache-2.0
// How far irradiance grids are off the reference under four shifts of the lattice, and what they cost.
//   bench_grid [--probes N] [--paths N] [--shows] [--set NAME=VALUE ...] [SCENE[:TRIANGLES] ...]
// One row per shift; with --shows one per shift, remap, filter and offset. Errors are of indirect luminance, noise is
// the reference's own. CPU-seconds: the whole bake; tracing; depositing; placing and classifying vertices.
#include "core/base/units.h"
#include "core/compare/field_noise.h"
#include "core/compare/field_probe.h"
#include "core/compare/image_error.h"
#include "core/compare/probes.h"
#include "core/ivg/ivg_solver.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/sample_scenes.h"
#include "core/trace/reference.h"
#include "tests/bench_clock.h"
#include "tests/bench_scene.h"
#include <charconv>
#include <cstring>
#include <fmt/format.h>

using namespace lightloom;

namespace {

struct Settings {
    int probes = 1000, paths = 4096;
    bool allShows = false;
    BakeParams params;
    std::vector<std::string> scenes;
};

struct Judge {
    std::vector<ProbePoint> points;
    std::vector<double> reference;
    std::vector<glm::vec3> noise;
    std::vector<SurfacePoint> surface;
};

Judge judgeOf(const SceneProducts& at, const Settings& settings, Workers& workers)
{
    Judge judge;
    std::uint64_t stream = 0;
    judge.surface = samplePoints(*at.rays, *at.lights, *at.reach, static_cast<std::uint64_t>(settings.probes), 1);
    for (const SurfacePoint& p : judge.surface) judge.points.push_back({p.position, p.normal, stream++});
    ReferenceJob job;
    job.paths = settings.paths;
    for (const ProbeLight& light :
         referenceIlluminance(*at.rays, *at.lights, {}, judge.points, job, workers, {}).probes) {
        judge.reference.push_back(static_cast<double>(luminance(light.indirect)));
        judge.noise.push_back(light.indirectError);
    }
    return judge;
}

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

std::vector<GridShow> showsOf(const Settings& settings)
{
    if (!settings.allShows) return {gridShow(settings.params)};
    std::vector<GridShow> shows;
    for (const GridRemap remap : {GridRemap::joined}) {
        for (const GridFilter filter : {GridFilter::trilinear, GridFilter::bspline}) {
            for (const float offset : {0.0f, 0.5f}) shows.push_back({remap, filter, offset});
        }
    }
    return shows;
}

void measure(const std::string& name, const Settings& settings)
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
    const Judge judge = judgeOf(*at, settings, workers);
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
        for (const GridShow& show : showsOf(settings))
            row(name, job.params, *grid.withShow(show), *at, judge, products.counters);
    }
}

} // namespace

int main(int argc, char** argv)
{
    Settings settings;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const char* value = i + 1 < argc ? argv[i + 1] : "";
        if (word == "--probes" || word == "--paths") {
            std::from_chars(value, value + std::strlen(value), word == "--probes" ? settings.probes : settings.paths);
            ++i;
        } else if (word == "--set") {
            const Result<BakeParams> params = withAssignment(settings.params, value);
            if (!params) return fmt::print("{}\n", params.error().message), 2;
            settings.params = *params;
            ++i;
        } else if (word == "--shows") {
            settings.allShows = true;
        } else {
            settings.scenes.push_back(word);
        }
    }
    if (settings.scenes.empty()) settings.scenes = {"cornell", "two_rooms", "figure", "atrium"};
    fmt::print(
        "| scene | N | photons | shift | estimator | remap | filter | offset | relRMSE | bias | per point | noise | "
        "stated | CPU s | shoot | deposit | grid | us | none |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& name : settings.scenes) measure(name, settings);
    return 0;
}
