// SPDX-License-Identifier: Apache-2.0
// How far the caches are off the reference, and what they cost: the accuracy tables of docs/measurements.md.
//   bench_accuracy [--probes N] [--paths N] [--set NAME=VALUE ...] [SCENE[:TRIANGLES] ...]
// Probes are area-uniform over reached surface, seed 1; errors are of indirect luminance; noise is the reference's own;
// stated noise is what the bake says of itself, rank how its map goes with the true errors (Spearman).
#include "core/base/statistics.h"
#include "core/base/units.h"
#include "core/compare/field_noise.h"
#include "core/compare/image_error.h"
#include "core/compare/probes.h"
#include "core/ivg/ivg_solver.h"
#include "core/octree/octree_solver.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/sample_scenes.h"
#include "tests/bench_clock.h"
#include <charconv>
#include <cstring>
#include <fmt/format.h>

using namespace lightloom;

namespace {

struct Settings {
    int probes = 1000, paths = 4096;
    BakeParams params;
    std::vector<std::string> scenes;
};

struct Judge {
    std::vector<ProbePoint> points;
    std::vector<double> reference;
    std::vector<glm::vec3> noise;

    void row(std::string_view scene, const IndirectField& field, int level, double cpu) const
    {
        std::vector<double> values;
        std::vector<double> stated, errors;
        std::vector<SurfacePoint> surface;
        for (const ProbePoint& p : points) {
            values.push_back(static_cast<double>(luminance(field.irradiance(p.position, p.normal))));
            stated.push_back(static_cast<double>(field.noise(p.position, p.normal).value_or(0.0f)));
            errors.push_back(std::abs(values.back() - reference[errors.size()]));
            surface.push_back({p.position, p.normal, 0});
        }
        const Result<ErrorMetrics> e = measureError(values, reference);
        if (!e) {
            fmt::print("{}: {}\n", scene, e.error().message);
            return;
        }
        fmt::print("| {} | {}{} | {:.2f} | {:.4f} | {:+.4f} | {:.3f} | {:.4f} | {:.4f} | {:.2f} |\n", scene,
                   field.method(), level > 0 ? fmt::format(" d{}", level) : "", cpu, e->relRmse, e->bias, e->perPoint,
                   relativeNoise(noise, e->meanReference), statedNoise(field, surface).value_or(0.0),
                   rankCorrelation(stated, errors));
        std::fflush(stdout);
    }
};

void measure(const std::string& name, const Settings& settings)
{
    const std::size_t colon = name.find(':');
    const Result<Scene> made = colon == std::string::npos
                                   ? sampleScene(name)
                                   : sampleScene(name.substr(0, colon), std::atoi(name.c_str() + colon + 1));
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
    Judge judge;
    std::uint64_t stream = 0;
    for (const SurfacePoint& p :
         samplePoints(*at->rays, *at->lights, *at->reach, static_cast<std::uint64_t>(settings.probes), 1)) {
        judge.points.push_back({p.position, p.normal, stream++});
    }
    ReferenceJob reference;
    reference.paths = settings.paths;
    for (const ProbeLight& light :
         referenceIlluminance(*at->rays, *at->lights, {}, judge.points, reference, workers, {}).probes) {
        judge.reference.push_back(static_cast<double>(luminance(light.indirect)));
        judge.noise.push_back(light.indirectError);
    }
    PhotonMapSolver photonMap;
    IvgSolver grid;
    OctreeSolver octree;
    for (Solver* solver :
         {static_cast<Solver*>(&octree), static_cast<Solver*>(&grid), static_cast<Solver*>(&photonMap)}) {
        double began = cpuSeconds(CpuOf::process);
        BakeControl control(workers, {[&](Snapshot s) {
                                          const double cpu = cpuSeconds(CpuOf::process) - began;
                                          judge.row(name, *s.field, s.level, cpu);
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
        } else {
            settings.scenes.push_back(word);
        }
    }
    if (settings.scenes.empty()) settings.scenes = {"cornell", "two_rooms", "figure", "atrium", "gallery"};
    fmt::print("| scene | method | CPU s | relRMSE | bias | per point | noise | stated noise | rank "
               "|\n|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& name : settings.scenes) measure(name, settings);
    return 0;
}
