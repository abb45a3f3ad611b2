// SPDX-License-Identifier: Apache-2.0
// What the light octree's fits cost, CPU time, variants in turn, medians of 5:
//   gather and clustering of depth 5 at K = 100, k = 4 against tracing the photons, one thread;
//   cost over leaves, depths 4 to 7;  cost and spread of directions over k at depth 6, K = 300;  one thread's time
//   against the longest of two, tracing and fits. bench_octree [SCENE[:TRIANGLES] ...]
#include "core/base/units.h"
#include "core/octree/entry_screens.h"
#include "core/octree/layer_fit.h"
#include "core/octree/octree_build.h"
#include "tests/bench_clock.h"
#include "tests/bench_scene.h"
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>
#include <mutex>
#include <thread>

using namespace lightloom;

namespace {

constexpr std::uint64_t kShot = 400'000;

struct Bench {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RayScene> rays;
    std::shared_ptr<const LightReach> reach;
    std::shared_ptr<const SurfaceArea> area;
    std::shared_ptr<const PhotonMap> map;
};

/// Sums what each thread of a pool computes.
class ThreadTimes {
public:
    /// Call at the end of each piece of work, on its thread; `begin` at its start.
    void begin() { began() = cpuSeconds(CpuOf::thread); }
    void end()
    {
        const double now = cpuSeconds(CpuOf::thread);
        const std::lock_guard lock(mutex_);
        seconds_[std::this_thread::get_id()] += now - began();
        began() = now;
    }
    [[nodiscard]] double longest() const
    {
        double most = 0.0;
        for (const auto& [thread, seconds] : seconds_) most = std::max(most, seconds);
        return most;
    }

private:
    static double& began()
    {
        thread_local double at = cpuSeconds(CpuOf::thread);
        return at;
    }
    std::mutex mutex_;
    std::map<std::thread::id, double> seconds_;
};

BakeParams paramsOf(int count, bool asPrinted)
{
    BakeParams params;
    params.gatherCount = count;
    params.vdlCount = 4;
    if (asPrinted) {
        params.gatherAdapt = Switch::off;
        params.gatherFit = GatherFit::mean;
    }
    return params;
}

double traceTime(const Bench& b, const LightSampler& lights, int threads)
{
    Workers workers(threads);
    ThreadTimes times;
    PhotonJob job;
    job.count = kShot;
    times.begin();
    // pool threads sleep until there is work: their clock stands still between blocks
    static_cast<void>(
        tracePhotons(*b.rays, lights, job, workers, {}, [&](std::uint64_t, std::uint64_t) { times.end(); }));
    times.end(); // joining the blocks
    return times.longest();
}

double fitTime(const Bench& b, const OctreeGeometry& geometry, const BakeParams& params, int threads)
{
    constexpr std::size_t kBlock = 64;
    Workers workers(threads);
    ThreadTimes times;
    BakeParams atDepth = params; // leaves below octree.depth gather otherwise
    atDepth.octreeDepth = atDepth.octreeFirstDepth = geometry.depth;
    const auto layer = emptyLayer(geometry, 0, atDepth);
    const LayerFit fit(geometry, *b.map, *b.area, atDepth, *layer);
    const std::size_t count = geometry.entries.size();
    workers.run((count + kBlock - 1) / kBlock, {}, [&](std::size_t block) {
        thread_local FitScratch scratch;
        times.begin();
        for (std::size_t e = block * kBlock; e < std::min(count, (block + 1) * kBlock); ++e)
            static_cast<void>(fit.fit(static_cast<std::uint32_t>(e), scratch));
        times.end();
    });
    return times.longest();
}

template<class Body>
double medianOf5(Body body)
{
    std::vector<double> seconds;
    for (int i = 0; i < 5; ++i) seconds.push_back(body());
    return median(seconds);
}

std::shared_ptr<const OctreeGeometry> octree(const Bench& b, int depth, bool isScreened)
{
    Workers workers;
    auto geometry = buildOctree(b.scene->bounds, *b.reach, depth, 0, workers, {});
    if (isScreened) static_cast<void>(findScreens(*geometry, ScreenFinder(*b.rays, *b.reach, *b.area), workers, {}));
    return geometry;
}

void againstTracing(const std::string& name, const Bench& b, const LightSampler& lights)
{
    const auto geometry = octree(b, 5, true), plain = octree(b, 5, false);
    std::vector<double> printed, shipped;
    double traced = 0.0, fitted = 0.0;
    for (int round = 0; round < 5; ++round) {
        traced = traceTime(b, lights, 1);
        fitted = fitTime(b, *geometry, paramsOf(100, false), 1);
        shipped.push_back(fitted / traced);
        printed.push_back(fitTime(b, *plain, paramsOf(100, true), 1) / traced);
    }
    fmt::print("| {} | {} | {:.1f} | {:.1f} | {:.2f} | {:.2f} |\n", name, geometry->entries.size(), 1e3 * traced,
               1e3 * fitted, median(shipped), median(printed));
}

void overDepths(const std::string& name, const Bench& b)
{
    std::vector<double> x, y;
    std::string row;
    for (int depth = 4; depth <= 7; ++depth) {
        const auto geometry = octree(b, depth, true);
        const double seconds = medianOf5([&] { return fitTime(b, *geometry, paramsOf(300, false), 1); });
        row += fmt::format(" {} in {:.0f} ms |", geometry->entries.size(), 1e3 * seconds);
        x.push_back(std::log(static_cast<double>(geometry->entries.size())));
        y.push_back(std::log(seconds));
    }
    double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) mx += x[i] / 4.0, my += y[i] / 4.0;
    for (std::size_t i = 0; i < x.size(); ++i) xx += (x[i] - mx) * (x[i] - mx), xy += (x[i] - mx) * (y[i] - my);
    fmt::print("| {} |{} {:.2f} |\n", name, row, xy / xx);
}

/// Root mean square angle (as a chord) between the photons that entries gather and the mean direction of their cluster,
/// weighted by flux, degrees.
double spread(const Bench& b, const OctreeGeometry& geometry, std::uint32_t count, int k)
{
    ClusterScratch scratch;
    Gathered gathered;
    std::vector<LightVector> lights;
    double cost = 0.0, weight = 0.0;
    for (const OctreeEntry& e : geometry.entries) {
        b.map->gather({e.centroid, e.normal, std::numeric_limits<float>::max() / 4, 1.0f, -2.0f, count}, gathered);
        lights.clear();
        for (const std::uint32_t i : gathered.photons) {
            const Photon& photon = b.map->paths().photons[i];
            lights.push_back({photon.toLight, photon.flux, luminance(photon.flux)});
            weight += static_cast<double>(lights.back().weight);
        }
        cost += clusterCost(lights, scratch, clusterDirections(lights, k, scratch));
    }
    return glm::degrees(2.0 * std::asin(0.5 * std::sqrt(cost / weight)));
}

void overClusters(const std::string& name, const Bench& b)
{
    const auto geometry = octree(b, 6, true);
    for (const int k : {1, 2, 3, 4, 6, 8}) {
        BakeParams params = paramsOf(300, false);
        params.vdlCount = k;
        const double seconds = medianOf5([&] { return fitTime(b, *geometry, params, 1); });
        fmt::print("| {} | {} | {:.0f} | {:.1f} |\n", name, k, 1e3 * seconds, spread(b, *geometry, 300, k));
    }
}

void onTwoThreads(const std::string& name, const Bench& b, const LightSampler& lights)
{
    const auto geometry = octree(b, 6, true);
    const BakeParams params = paramsOf(300, false);
    std::vector<double> tracing, fits;
    for (int round = 0; round < 5; ++round) {
        tracing.push_back(traceTime(b, lights, 1) / traceTime(b, lights, 2));
        fits.push_back(fitTime(b, *geometry, params, 1) / fitTime(b, *geometry, params, 2));
    }
    fmt::print("| {} | {:.2f} | {:.2f} |\n", name, median(tracing), median(fits));
}

} // namespace

int main(int argc, char** argv)
{
    std::vector<std::string> names(argv + 1, argv + argc);
    if (names.empty()) names = {"cornell", "figure:70000"};
    std::vector<Bench> benches;
    for (const std::string& name : names) {
        const Result<Scene> made = benchScene(name);
        if (!made) return fmt::print("{}\n", made.error().message), 2;
        Bench b;
        b.scene = std::make_shared<const Scene>(*made);
        const auto rays = RayScene::build(b.scene);
        if (!rays) return fmt::print("{}\n", rays.error().message), 1;
        b.rays = *rays;
        const LightSampler lights(b.rays);
        Workers workers;
        b.reach = LightReach::find(*b.rays, lights, workers, {});
        b.area = SurfaceArea::build(*b.reach);
        PhotonJob job;
        job.count = kShot;
        b.map = PhotonMap::build(tracePhotons(*b.rays, lights, job, workers, {}));
        benches.push_back(b);
    }
    const auto each = [&](const char* head, auto body) {
        fmt::print("{}", head);
        for (std::size_t i = 0; i < names.size(); ++i) body(names[i], benches[i], LightSampler(benches[i].rays));
    };
    each("| scene | entries at depth 5 | tracing, ms | gather and clustering, ms | share | as printed (mean, fixed K) "
         "|\n"
         "|---|---|---|---|---|---|\n",
         againstTracing);
    each("\n| scene | depth 4 | 5 | 6 | 7 | slope |\n|---|---|---|---|---|---|\n",
         [](const std::string& name, const Bench& b, const LightSampler&) { overDepths(name, b); });
    each("\n| scene | k | gather and clustering, ms | spread, degrees |\n|---|---|---|---|\n",
         [](const std::string& name, const Bench& b, const LightSampler&) { overClusters(name, b); });
    each("\n| scene | tracing, one thread / longest of two | gather and clustering |\n|---|---|---|\n", onTwoThreads);
    return 0;
}
