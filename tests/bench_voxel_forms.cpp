// SPDX-License-Identifier: Apache-2.0
// What the rules of the walk are worth: the field's error with lines as shipped and as the papers have them
// (voxel.lines), against the reference, by shift of the lattice; CPU time of each bake.
//   bench_voxel_forms [--probes N] [--paths N] [--set NAME=VALUE ...] [SCENE[:TRIANGLES] ...]
#include "core/compare/image_error.h"
#include "core/voxel/voxel_solver.h"
#include "tests/bench_clock.h"
#include "tests/bench_judge.h"
#include "tests/bench_scene.h"

using namespace lightloom;

namespace {

void row(const std::string& name, const std::shared_ptr<const Scene>& scene, const BakeParams& params,
         const Judge& judge, Workers& workers)
{
    std::shared_ptr<const IndirectField> field;
    BakeProducts products;
    BakeControl control(workers, {[&](const Snapshot& s) { field = s.field; }, {}});
    const double began = cpuSeconds(CpuOf::process);
    const Result<Done> done = VoxelSolver().bake(BakeJob{scene, params, {}}, products, control);
    const double cpu = cpuSeconds(CpuOf::process) - began;
    if (!done) return fmt::print("{}: {}\n", name, done.error().message);
    std::vector<double> values;
    for (const ProbePoint& p : judge.points)
        values.push_back(static_cast<double>(luminance(field->irradiance(p.position, p.normal))));
    const Result<ErrorMetrics> e = measureError(values, judge.reference);
    if (!e) return fmt::print("{}: {}\n", name, e.error().message);
    fmt::print("| {} | {} | {} | {:.2f} | {:.4f} | {:+.4f} | {:.3f} | {:.2f} |\n", name, params.voxelSize,
               kVoxelLinesNames[static_cast<std::size_t>(params.voxelLines)], static_cast<double>(params.gridShift),
               e->relRmse, e->bias, e->perPoint, cpu);
    std::fflush(stdout);
}

void measure(const std::string& name, const JudgeSettings& settings)
{
    const Result<Scene> made = benchScene(name);
    if (!made) return fmt::print("{}\n", made.error().message);
    const auto scene = std::make_shared<const Scene>(*made);
    Workers workers;
    BakeProducts products;
    BakeControl quiet(workers, {});
    const Result<SceneProducts> at = sceneProducts(BakeJob{scene, settings.params, {}}, products, quiet);
    if (!at) return fmt::print("{}\n", at.error().message);
    const Judge judge(*at, settings, workers);
    for (const VoxelLines lines : {VoxelLines::covered, VoxelLines::paper}) {
        for (const float shift : {0.0f, 0.25f, 0.5f, 0.75f}) {
            BakeParams params = settings.params;
            params.voxelLines = lines, params.gridShift = shift, params.voxelRays = 0;
            row(name, scene, params, judge, workers);
        }
    }
}

} // namespace

int main(int argc, char** argv)
{
    const std::optional<JudgeSettings> settings = JudgeSettings::read(argc, argv);
    if (!settings) return 2;
    std::vector<std::string> scenes = settings->words;
    if (scenes.empty()) scenes = {"cornell", "two_rooms", "figure:70000", "atrium"};
    fmt::print(
        "| scene | cells | lines | shift | relRMSE | bias | per point | CPU s |\n|---|---|---|---|---|---|---|---|\n");
    for (const std::string& name : scenes) measure(name, *settings);
    return 0;
}
