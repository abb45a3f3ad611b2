// SPDX-License-Identifier: Apache-2.0
// Hot loops against a ceiling and a named baseline, in one run, one thread, CPU time, variants in turn, medians of 5:
//   photon tracing against bare rtcIntersect1 on the same rays;  kd-tree gather against nanoflann on the same queries.
//   bench_photons [SCENE ...]
#include "core/photonmap/photon_map.h"
#include "core/trace/light_reach.h"
#include "core/trace/material.h"
#include "tests/bench_clock.h"
#include "tests/bench_embree.h"
#include "tests/bench_scene.h"
#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <nanoflann.hpp>

using namespace lightloom;

namespace {

template<class Body>
double timed(Body body)
{
    const double began = cpuSeconds(CpuOf::thread);
    body();
    return cpuSeconds(CpuOf::thread) - began;
}

/// The rays of real photon paths: emitted, then scattered as the tracer does.
std::vector<Ray> recordRays(const RayScene& rays, const LightSampler& lights, std::size_t wanted)
{
    std::vector<Ray> recorded;
    for (std::uint64_t i = 0; recorded.size() < wanted && i < 50 * wanted; ++i) {
        Rng rng(9, rays.scene().groups[0].key(), i);
        EmittedPhoton photon;
        if (!lights.emit(0, rng, photon)) break;
        Ray ray{photon.position, photon.travel};
        for (int bounce = 0; bounce < 64; ++bounce) {
            recorded.push_back(ray);
            Hit hit;
            if (!rays.intersect(ray.origin, ray.travel, std::numeric_limits<float>::infinity(), hit)) break;
            Scatter next;
            const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
            if (!scatter(surfaceAt(rays, hit), hit.facing(), -ray.travel, u, next)) break;
            if (rng.uniform() >= std::max({next.weight.x, next.weight.y, next.weight.z})) break;
            ray = {rays.leave(hit.position, hit.facing()), next.away};
        }
    }
    return recorded;
}

std::shared_ptr<const PhotonPaths> benchTracer(const std::string& name, const RayScene& rays,
                                               const LightSampler& lights)
{
    Workers one(1);
    PhotonJob job;
    job.count = 200'000;
    const std::vector<Ray> recorded = recordRays(rays, lights, 400'000);
    std::shared_ptr<const PhotonPaths> paths;
    std::vector<double> single, together, gain;
    double rays1 = 0.0, rays8 = 0.0, bare = 0.0;
    const auto perRay = [&](bool oneByOne) {
        job.oneByOne = oneByOne;
        const double seconds = timed([&] { paths = tracePhotons(rays, lights, job, one, {}); });
        return seconds / static_cast<double>(paths->rays);
    };
    for (int round = 0; round < 5; ++round) {
        const double e = timed([&] { bareEmbree(rays, recorded); }) / static_cast<double>(recorded.size());
        const double t1 = perRay(true), t8 = perRay(false);
        single.push_back(e / t1), together.push_back(e / t8), gain.push_back(t1 / t8);
        rays1 = 1e-6 / t1, rays8 = 1e-6 / t8, bare = 1e-6 / e;
    }
    fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.0f} % | {:.0f} % | {:.2f} |\n", name, rays.triangleCount(),
               rays1, rays8, bare, 100.0 * median(single), 100.0 * median(together), median(gain));
    return paths;
}

/// Positions as nanoflann wants to see them.
struct Cloud {
    const RawVector<Photon>& photons;
    [[nodiscard]] std::size_t kdtree_get_point_count() const { return photons.size(); }
    [[nodiscard]] float kdtree_get_pt(std::size_t i, std::size_t axis) const
    {
        return photons[i].position[static_cast<int>(axis)];
    }
    template<class Box>
    bool kdtree_get_bbox(Box&) const
    {
        return false;
    }
};

void benchGather(const std::shared_ptr<const PhotonPaths>& paths, const std::vector<SurfacePoint>& queries)
{
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3>;
    const Cloud cloud{paths->photons};
    std::unique_ptr<Tree> tree;
    std::shared_ptr<const PhotonMap> map;
    const double theirBuild = timed([&] {
        tree = std::make_unique<Tree>(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
        tree->buildIndex();
    });
    const double ourBuild = timed([&] { map = PhotonMap::build(paths); });
    fmt::print("\nkd-tree build, {} photons: {:.3f} s, nanoflann {:.3f} s, {:.2f} x\n\n", map->size(), ourBuild,
               theirBuild, ourBuild / theirBuild);
    fmt::print("| K | ours, us per query | nanoflann, us | times faster | same sets |\n|---|---|---|---|---|\n");
    for (const std::uint32_t k : {50u, 100u, 250u, 500u}) {
        std::vector<double> ours, theirs;
        std::size_t same = 0;
        for (int round = 0; round < 5; ++round) {
            Gathered gathered;
            std::vector<std::size_t> index(k);
            std::vector<float> squared(k);
            std::vector<float> radii;
            ours.push_back(timed([&] {
                for (const SurfacePoint& q : queries) {
                    map->gather({q.position, q.normal, std::numeric_limits<float>::max() / 4, 1.0f, -2.0f, k},
                                gathered);
                    radii.push_back(gathered.radius * gathered.radius);
                }
            }));
            same = 0;
            std::size_t number = 0;
            theirs.push_back(timed([&] {
                for (const SurfacePoint& q : queries) {
                    nanoflann::KNNResultSet<float, std::size_t> found(k);
                    found.init(index.data(), squared.data());
                    tree->findNeighbors(found, &q.position.x, nanoflann::SearchParams());
                    same += std::abs(squared[k - 1] - radii[number]) <= 1e-4f * radii[number];
                    ++number;
                }
            }));
        }
        const double n = 1e6 / static_cast<double>(queries.size());
        fmt::print("| {} | {:.2f} | {:.2f} | {:.1f} | {} of {} |\n", k, median(ours) * n, median(theirs) * n,
                   median(theirs) / median(ours), same, queries.size());
    }
}

} // namespace

int main(int argc, char** argv)
{
    std::vector<std::string> names(argv + 1, argv + argc);
    if (names.empty()) names = {"cornell", "two_rooms", "atrium", "figure", "figure:70000", "figure:200000"};
    fmt::print("| scene | triangles | one by one, M rays/s | eight together | bare rtcIntersect1 | share one by one | "
               "share together | together against one by one |\n|---|---|---|---|---|---|---|---|\n");
    std::shared_ptr<const PhotonPaths> first;
    std::vector<SurfacePoint> queries;
    for (const std::string& name : names) {
        const Result<Scene> made = benchScene(name);
        if (!made) return fmt::print("{}\n", made.error().message), 2;
        const auto rays = RayScene::build(std::make_shared<const Scene>(*made));
        if (!rays) return fmt::print("{}\n", rays.error().message), 1;
        const LightSampler lights(*rays);
        const auto paths = benchTracer(name, **rays, lights);
        if (first) continue;
        Workers workers;
        const auto reach = LightReach::find(**rays, lights, workers, {});
        queries = samplePoints(**rays, lights, *reach, 5000, 2);
        PhotonJob job;
        job.count = 600'000;
        first = tracePhotons(**rays, lights, job, workers, {});
    }
    benchGather(first, queries);
    return 0;
}
