// SPDX-License-Identifier: Apache-2.0
// Discrete lines against bare rtcIntersect1 in one run, one thread, CPU time, variants in turn, medians of 5; a ray of
// the lines is an entry times a direction, both ways at once. Walking the lines with one entry per voxel and with
// those of every orientation, partners stored in rows, a bounce and all bounces summed over rows and walked, bounces in
// one order or another, voxels after an object was moved.
//   bench_voxels [SCENE ...] [--cells N] [--directions D] [--part walk|bounces|orders|edit|threads|scale ...]
#include "core/base/sampling.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/shapes.h"
#include "core/transport/chain_partners.h"
#include "core/transport/first_light.h"
#include "core/transport/partner_gather.h"
#include "core/transport/voxel_bounces.h"
#include "tests/bench_clock.h"
#include "tests/bench_embree.h"
#include "tests/bench_scene.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <string_view>

using namespace lightloom;

namespace {

struct Options {
    std::vector<std::string> scenes;
    std::vector<int> cells;
    int directions = 512;
};

/// Rays as a gather of light would send them: from each entry's surface in turn, spread by cosine.
std::vector<Ray> raysFrom(const RayScene& scene, const SurfaceVoxels& voxels, const LightReach& reach,
                          std::size_t wanted)
{
    std::vector<Ray> rays;
    const std::size_t entries = voxels.entries.size();
    const double step = static_cast<double>(entries) / static_cast<double>(wanted);
    for (std::size_t i = 0; i < wanted; ++i) {
        Rng rng(1, hashName("bench rays"), i);
        const auto e = std::min(entries - 1, static_cast<std::size_t>(static_cast<double>(i) * step));
        std::uint32_t facet = 0;
        const glm::vec3 p = voxels.pointOn(e, {rng.uniform(), rng.uniform(), rng.uniform()}, reach, facet),
                        n = reach.facets()[facet].normal;
        rays.push_back({scene.leave(p, n), Frame(n).toWorld(sampleCosineHemisphere(rng.uniform(), rng.uniform()))});
    }
    return rays;
}

/// CPU-seconds of the calling thread.
double timed(const std::function<void()>& body)
{
    const double began = cpuSeconds(CpuOf::thread);
    body();
    return cpuSeconds(CpuOf::thread) - began;
}

/// Variants in turn, medians of 5, seconds.
std::vector<double> medians(const std::vector<std::function<void()>>& variants)
{
    std::vector<std::vector<double>> times(variants.size());
    for (int round = 0; round < 5; ++round) {
        for (std::size_t v = 0; v < variants.size(); ++v) times[v].push_back(timed(variants[v]));
    }
    std::vector<double> middle;
    for (const std::vector<double>& t : times) middle.push_back(median(t));
    return middle;
}

void benchCells(const std::string& name, const SceneProducts& at, const Bounds& bounds, int cells,
                const Options& options, Workers& workers)
{
    const auto voxels = voxelise(bounds, *at.reach, cells, 0.0f, workers, {});
    const SurfaceVoxels means = withMeanNormals(*voxels);
    const VoxelOrders orders(*voxels), meanOrders(means), chainOrders(means, VoxelLines::paper);
    LinePartners lines(*voxels, orders), meanLines(means, meanOrders);
    ChainPartners chain(means, chainOrders);
    const std::vector<LineDirection> set = directionSet(options.directions);
    const int walked = std::min(options.directions, 48);
    constexpr std::size_t kRays = 200'000;
    const std::vector<Ray> rays = raysFrom(*at.rays, *voxels, *at.reach, kRays);
    const auto walk = [&](PartnerFinder& partners) {
        for (int d = 0; d < walked; ++d) partners.find(set[static_cast<std::size_t>(d)], static_cast<std::uint32_t>(d));
    };
    const std::vector<double> t = medians(
        {[&] { bareEmbree(*at.rays, rays); }, [&] { walk(chain); }, [&] { walk(meanLines); }, [&] { walk(lines); }});
    const double embree = static_cast<double>(kRays) / t[0] * 1e-6;
    fmt::print("{:<16} {:4} {:8} {:8} {:7.2f}", name, cells, means.entries.size(), voxels->entries.size(), embree);
    for (const std::size_t form : {1, 2, 3}) {
        const std::size_t entries = (form == 3 ? *voxels : means).entries.size();
        const double useful = static_cast<double>(entries * std::size_t(walked)) / t[form] * 1e-6;
        fmt::print(" |{:7.1f} {:6.1f} {:6.1f}", useful, useful / embree, 2.0 * useful / embree);
    }
    fmt::print("\n");
}

/// What no sum over stored partners can be faster than: their values read along all rows and added up, no cosines, four
/// sums a row that do not wait for each other. Entries are at most 65,535.
void bareSums(const PartnerTable& table, const ChannelLines& values, ChannelLines& sums)
{
    constexpr std::size_t kRow = PartnerBlock::kDirections;
    for (int d = 0; d < table.directions(); d += static_cast<int>(kRow)) {
        const std::uint16_t* row = table.block(static_cast<std::size_t>(d) / kRow).rows<std::uint16_t>();
        for (std::size_t r = 0; r < table.entries(); ++r, row += kRow) {
            __builtin_prefetch(row + 16 * kRow);
            Floats4 sum[4] = {};
            for (std::size_t i = 0; i < kRow; i += 4)
                for (std::size_t k = 0; k < 4; ++k) sum[k] += lanesOf<Floats4>(values.line(row[i + k]), 0);
            lanesOf<Floats4>(sums.line(r), 0) += (sum[0] + sum[1]) + (sum[2] + sum[3]);
        }
    }
}

void benchBounces(const std::string& name, const SceneProducts& at, const Bounds& bounds, int cells,
                  const Options& options, Workers& workers)
{
    const auto voxels = voxelise(bounds, *at.reach, cells, 0.0f, workers, {});
    const VoxelOrders orders(*voxels);
    const std::vector<glm::vec3> albedo = entryAlbedos(*at.rays, *at.reach, *voxels);
    const std::vector<int> groups{0};
    const EntryValues light = reflected(firstLight(*at.lights, *at.reach, *voxels, groups, 1, 1, workers, {}), albedo);
    BounceParams all, one;
    all.directions = one.directions = options.directions;
    one.mostBounces = 1;
    int bounces = 0;
    EntryValues lux;
    const auto bounce = [&](const BounceParams& params, const PartnerTable* stored) {
        return [&, stored] {
            lux = bounceLight(*at.rays, *voxels, orders, light, albedo, params, workers, {}, &bounces, stored);
        };
    };
    const auto stored = [&] {
        return PartnerTable::make(*at.rays, *voxels, orders, options.directions, std::size_t(8) << 30, workers, {});
    };
    const std::shared_ptr<const PartnerTable> table = stored();
    ChannelLines values(table->entries(), 3), sums = values;
    const RowOrder& order = *orders.rows();
    for (std::size_t i = 0; i < light.values.size(); ++i) values.line(order.rowOf[i / 3])[i % 3] = light.values[i];
    const auto bare = [&] {
        if (table->block(0).isNarrow()) bareSums(*table, values, sums);
    };
    const std::vector<double> t = medians({[&] { stored(); }, bounce(one, nullptr), bounce(one, table.get()),
                                           bounce(all, nullptr), bounce(all, table.get()), bare});
    const double elements = static_cast<double>(voxels->entries.size() * std::size_t(options.directions));
    const double perElement = 1e9 * t[2] / elements, atLeast = 1e9 * t[5] / elements;
    fmt::print(
        "{:<16} {:4} {:8} {:6.0f} {:7.1f} {:8.1f} {:8.2f} {:6.1f} {:6.2f} {:6.2f} {:3} {:8.1f} {:8.2f} {:6.1f}\n", name,
        cells, voxels->entries.size(), static_cast<double>(table->memoryBytes()) * 1e-6, 1e3 * t[0], 1e3 * t[1],
        1e3 * t[2], t[1] / t[2], perElement, atLeast, bounces, 1e3 * t[3], 1e3 * t[4], t[3] / t[4]);
}

/// Root mean square by area of what two results differ by, over the first one's mean.
double difference(const SurfaceVoxels& voxels, const EntryValues& of, const EntryValues& from)
{
    double squares = 0.0, mean = 0.0, area = 0.0;
    for (std::size_t i = 0; i < of.values.size(); ++i) {
        const auto a = static_cast<double>(voxels.entries[i / 3].area), v = static_cast<double>(of.values[i]);
        const double d = static_cast<double>(from.values[i]) - v;
        squares += a * d * d, mean += a * v, area += a;
    }
    return std::sqrt(squares / area) / (mean / area);
}

/// Bounces that follow each other in different ways, to the same gain: how many, along how many directions together,
/// how long; what one more bounce along all directions would change, and how far all are from the end of it.
void benchOrders(const std::string& name, const SceneProducts& at, const Bounds& bounds, int cells,
                 const Options& options, Workers& workers)
{
    const auto voxels = voxelise(bounds, *at.reach, cells, 0.0f, workers, {});
    const VoxelOrders orders(*voxels);
    const std::vector<glm::vec3> albedo = entryAlbedos(*at.rays, *at.reach, *voxels);
    const std::vector<int> groups{0};
    const EntryValues light = reflected(firstLight(*at.lights, *at.reach, *voxels, groups, 4, 1, workers, {}), albedo);
    const auto table =
        PartnerTable::make(*at.rays, *voxels, orders, options.directions, std::size_t(8) << 30, workers, {});
    int bounces = 0;
    const auto solved = [&](const EntryValues& leaving, const BounceParams& params) {
        return bounceLight(*at.rays, *voxels, orders, leaving, albedo, params, workers, {}, &bounces, table.get());
    };
    BounceParams end;
    end.directions = end.leastDirections = options.directions;
    end.leastGain = 1e-6f;
    const EntryValues exact = solved(light, end);
    for (const VoxelBounces order : {VoxelBounces::halving, VoxelBounces::gaussSeidel}) {
        for (const int least : {options.directions, 64}) {
            for (const float gain : {0.005f, 0.0005f}) {
                BounceParams params = end;
                params.leastDirections = least, params.leastGain = gain, params.order = order;
                EntryValues lux;
                const double seconds = medians({[&] { lux = solved(light, params); }})[0];
                const int taken = bounces;
                std::size_t along = 0;
                for (int b = 0, d = options.directions; b < taken; ++b, d = std::max(least, d / 2))
                    along += std::size_t(d);
                BounceParams once = end;
                once.mostBounces = 1;
                EntryValues leaving = light;
                for (std::size_t i = 0; i < lux.values.size(); ++i)
                    leaving.values[i] += lux.values[i] * albedo[i / 3][static_cast<int>(i % 3)];
                const EntryValues next = solved(leaving, once);
                fmt::print(
                    "{:<12} {:4} {:<12} {:4} gain {:.4f}: {:3} bounces {:6} directions {:7.1f} ms, residual {:.5f}, "
                    "off {:.5f}\n",
                    name, cells, kVoxelBouncesNames[static_cast<std::size_t>(order)], least == 64 ? "half" : "all",
                    gain, taken, along, 1e3 * seconds, difference(*voxels, lux, next), difference(*voxels, exact, lux));
            }
        }
    }
}

/// What the same work takes on one thread and on two: CPU time of the process, and how busy it kept the machine.
void benchThreads(const std::string& name, const SceneProducts& at, const Bounds& bounds, int cells,
                  const Options& options)
{
    Workers two(2);
    const auto voxels = voxelise(bounds, *at.reach, cells, 0.0f, two, {});
    const VoxelOrders orders(*voxels);
    const std::vector<glm::vec3> albedo(voxels->entries.size(), glm::vec3(0.6f));
    const EntryValues light{3, std::vector<float>(3 * voxels->entries.size(), 1.0f)};
    BounceParams params;
    params.directions = options.directions;
    EntryValues lux;
    std::vector<double> cpu[2][2];
    for (int round = 0; round < 5; ++round) {
        for (const int threads : {1, 2}) {
            Workers workers(threads);
            double began = cpuSeconds(CpuOf::process);
            const auto table =
                PartnerTable::make(*at.rays, *voxels, orders, options.directions, std::size_t(8) << 30, workers, {});
            double now = cpuSeconds(CpuOf::process);
            cpu[0][threads - 1].push_back(now - began);
            began = now;
            lux = bounceLight(*at.rays, *voxels, orders, light, albedo, params, workers, {}, nullptr, table.get());
            now = cpuSeconds(CpuOf::process);
            cpu[1][threads - 1].push_back(now - began);
        }
    }
    fmt::print(
        "{:<16} {:4}  CPU ms, one and two threads: table {:.0f} {:.0f} ({:.2f} x one), all bounces {:.1f} {:.1f} "
        "({:.2f} x one)\n",
        name, cells, 1e3 * median(cpu[0][0]), 1e3 * median(cpu[0][1]), 2.0 * median(cpu[0][0]) / median(cpu[0][1]),
        1e3 * median(cpu[1][0]), 1e3 * median(cpu[1][1]), 2.0 * median(cpu[1][0]) / median(cpu[1][1]));
}

/// Cost of a direction against the number of voxels.
void benchScale(const std::string& name, const SceneProducts& at, const Bounds& bounds, const Options& options,
                Workers& workers)
{
    double firstTime = 0.0, firstCount = 0.0;
    for (const int cells : {64, 128, 256, 512}) {
        const auto voxels = voxelise(bounds, *at.reach, cells, 0.0f, workers, {});
        const VoxelOrders orders(*voxels);
        LinePartners lines(*voxels, orders);
        const std::vector<LineDirection> set = directionSet(options.directions);
        const std::size_t walked = 12;
        const double seconds = medians({[&] {
                                   for (std::size_t d = 0; d < walked; ++d)
                                       lines.find(set[d], static_cast<std::uint32_t>(d));
                               }})[0] /
                               static_cast<double>(walked);
        const auto count = static_cast<double>(voxels->entries.size());
        if (cells == 64) firstTime = seconds, firstCount = count;
        fmt::print("{:<16} {:4} {:9} entries {:8.3f} ms a direction {:6.2f} ns an entry, exponent from 64 {:.2f}\n",
                   name, cells, voxels->entries.size(), 1e3 * seconds, 1e9 * seconds / count,
                   cells == 64 ? 1.0 : std::log(seconds / firstTime) / std::log(count / firstCount));
    }
}

/// A cube of a tenth of the scene's side, moved by as much as itself: voxels made anew, and from those before.
void benchEdit(const std::string& name, const Scene& scene, int cells, Workers& workers)
{
    const float side = 0.1f * scene.bounds.longestSide();
    struct Made {
        std::shared_ptr<const RayScene> rays;
        std::shared_ptr<const LightReach> reach;
    };
    const auto with = [&](float moved) {
        Scene edited = scene;
        edited.meshes.push_back(boxMesh(glm::vec3(-0.5f * side), glm::vec3(0.5f * side), Facing::out));
        Instance cube;
        cube.mesh = static_cast<int>(edited.meshes.size()) - 1;
        cube.toWorld[3] = glm::vec4(scene.bounds.centre() + glm::vec3(moved, 0.0f, 0.0f), 1.0f);
        edited.instances.push_back(cube);
        Made made;
        made.rays = *RayScene::build(std::make_shared<const Scene>(std::move(edited)));
        made.reach = LightReach::find(*made.rays, LightSampler(made.rays), workers, {});
        return made;
    };
    const Made before = with(0.0f), after = with(side);
    const auto voxels = voxelise(scene.bounds, *before.reach, cells, 0.0f, workers, {});
    std::size_t clipped = 0;
    const std::vector<double> t = medians(
        {[&] { (void)voxelise(scene.bounds, *after.reach, cells, 0.0f, workers, {}); },
         [&] {
             (void)revoxelise(*voxels, *before.reach, scene.bounds, *after.reach, cells, 0.0f, workers, {}, &clipped);
         },
         [&] { const VoxelOrders orders(*voxels); }});
    fmt::print(
        "{:<16} {:4} {:8} entries: anew {:6.1f} ms, from those before {:6.1f} ms ({:.1f} x), {} of {} facets cut up; "
        "orders of lines {:.1f} ms\n",
        name, cells, voxels->entries.size(), 1e3 * t[0], 1e3 * t[1], t[0] / t[1], clipped, after.reach->facets().size(),
        1e3 * t[2]);
}

} // namespace

int main(int argc, char** argv)
{
    Options options;
    std::vector<std::string> parts;
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word == "--cells" && i + 1 < argc)
            options.cells.push_back(std::stoi(argv[++i]));
        else if (word == "--directions" && i + 1 < argc)
            options.directions = std::stoi(argv[++i]);
        else if (word == "--part" && i + 1 < argc)
            parts.emplace_back(argv[++i]);
        else
            options.scenes.emplace_back(word);
    }
    if (options.scenes.empty()) options.scenes = {"cornell", "figure:200000"};
    const auto wants = [&](const char* part) { return parts.empty() || std::ranges::find(parts, part) != parts.end(); };
    const FlushDenormals flush;
    Workers workers(1);
    for (const std::string& name : options.scenes) {
        auto built = benchScene(name);
        if (!built) return fmt::print(stderr, "{}\n", built.error().message), 1;
        const auto scene = std::make_shared<const Scene>(std::move(*built));
        BakeProducts kept;
        BakeControl quiet(workers, {});
        const auto at = sceneProducts(BakeJob{scene, {}, {}}, kept, quiet);
        if (!at) return fmt::print(stderr, "{}\n", at.error().message), 1;
        const auto cellsOr = [&](std::vector<int> usual) { return options.cells.empty() ? usual : options.cells; };
        if (wants("walk")) {
            fmt::print("\nM useful rays/s     cells   voxels  entries rtcInt1 |  paper useful  both |    one useful  "
                       "both |entries useful  both\n");
            for (const int cells : cellsOr({64, 128, 256}))
                benchCells(name, *at, scene->bounds, cells, options, workers);
        }
        if (wants("bounces")) {
            fmt::print("\nms                  cells  entries     MB    made  one walk   stored  ratio ns/elt   bare  "
                       "all walk   "
                       "stored  ratio\n");
            for (const int cells : cellsOr({64, 128})) benchBounces(name, *at, scene->bounds, cells, options, workers);
        }
        if (wants("orders")) {
            fmt::print("\n");
            for (const int cells : cellsOr({64, 128})) benchOrders(name, *at, scene->bounds, cells, options, workers);
        }
        if (wants("edit")) {
            fmt::print("\n");
            for (const int cells : cellsOr({64, 128, 256})) benchEdit(name, *scene, cells, workers);
        }
        if (wants("threads")) {
            for (const int cells : cellsOr({64, 128})) benchThreads(name, *at, scene->bounds, cells, options);
        }
        if (wants("scale")) benchScale(name, *at, scene->bounds, options, workers);
    }
    return 0;
}
