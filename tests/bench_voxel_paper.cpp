// SPDX-License-Identifier: Apache-2.0
// Table 1 and figure 3 of the 2009 paper at equal error, CPU time of one thread after another:
//   bench_voxel_paper [--probes N] [--paths N] [SCENE[:TRIANGLES] ...]
// Indirect light at N places against the path-traced reference, whose noise is taken off: by a cut at 2 % through the
// lights that discrete lines made, through those that a photon map made (as many photons as make the error equal), and
// by path tracing (as many paths as make it equal). All times are of the same run. Voxels: 128 along the longest side,
// 1024 directions. Then the field of 64 voxels and 512 directions at 300,000 places, and what the reference would
// need there for its error.
#include "core/compare/image_error.h"
#include "core/trace/photon_tracer.h"
#include "core/voxel/voxel_solver.h"
#include "tests/bench_clock.h"
#include "tests/bench_judge.h"
#include "tests/bench_scene.h"
#include "tests/voxel_lights.h"

using namespace lightloom;

namespace {

constexpr int kCells = 128, kDirections = 1024, kManyPlaces = 300'000;

struct Case {
    std::string name;
    std::shared_ptr<const Scene> scene;
    SceneProducts at;
    JudgeSettings settings;
    double mean = 0.0, noise = 0.0, secondsPerPath = 0.0, noiseOfOnePath = 0.0;
    std::optional<Judge> judge;

    /// Root of the squared error that the reference's noise does not account for.
    [[nodiscard]] double errorOf(const std::vector<double>& values) const
    {
        const double all = measureError(values, judge->reference)->relRmse;
        return std::sqrt(std::max(0.0, all * all - noise * noise));
    }
    /// CPU seconds of path tracing until `places` places are off by `error`, in the mean of squares.
    [[nodiscard]] double secondsOfPaths(double error, double places) const
    {
        return places * secondsPerPath * std::pow(noiseOfOnePath / error, 2.0);
    }
};

std::optional<Case> caseOf(const std::string& name, const JudgeSettings& settings, Workers& workers)
{
    Result<Scene> scene = benchScene(name);
    if (!scene) return fmt::print("{}\n", scene.error().message), std::nullopt;
    Case c{name, std::make_shared<const Scene>(std::move(*scene)), {}, settings, 0.0, 0.0, 0.0, 0.0, {}};
    BakeProducts products;
    BakeControl quiet(workers, {});
    c.at = *sceneProducts({c.scene, settings.params, {}}, products, quiet);
    const double from = cpuSeconds(CpuOf::process);
    c.judge.emplace(c.at, settings, workers);
    const double paths = static_cast<double>(settings.paths), places = static_cast<double>(c.judge->points.size());
    c.secondsPerPath = (cpuSeconds(CpuOf::process) - from) / (paths * places);
    for (const double lux : c.judge->reference) c.mean += lux / places;
    c.noise = relativeNoise(c.judge->noise, c.mean);
    c.noiseOfOnePath = c.noise * std::sqrt(paths);
    return c;
}

struct Reconstruction {
    double error = 0.0, seconds = 0.0, nodes = 0.0; ///< per place
};

/// Cuts at 2 % at all places.
Reconstruction reconstruct(const Case& c, const VoxelLights& lights)
{
    const auto tree = lights.tree();
    const Lightcuts cuts(c.at.rays, tree, std::make_shared<EntryNearField>(c.at.rays, lights, c.at.lights.get()));
    std::vector<double> values;
    Reconstruction out;
    const FlushDenormals flush;
    const auto places = static_cast<double>(c.judge->surface.size());
    const double from = cpuSeconds(CpuOf::thread);
    for (const SurfacePoint& p : c.judge->surface) {
        const Lightcut cut = cuts.at(p.position, p.normal, values.size(), {});
        out.nodes += cut.nodes / places;
        values.push_back(static_cast<double>(luminance(cut.illuminance)));
    }
    out.seconds = (cpuSeconds(CpuOf::thread) - from) / places;
    out.error = c.errorOf(values);
    return out;
}

/// `lights` with the photons' light instead of the lines'. Photons between voxels, few, are left out.
VoxelLights byPhotons(const Case& c, VoxelLights lights, std::uint64_t count, Workers& workers, std::uint64_t& rays)
{
    const std::vector<glm::vec3> albedo = entryAlbedos(*c.at.rays, *c.at.reach, *lights.voxels);
    std::ranges::fill(lights.indirect, glm::vec3(0.0f));
    for (int group = 0; group < static_cast<int>(c.scene->groups.size()); ++group) {
        const auto paths = tracePhotons(*c.at.rays, *c.at.lights, {group, 1, count}, workers, {});
        rays += paths->rays;
        for (const Photon& photon : paths->photons) {
            const std::uint32_t e = lights.voxels->entryAt(photon.position, photon.normal);
            if (e != SurfaceVoxels::kNoEntry) lights.indirect[e] += photon.flux / lights.voxels->entries[e].area;
        }
    }
    for (std::size_t e = 0; e < albedo.size(); ++e)
        lights.exitance[e] = albedo[e] * (lights.direct[e] + lights.indirect[e]);
    return lights;
}

void tell(const std::string& what, double preparation, const Reconstruction& r)
{
    fmt::print("  {:34} {:8.2f} s + {:8.4f} ms a place, {:9.1f} s for {} places; error {:.4f}; {:.0f} clusters\n", what,
               preparation, 1e3 * r.seconds, preparation + r.seconds * kManyPlaces, kManyPlaces, r.error, r.nodes);
}

void compareCuts(const Case& c, Workers& workers)
{
    double from = cpuSeconds(CpuOf::process);
    const VoxelLights lines(*c.at.rays, *c.at.lights, *c.at.reach, kCells, kDirections, workers);
    const double byLines = cpuSeconds(CpuOf::process) - from;
    const Reconstruction ofLines = reconstruct(c, lines);
    tell(fmt::format("voxels and lightcuts ({} lights)", lines.discs.size()), byLines, ofLines);

    from = cpuSeconds(CpuOf::process); // what both need: voxels and what lamps give them
    const VoxelLights lamps(*c.at.rays, *c.at.lights, *c.at.reach, kCells, 1, workers);
    const double shared = cpuSeconds(CpuOf::process) - from;
    for (std::uint64_t count = 62'500; count <= 16'000'000; count *= 2) {
        std::uint64_t rays = 0;
        from = cpuSeconds(CpuOf::process);
        const VoxelLights photons = byPhotons(c, lamps, count, workers, rays);
        const double seconds = shared + cpuSeconds(CpuOf::process) - from;
        const Reconstruction of = reconstruct(c, photons);
        const bool isEqual = of.error <= 1.05 * ofLines.error;
        if (isEqual || count == 62'500 || count * 2 > 16'000'000)
            tell(fmt::format("{} photons and lightcuts ({} rays)", count, rays), seconds, of);
        if (isEqual) break;
    }
    const double paths = std::pow(c.noiseOfOnePath / ofLines.error, 2.0);
    tell(fmt::format("path tracing, {:.0f} paths a place", paths), 0.0, {ofLines.error, paths * c.secondsPerPath, 0.0});
}

void compareField(const Case& c, Workers& workers)
{
    BakeParams params = c.settings.params;
    params.voxelSize = 64;
    params.voxelDirections = 512;
    std::shared_ptr<const IndirectField> field;
    BakeProducts products;
    products.beginRound();
    BakeControl control(workers, {[&](const Snapshot& snapshot) { field = snapshot.field; }, {}});
    double from = cpuSeconds(CpuOf::process);
    if (!VoxelSolver().bake({c.scene, params, {}}, products, control)) return;
    const double bake = cpuSeconds(CpuOf::process) - from;
    const auto look = [&](const SurfacePoint& p) {
        glm::vec3 lux;
        field->lookup(p.position, p.normal, lux);
        return static_cast<double>(luminance(lux));
    };
    std::vector<double> values;
    for (const SurfacePoint& p : c.judge->surface) values.push_back(look(p));
    const double error = c.errorOf(values);
    const auto places = samplePoints(*c.at.rays, *c.at.lights, *c.at.reach, kManyPlaces, 2);
    double sum = 0.0;
    from = cpuSeconds(CpuOf::thread);
    for (const SurfacePoint& p : places) sum += look(p);
    const double lookups = cpuSeconds(CpuOf::thread) - from, paths = c.secondsOfPaths(error, kManyPlaces);
    fmt::print(
        "  field of 64 voxels, 512 directions: bake {:.2f} s, {} places {:.3f} s, error {:.4f}; the reference needs "
        "{:.0f} s for it: {:.0f} x (mean {:.1f} lx)\n",
        bake, kManyPlaces, lookups, error, paths, paths / (bake + lookups), sum / kManyPlaces);
}

} // namespace

int main(int argc, char** argv)
{
    auto settings = JudgeSettings::read(argc, argv);
    if (!settings) return 2;
    Workers workers;
    if (settings->words.empty()) settings->words = {"cornell"};
    for (const std::string& name : settings->words) {
        const std::optional<Case> c = caseOf(name, *settings, workers);
        if (!c) return 2;
        fmt::print("{}: reference of {} paths, noise {:.4f} (taken off below), {:.2f} us a path\n", name,
                   settings->paths, c->noise, 1e6 * c->secondsPerPath);
        compareCuts(*c, workers);
        compareField(*c, workers);
        std::fflush(stdout);
    }
}
