// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/photon_products.h"
#include "core/base/memory_use.h"
#include "core/params/param_text.h"
#include <fmt/format.h>

namespace lightloom {

Result<SceneProducts> sceneProducts(const BakeJob& job, BakeProducts& products, BakeControl& control)
{
    SceneProducts result;
    const Sha256::Digest hash = sceneHash(*job.scene);
    result.key = fmt::format("{}/{}/", toHex(hash), kIsaNames[static_cast<std::size_t>(job.isa)]);
    result.rays = products.find<RayScene>(result.key);
    if (!result.rays) {
        const StageClock clock("rays", control, CpuClock::process);
        Result<std::shared_ptr<const RayScene>> built = RayScene::build(job.scene, job.isa, control.stop());
        if (!built) return built.error();
        result.rays = *built;
        products.keep(result.key, result.rays, clock.stop());
    }
    result.lights = products.find<LightSampler>(result.key);
    if (!result.lights) {
        const StageClock clock("lamps", control);
        result.lights = std::make_shared<LightSampler>(result.rays);
        products.keep(result.key, result.lights, clock.stop());
    }
    result.reach = products.find<LightReach>(result.key);
    if (!result.reach) {
        const StageClock clock("reach", control);
        result.reach = LightReach::find(*result.rays, *result.lights, control.workers(), control.stop());
        if (!result.reach) return cancelled();
        products.keep(result.key, result.reach, clock.stop());
    }
    return result;
}

Result<Done> checkPhotonsFit(const BakeJob& job)
{
    int on = 0;
    for (int g = 0; g < static_cast<int>(job.scene->groups.size()); ++g) on += isOff(job.mix, g) ? 0 : 1;
    // two to three are stored per photon shot, each in the list and in the tree
    const double perPhoton = 2.5 * static_cast<double>(2 * sizeof(Photon) + 32);
    const double wanted = perPhoton * job.params.photonCount * on, have = 0.9 * machineMemoryBytes();
    if (wanted <= have) return Done{};
    return Error{Error::Kind::outOfMemory,
                 fmt::format("{} photons for each of {} light groups need about {:.1f} GiB, this machine has {:.1f}; "
                             "lower photons",
                             job.params.photonCount, on, wanted / (1 << 30), have / (1 << 30))};
}

namespace {

std::string photonKey(const BakeJob& job, const SceneProducts& scene, int group)
{
    return scene.key + job.scene->groups[static_cast<std::size_t>(group)].id + "\n" +
           stageKey(job.params, Stage::shoot, Method::photonMap);
}

std::shared_ptr<const PhotonPaths> paths(const BakeJob& job, const SceneProducts& scene, int group,
                                         const std::string& key, BakeProducts& products, BakeControl& control,
                                         const std::function<void(double)>& progress)
{
    WorkCounters& counters = products.counters;
    if (auto kept = products.find<PhotonPaths>(key)) {
        counters.photonsReused += kept->shot;
        ++counters.groupsReused;
        return kept;
    }
    const StageClock clock("shoot", control);
    const PhotonJob shoot{group, job.params.seed, static_cast<std::uint64_t>(job.params.photonCount),
                          job.params.pathDepth};
    auto shot =
        tracePhotons(*scene.rays, *scene.lights, shoot, control.workers(), control.stop(),
                     [&](std::uint64_t done, std::uint64_t all) {
                         control.waitWhilePaused();
                         progress(static_cast<double>(done) / static_cast<double>(std::max<std::uint64_t>(all, 1)));
                     });
    if (!shot) return nullptr;
    counters.photonsShot += shot->shot;
    counters.raysTraced += shot->rays;
    products.keep(key, shot, clock.stop());
    return shot;
}

} // namespace

std::optional<PhotonProducts> keptPhotons(const BakeJob& job, const SceneProducts& scene, BakeProducts& products)
{
    PhotonProducts result{scene, products.find<SurfaceArea>(scene.key), {}};
    if (!result.area) return std::nullopt;
    for (int g = 0; g < static_cast<int>(job.scene->groups.size()); ++g) {
        result.maps.push_back(isOff(job.mix, g) ? nullptr : products.find<PhotonMap>(photonKey(job, scene, g)));
        if (!result.maps.back() && !isOff(job.mix, g)) return std::nullopt;
    }
    return result;
}

Result<PhotonProducts> photonProducts(const BakeJob& job, BakeProducts& products, BakeControl& control, double share)
{
    PhotonProducts result;
    const int groups = static_cast<int>(job.scene->groups.size());
    int on = 0;
    for (int g = 0; g < groups; ++g) on += isOff(job.mix, g) ? 0 : 1;
    if (const Result<Done> fits = checkPhotonsFit(job); !fits) return fits.error();

    control.progress(Stage::shoot, 0.0);
    Result<SceneProducts> scene = sceneProducts(job, products, control);
    if (!scene) return scene.error();
    result.scene = std::move(*scene);
    result.area = products.find<SurfaceArea>(result.scene.key);
    if (!result.area) {
        const StageClock clock("area", control);
        result.area = SurfaceArea::build(*result.scene.reach, control.stop());
        if (!result.area) return cancelled();
        products.keep(result.scene.key, result.area, clock.stop());
    }

    WorkCounters& counters = products.counters;
    int done = 0;
    for (int g = 0; g < groups; ++g) {
        if (isOff(job.mix, g)) {
            ++counters.groupsOff;
            result.maps.push_back(nullptr);
            continue;
        }
        const std::string key = photonKey(job, result.scene, g);
        const auto shot = paths(job, result.scene, g, key, products, control, [&](double fraction) {
            control.progress(Stage::shoot, share * (done + 0.8 * fraction) / on);
        });
        if (!shot) return cancelled();
        counters.photonsStored += shot->photons.size();
        counters.causticPhotons += shot->caustic;
        counters.pathsCutOff += shot->cutOff;
        counters.ledger += shot->ledger;
        ++counters.groupsBaked;
        auto map = products.find<PhotonMap>(key);
        if (!map) {
            const StageClock clock("tree", control);
            map = PhotonMap::build(shot, control.stop());
            if (!map) return cancelled();
            products.keep(key, map, clock.stop());
        }
        result.maps.push_back(map);
        control.progress(Stage::shoot, share * ++done / on);
    }
    return result;
}

} // namespace lightloom
