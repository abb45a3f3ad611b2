// SPDX-License-Identifier: Apache-2.0
// Voxels with many lamps: a hall of 12 x 8 m lit by glowing panels, each a light group of its own.
//   bench_lamps [--lamps N] [--cells N] [--directions D]
// What a bake takes (CPU-seconds by stage, memory kept, the process's most), and light at places of it by shadow rays
// to each lamp beside a cut, and by lamps joined into the cut, against many rays and a fine cut.
#include "core/base/units.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/trace/direct_light.h"
#include "core/voxel/voxel_cuts.h"
#include "core/voxel/voxel_solver.h"
#include "tests/bench_clock.h"
#include <cmath>
#include <fmt/format.h>
#include <string_view>
#include <sys/resource.h>

using namespace lightloom;

namespace {

Scene hall(int lamps)
{
    SceneBuilder builder("hall");
    builder.add("Room", boxMesh({0, 0, 0}, {12, 3, 8}, Facing::in), builder.addMaterial("grey", glm::vec3(0.6f)));
    const int wood = builder.addMaterial("wood", {0.5f, 0.35f, 0.2f});
    for (int i = 0; i < 12; ++i) {
        const auto x = static_cast<float>(i % 4), z = static_cast<float>(i / 4);
        const glm::vec3 foot(1.5f + 2.6f * x, 0.0f, 1.2f + 2.4f * z);
        builder.add("Table " + std::to_string(i), boxMesh(foot, foot + glm::vec3(1.2f, 0.75f, 0.8f), Facing::out),
                    wood);
    }
    const int glow = builder.addEmitter("panel", glm::vec3(3000.0f));
    const int rows = std::max(1, static_cast<int>(std::lround(std::sqrt(lamps * 8.0 / 12.0))));
    const int columns = (lamps + rows - 1) / rows;
    for (int i = 0; i < lamps; ++i) {
        const float x = 12.0f * (static_cast<float>(i % columns) + 0.5f) / static_cast<float>(columns),
                    z = 8.0f * (static_cast<float>(i / columns) + 0.5f) / static_cast<float>(rows);
        builder.add("Lamp " + std::to_string(i), quadMesh({x - 0.1f, 2.95f, z - 0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}),
                    glow);
    }
    return builder.finish();
}

double mostMiB()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// Luminance (lux) at each place, and the milliseconds of one.
template<class Light>
std::vector<double> lit(const char* name, const std::vector<SurfacePoint>& places, const std::vector<double>& exact,
                        Light light)
{
    std::vector<double> values;
    const double began = cpuSeconds(CpuOf::thread);
    for (const SurfacePoint& place : places) values.push_back(static_cast<double>(luminance(light(place))));
    const double ms = 1e3 * (cpuSeconds(CpuOf::thread) - began) / static_cast<double>(places.size());
    double squares = 0.0, difference = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        squares += std::pow(values[i] - exact[i], 2.0), difference += values[i] - exact[i], sum += exact[i];
    }
    const auto count = static_cast<double>(places.size());
    fmt::print("  {:<44} {:8.3f} ms a place", name, ms);
    if (!exact.empty())
        fmt::print(", off by {:.4f} {:+.4f}", std::sqrt(squares / count) / (sum / count), difference / sum);
    fmt::print("\n");
    return values;
}

} // namespace

int main(int argc, char** argv)
{
    int lamps = 300;
    BakeParams params;
    for (int i = 1; i + 1 < argc; i += 2) {
        const std::string_view word = argv[i];
        if (word == "--lamps") lamps = std::stoi(argv[i + 1]);
        if (word == "--cells") params.voxelSize = std::stoi(argv[i + 1]);
        if (word == "--directions") params.voxelDirections = std::stoi(argv[i + 1]);
    }
    const FlushDenormals flush;
    Workers workers(1);
    const auto scene = std::make_shared<const Scene>(hall(lamps));
    BakeProducts products;
    const BakeJob job{scene, params, {}};
    std::shared_ptr<const VoxelField> field;
    BakeControl control(workers,
                        {[&](Snapshot shown) { field = std::static_pointer_cast<const VoxelField>(shown.field); }, {}});
    const double began = cpuSeconds(CpuOf::process), before = mostMiB();
    if (const Result<Done> done = VoxelSolver().bake(job, products, control); !done)
        return fmt::print(stderr, "{}\n", done.error().message), 1;
    fmt::print(
        "{} lamps, {} voxels, {} entries: {:.2f} CPU-s, field {:.0f} MiB, process {:.0f} MiB at most (before {:.0f})\n",
        lamps, products.counters.voxels, products.counters.entries, cpuSeconds(CpuOf::process) - began,
        static_cast<double>(field->memoryBytes()) / (1 << 20), mostMiB(), before);
    for (const StageCost& stage : products.counters.stages)
        fmt::print("  {:<20} {:.3f} CPU-s\n", stage.stage, 1e-3 * stage.cpuMs);

    const SceneProducts at = *sceneProducts(job, products, control);
    const std::vector<SurfacePoint> places = samplePoints(*at.rays, *at.lights, *at.reach, 100, 1);
    const auto cutsFor = [&](float threshold, int discs) {
        BakeParams shown = params;
        shown.voxelThreshold = threshold, shown.voxelLamps = discs, shown.voxelCut = 0;
        return VoxelCuts(field, at.lights, voxelShow(shown));
    };
    const auto apart = [&](const VoxelCuts& cuts, int samples) {
        return [&cuts, &at, samples](const SurfacePoint& place) {
            Rng rng(1, 2, static_cast<std::uint64_t>(place.position.x * 1e6f));
            return directIlluminance(*at.rays, *at.lights, {}, place.position, place.normal, samples, rng) +
                   cuts.irradiance(place.position, place.normal);
        };
    };
    const VoxelCuts fine = cutsFor(0.001f, 0), usual = cutsFor(0.02f, 0);
    const std::vector<double> exact = lit("256 rays to each lamp, cut of .1 %", places, {}, apart(fine, 256));
    for (const int samples : {64, 16, 4, 1})
        static_cast<void>(lit(fmt::format("{} to each lamp beside a cut of 2 %", samples).c_str(), places, exact,
                              apart(usual, samples)));
    for (const int discs : {1, 16, 64, 256}) {
        for (const float threshold : {0.02f, 0.01f, 0.005f}) {
            const double start = cpuSeconds(CpuOf::thread);
            const VoxelCuts joined = cutsFor(threshold, discs);
            const double made = cpuSeconds(CpuOf::thread) - start;
            static_cast<void>(lit(
                fmt::format("joined, {} discs each, {} % ({:.0f} ms to make)", discs, 100.0f * threshold, 1e3 * made)
                    .c_str(),
                places, exact,
                [&](const SurfacePoint& place) { return joined.joinedAt(place.position, place.normal).illuminance; }));
        }
    }
    return 0;
}
