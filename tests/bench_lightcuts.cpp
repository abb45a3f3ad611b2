// SPDX-License-Identifier: Apache-2.0
// The last lookup of voxel-lightcuts, one thread, CPU time:
//   bench_lightcuts [SCENE[:TRIANGLES] ...]             a cut at 2 % against all lights one by one and by packets of
//                                                       rays, medians of 5 rounds of 60 places; random voxels in the
//                                                       time of a cut; tree built and lit anew
//   bench_lightcuts --accuracy [--rays] [--probes N] [--paths N] [SCENE ...]
//                                                       field, and cuts at 2 and .5 %, against the reference, and
//                                                       against all lights; --rays: the light of discs is carried along
//                                                       64 exact rays of each voxel entry
//   bench_lightcuts --cuts [--probes N] [SCENE ...]   cuts at 2, 1 and .5 % against all lights: where their error is
// Voxels: 128 along the longest side, 1024 directions.
#include "core/compare/image_error.h"
#include "tests/bench_clock.h"
#include "tests/bench_judge.h"
#include "tests/bench_scene.h"
#include "tests/voxel_lights.h"
#include <embree3/rtcore.h>
#include <numeric>

using namespace lightloom;

namespace {

constexpr int kCells = 128, kDirections = 1024;

/// All lights by packets of rays, as `Lightcuts::everyLight` one by one.
template<unsigned Width>
class PacketGather {
public:
    PacketGather(const RayScene& rays, const LightTree& tree, const Lightcuts& cuts)
        : rays_(rays), tree_(tree), cuts_(cuts)
    {
    }

    glm::vec3 at(glm::vec3 p, glm::vec3 n)
    {
        sum_ = glm::dvec3(0.0);
        const Receiver receiver{p, n};
        const glm::vec3 origin = rays_.leave(p, n);
        for (std::size_t i = 0; i < tree_.lights().size(); ++i) {
            const float transfer = discTransfer(receiver, tree_.lights()[i], {});
            if (!(transfer > 0.0f)) continue;
            const glm::vec3 travel = cuts_.endOfRay(tree_, tree_.lights()[i]) - origin;
            x_[count_] = travel.x, y_[count_] = travel.y, z_[count_] = travel.z;
            lux_[count_] = tree_.fluxOf(i) * transfer;
            if (++count_ == Width) shoot(origin);
        }
        if (count_ > 0) shoot(origin);
        return glm::vec3(sum_);
    }

private:
    using Packet = std::conditional_t<Width == 8, RTCRay8, RTCRay16>;

    void shoot(glm::vec3 origin)
    {
        alignas(64) Packet rays{};
        alignas(64) int valid[Width] = {};
        for (unsigned i = 0; i < count_; ++i) {
            rays.org_x[i] = origin.x, rays.org_y[i] = origin.y, rays.org_z[i] = origin.z;
            rays.dir_x[i] = x_[i], rays.dir_y[i] = y_[i], rays.dir_z[i] = z_[i];
            rays.tfar[i] = 1.0f - 1e-6f;
            rays.mask[i] = 0xFFFFFFFFu;
            valid[i] = -1;
        }
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        const auto scene = static_cast<RTCScene>(rays_.embreeScene());
        if constexpr (Width == 8)
            rtcOccluded8(valid, scene, &context, &rays);
        else
            rtcOccluded16(valid, scene, &context, &rays);
        for (unsigned i = 0; i < count_; ++i) {
            if (rays.tfar[i] >= 0.0f) sum_ += glm::dvec3(lux_[i]);
        }
        count_ = 0;
    }

    const RayScene& rays_;
    const LightTree& tree_;
    const Lightcuts& cuts_;
    float x_[Width], y_[Width], z_[Width];
    glm::vec3 lux_[Width];
    unsigned count_ = 0;
    glm::dvec3 sum_{0.0};
};

struct Lit {
    std::shared_ptr<const Scene> scene;
    SceneProducts at;
    VoxelLights voxels;
    std::shared_ptr<const LightTree> tree = voxels.tree();
    Lightcuts alone{at.rays, tree}; // discs only
    Lightcuts cuts{at.rays, tree, std::make_shared<EntryNearField>(at.rays, voxels, at.lights.get())};
};

Lit light(const std::string& name, const BakeParams& params, int exactRays, Workers& workers)
{
    auto scene = std::make_shared<const Scene>(*benchScene(name));
    BakeProducts products;
    BakeControl quiet(workers, {});
    SceneProducts at = *sceneProducts({scene, params, {}}, products, quiet);
    VoxelLights voxels(*at.rays, *at.lights, *at.reach, kCells, kDirections, workers, 0.0f, exactRays);
    return {std::move(scene), std::move(at), std::move(voxels)};
}

/// CPU milliseconds of the calling thread for each of `places`.
template<class Do>
double msEach(const std::vector<SurfacePoint>& places, Do work)
{
    const FlushDenormals flush;
    const double from = cpuSeconds(CpuOf::thread);
    for (std::size_t i = 0; i < places.size(); ++i) work(places[i], i);
    return 1e3 * (cpuSeconds(CpuOf::thread) - from) / static_cast<double>(places.size());
}

void speed(const std::string& name, Workers& workers)
{
    const Lit lit = light(name, {}, 0, workers);
    constexpr int kRounds = 5;
    constexpr std::uint64_t kPlaces = 60;
    const auto places = samplePoints(*lit.at.rays, *lit.at.lights, *lit.at.reach, kPlaces * kRounds, 1);
    PacketGather<8> eight(*lit.at.rays, *lit.tree, lit.alone);
    PacketGather<16> sixteen(*lit.at.rays, *lit.tree, lit.alone);
    std::vector<double> build, refresh, one, packet8, packet16, cut, near, byOne, byPacket, nodes, rays;
    double worst = 0.0; // packets against one by one
    for (std::size_t round = 0; round < kRounds; ++round) {
        const std::vector<SurfacePoint> some(places.begin() + static_cast<std::ptrdiff_t>(round * kPlaces),
                                             places.begin() + static_cast<std::ptrdiff_t>((round + 1) * kPlaces));
        const double start = cpuSeconds(CpuOf::thread);
        const auto tree = lit.voxels.tree();
        const double built = cpuSeconds(CpuOf::thread);
        const auto again = tree->withExitance(lit.voxels.exitance);
        build.push_back(1e3 * (built - start));
        refresh.push_back(1e3 * (cpuSeconds(CpuOf::thread) - built));
        std::vector<glm::vec3> exact(some.size());
        one.push_back(msEach(some, [&](const SurfacePoint& p, std::size_t i) {
            exact[i] = lit.alone.everyLight(p.position, p.normal, i, {});
        }));
        packet8.push_back(msEach(some, [&](const SurfacePoint& p, std::size_t i) {
            worst = std::max(worst, static_cast<double>(std::abs(
                                        luminance(eight.at(p.position, p.normal)) / luminance(exact[i]) - 1.0f)));
        }));
        packet16.push_back(
            msEach(some, [&](const SurfacePoint& p, std::size_t) { (void)sixteen.at(p.position, p.normal); }));
        cut.push_back(msEach(some, [&](const SurfacePoint& p, std::size_t i) {
            const Lightcut found = lit.alone.at(p.position, p.normal, i, {});
            nodes.push_back(found.nodes), rays.push_back(found.shadowRays);
        }));
        near.push_back(msEach(
            some, [&](const SurfacePoint& p, std::size_t i) { (void)lit.cuts.at(p.position, p.normal, i, {}); }));
        byOne.push_back(one.back() / cut.back());
        byPacket.push_back(std::min(packet8.back(), packet16.back()) / cut.back());
    }
    double meanNodes = 0.0, meanRays = 0.0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        meanNodes += nodes[i] / static_cast<double>(nodes.size());
        meanRays += rays[i] / static_cast<double>(nodes.size());
    }
    fmt::print("{}: {} lights, tree {:.1f} ms, lit anew {:.1f} ms\n", name, lit.tree->lights().size(), median(build),
               median(refresh));
    fmt::print("  ms a place: one by one {:.3f}, packets of 8 {:.3f}, of 16 {:.3f} (off by {:.1e}), cut at 2 % {:.4f}, "
               "with near rays {:.4f}\n",
               median(one), median(packet8), median(packet16), worst, median(cut), median(near));
    fmt::print("  cut: {:.1f} x one by one, {:.1f} x packets; {:.0f} nodes and {:.0f} shadow rays in the mean\n",
               median(byOne), median(byPacket), meanNodes, meanRays);

    // random voxels in the time of a cut: as many as its shadow rays cost
    const std::size_t draws = 1000;
    const LightSamples samples(*lit.tree, draws, 1);
    const double sampled = msEach(places, [&](const SurfacePoint& p, std::size_t i) {
        (void)lit.alone.fromSamples(p.position, p.normal, i, {}, samples, 0, draws);
    });
    const auto equal = static_cast<std::size_t>(static_cast<double>(draws) * median(cut) / sampled);
    std::vector<double> exact, byCut, bySamples;
    for (std::size_t i = 0; i < kPlaces; ++i) {
        const SurfacePoint& p = places[i];
        exact.push_back(static_cast<double>(luminance(lit.alone.everyLight(p.position, p.normal, i, {}))));
        byCut.push_back(static_cast<double>(luminance(lit.alone.at(p.position, p.normal, i, {}).illuminance)));
        bySamples.push_back(
            static_cast<double>(luminance(lit.alone.fromSamples(p.position, p.normal, i, {}, samples, 0, equal))));
    }
    fmt::print("  against all lights: cut {:.4f}, {} random voxels in the same time {:.4f}\n",
               measureError(byCut, exact)->relRmse, equal, measureError(bySamples, exact)->relRmse);
}

void tell(const char* what, const std::vector<double>& values, const std::vector<double>& against, double ms)
{
    const ErrorMetrics error = *measureError(values, against);
    fmt::print("  {:34} relRMSE {:.4f} bias {:+.4f} per point {:.4f} p95 {:.3f} max {:.2f}  {:.4f} ms\n", what,
               error.relRmse, error.bias, error.perPoint, error.p95, error.max, ms);
}

void accuracy(const std::string& name, const JudgeSettings& settings, int exactRays, Workers& workers)
{
    const Lit lit = light(name, settings.params, exactRays, workers);
    const Judge judge(lit.at, settings, workers);
    double mean = 0.0;
    for (const double lux : judge.reference) mean += lux / static_cast<double>(judge.reference.size());
    fmt::print("{}: {} lights, reference noise {:.4f}\n", name, lit.tree->lights().size(),
               relativeNoise(judge.noise, mean));
    const EntryLookup lookup(lit.voxels.voxels);
    std::vector<double> values(judge.surface.size()), every(judge.surface.size());
    const double ms = msEach(judge.surface, [&](const SurfacePoint& p, std::size_t i) {
        values[i] = static_cast<double>(luminance(lookup.at(p.position, p.normal, lit.voxels.indirect)));
    });
    tell("field", values, judge.reference, ms);
    workers.run(every.size(), {}, [&](std::size_t i) {
        const SurfacePoint& p = judge.surface[i];
        every[i] = static_cast<double>(luminance(lit.cuts.everyLight(p.position, p.normal, i, {})));
    });
    tell("all lights and near rays", every, judge.reference, 0.0);
    for (const float threshold : {0.02f, 0.005f}) {
        LightcutParams params;
        params.threshold = threshold;
        const double each = msEach(judge.surface, [&](const SurfacePoint& p, std::size_t i) {
            values[i] = static_cast<double>(luminance(lit.cuts.at(p.position, p.normal, i, params).illuminance));
        });
        tell(fmt::format("cut at {} and near rays", threshold).c_str(), values, judge.reference, each);
        tell("  against all lights", values, every, each);
    }
    std::fflush(stdout);
}

/// Cuts against all lights, in thresholds: RMS over the mean of all places and over each place's own light, its 99th
/// percentile; how much of the squared error one place in a hundred holds, and how bright these are.
void againstAll(const std::string& name, const JudgeSettings& settings, Workers& workers)
{
    const Lit lit = light(name, settings.params, 0, workers);
    const auto places =
        samplePoints(*lit.at.rays, *lit.at.lights, *lit.at.reach, static_cast<std::uint64_t>(settings.probes), 1);
    std::vector<double> every(places.size());
    workers.run(every.size(), {}, [&](std::size_t i) {
        every[i] = static_cast<double>(luminance(lit.cuts.everyLight(places[i].position, places[i].normal, i, {})));
    });
    const auto count = static_cast<double>(places.size());
    const double mean = std::accumulate(every.begin(), every.end(), 0.0) / count;
    for (const float threshold : {0.02f, 0.01f, 0.005f}) {
        LightcutParams params;
        params.threshold = threshold;
        params.mostNodes = settings.params.voxelCut;
        struct Off {
            double squared, lux;
        };
        std::vector<Off> off;
        std::vector<double> own;
        double nodes = 0.0, full = 0.0, ownSquares = 0.0;
        const double ms = msEach(places, [&](const SurfacePoint& p, std::size_t i) {
            const Lightcut cut = lit.cuts.at(p.position, p.normal, i, params);
            const double apart = static_cast<double>(luminance(cut.illuminance)) - every[i];
            off.push_back({apart * apart, every[i]});
            if (every[i] > 0.0) own.push_back(std::abs(apart) / every[i] / static_cast<double>(threshold));
            nodes += cut.nodes / count;
            full += params.mostNodes > 0 && cut.nodes >= params.mostNodes ? 1.0 / count : 0.0;
        });
        for (const double share : own) ownSquares += share * share / static_cast<double>(own.size());
        std::ranges::sort(off, std::greater{}, &Off::squared);
        std::ranges::sort(own);
        double squares = 0.0, worst = 0.0, worstLux = 0.0;
        const std::size_t few = std::max<std::size_t>(1, places.size() / 100);
        for (std::size_t i = 0; i < off.size(); ++i) {
            squares += off[i].squared;
            if (i < few) worst += off[i].squared, worstLux += off[i].lux / static_cast<double>(few);
        }
        const double wide = std::sqrt(squares / count) / mean / static_cast<double>(threshold);
        fmt::print(
            "{} at {}: RMS {:.2f} over the mean ({:.2f} without the worst hundredth), {:.2f} over each place's own, "
            "p99 {:.1f}; the worst hundredth holds {:.0f} % and is {:.1f} times as bright as the mean; {:.0f} "
            "nodes, {:.0f} % at the limit, {:.3f} ms\n",
            name, threshold, wide, wide * std::sqrt(1.0 - worst / squares), std::sqrt(ownSquares),
            own[static_cast<std::size_t>(0.99 * static_cast<double>(own.size() - 1))], 100.0 * worst / squares,
            worstLux / mean, nodes, 100.0 * full, ms);
    }
    std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv)
{
    auto settings = JudgeSettings::read(argc, argv);
    if (!settings) return 2;
    Workers workers;
    const bool isAccuracy = std::erase(settings->words, "--accuracy") > 0;
    const bool isAgainstAll = std::erase(settings->words, "--cuts") > 0;
    const int exactRays = std::erase(settings->words, "--rays") > 0 ? 64 : 0;
    if (settings->words.empty()) settings->words = {"cornell"};
    for (const std::string& name : settings->words) {
        if (isAgainstAll)
            againstAll(name, *settings, workers);
        else if (isAccuracy)
            accuracy(name, *settings, exactRays, workers);
        else
            speed(name, workers);
    }
}
