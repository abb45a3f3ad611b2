// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/photon_products.h"
#include "core/base/memory_use.h"
#include "core/params/param_text.h"
#include "core/trace/light_spaces.h"
#include <fmt/format.h>

namespace lightloom {

namespace {

/// The surface of the scene that was baked last: edits of it need no look at meshes and images.
struct KnownSurface {
    std::shared_ptr<const Scene> scene;
    std::string key;
};

std::string surfaceKey(const BakeJob& job, BakeProducts& products)
{
    const auto known = products.find<KnownSurface>("");
    std::string key;
    if (known && isSameSurface(*known->scene, *job.scene))
        key = known->key;
    else
        key = toHex(surfaceHash(*job.scene));
    if (!known || known->scene != job.scene)
        products.keep<KnownSurface>("", std::make_shared<KnownSurface>(KnownSurface{job.scene, key}));
    return fmt::format("{}/{}/", key, kIsaNames[static_cast<std::size_t>(job.isa)]);
}

void nameLamps(const Scene& scene, const std::string& surface, SceneProducts& result)
{
    Sha256 all;
    for (int g = 0; g < static_cast<int>(scene.groups.size()); ++g) {
        const std::string lamp = toHex(lampHash(scene, g));
        all.add(lamp);
        result.lampKeys.push_back(fmt::format("{}lamp {}/", surface, lamp));
    }
    result.sceneKey = fmt::format("{}lamps {}/", surface, toHex(all.finish()));
}

Result<Done> raysAndLights(const BakeJob& job, const std::string& surface, BakeProducts& products, BakeControl& control,
                           SceneProducts& result)
{
    auto rays = products.find<RayScene>(surface);
    if (!rays) {
        const StageClock clock("rays", control, CpuClock::process);
        Result<std::shared_ptr<const RayScene>> built = RayScene::build(job.scene, job.isa, control.stop());
        if (!built) return built.error();
        rays = *built;
        products.keep(surface, rays, clock.stop());
    }
    result.lights = products.find<LightSampler>(result.sceneKey);
    if (!result.lights) {
        const StageClock clock("lamps", control);
        const auto newest = products.find<LightSampler>(surface);
        if (rays->sharedScene() != job.scene) rays = rays->withScene(job.scene);
        result.lights = std::make_shared<LightSampler>(rays, newest.get());
        products.keep(result.sceneKey, result.lights, clock.stop());
        products.keep(surface, result.lights);
    }
    result.rays = result.lights->rays();
    return Done{};
}

/// By element, what the scene's lamps reach: each of them is asked once, wherever others move. `detail`: in keys of
/// spaces that are not exact. Empty: stopped.
std::vector<std::uint8_t> reachedElements(const Scene& scene, const LightSpaces& spaces, const SceneProducts& known,
                                          const std::string& detail, BakeProducts& products, BakeControl& control)
{
    std::vector<std::shared_ptr<const GroupReach>> groups;
    for (int g = 0; g < static_cast<int>(scene.groups.size()); ++g) {
        const std::string key = known.lampKey(static_cast<std::size_t>(g)) + detail;
        auto group = products.find<GroupReach>(key);
        if (!group) {
            const StageClock clock("reach", control);
            group = spaces.ofGroup(scene, *known.lights, g, control.workers(), control.stop());
            if (!group) return {};
            products.keep(key, group, clock.stop());
        }
        groups.push_back(group);
    }
    if (groups.empty()) return LightReach::everything(spaces.elements());
    return spaces.united(groups, control.workers(), control.stop());
}

bool findReach(const BakeJob& job, const std::string& surface, ReachWanted wanted, BakeProducts& products,
               BakeControl& control, SceneProducts& result)
{
    auto spaces = products.find<LightSpaces>(surface);
    const bool isRough = !spaces && wanted == ReachWanted::quick;
    const std::string detail = isRough ? "rough/" : "";
    if (isRough) spaces = products.find<LightSpaces>(surface + detail);
    if (!spaces) {
        const StageClock clock("reach", control);
        spaces = LightSpaces::build(result.rays, isRough ? SpaceDetail::rough() : SpaceDetail{}, control.workers(),
                                    control.stop());
        if (!spaces) return false;
        products.keep(surface + detail, spaces, clock.stop());
    }
    const std::vector<std::uint8_t> isReached = reachedElements(*job.scene, *spaces, result, detail, products, control);
    if (control.isStopped()) return false;
    Sha256 content;
    content.add(isReached);
    result.reachKey = fmt::format("{}{}reach {}/", surface, detail, toHex(content.finish()));
    result.reach = products.find<LightReach>(result.reachKey);
    if (result.reach) return true;
    const StageClock clock("reach", control);
    result.reach = LightReach::of(spaces->elements(), isReached, control.stop());
    if (!result.reach) return false;
    products.keep(result.reachKey, result.reach, clock.stop());
    return true;
}

} // namespace

Result<SceneProducts> sceneProducts(const BakeJob& job, BakeProducts& products, BakeControl& control, ReachWanted reach)
{
    SceneProducts result;
    const std::string surface = surfaceKey(job, products);
    nameLamps(*job.scene, surface, result);
    if (const Result<Done> made = raysAndLights(job, surface, products, control, result); !made) return made.error();
    if (!findReach(job, surface, reach, products, control, result)) return cancelled();
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
    return scene.lampKey(static_cast<std::size_t>(group)) + stageKey(job.params, Stage::shoot, Method::photonMap);
}

/// The photons of a group; without the list itself if they are in a map already.
std::shared_ptr<const PhotonPaths> paths(const BakeJob& job, const SceneProducts& scene, int group,
                                         const std::string& key, bool isMapped, BakeProducts& products,
                                         BakeControl& control, const std::function<void(double)>& progress)
{
    WorkCounters& counters = products.counters;
    const auto kept = products.find<PhotonPaths>(key);
    if (kept && (isMapped || !kept->photons.empty())) {
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
    PhotonProducts result{scene, products.find<SurfaceArea>(scene.reachKey), {}};
    if (!result.area) return std::nullopt;
    for (int g = 0; g < static_cast<int>(job.scene->groups.size()); ++g) {
        result.maps.push_back(isOff(job.mix, g) ? nullptr : products.find<PhotonMap>(photonKey(job, scene, g)));
        if (!result.maps.back() && !isOff(job.mix, g)) return std::nullopt;
    }
    return result;
}

Result<PhotonProducts> photonProducts(const BakeJob& job, BakeProducts& products, BakeControl& control, double share,
                                      ReachWanted reach)
{
    PhotonProducts result;
    const int groups = static_cast<int>(job.scene->groups.size());
    int on = 0;
    for (int g = 0; g < groups; ++g) on += isOff(job.mix, g) ? 0 : 1;
    if (const Result<Done> fits = checkPhotonsFit(job); !fits) return fits.error();

    control.progress(Stage::shoot, 0.0);
    Result<SceneProducts> scene = sceneProducts(job, products, control, reach);
    if (!scene) return scene.error();
    result.scene = std::move(*scene);
    result.area = products.find<SurfaceArea>(result.scene.reachKey);
    if (!result.area) {
        const StageClock clock("area", control);
        result.area = SurfaceArea::build(*result.scene.reach, control.stop());
        if (!result.area) return cancelled();
        products.keep(result.scene.reachKey, result.area, clock.stop());
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
        auto map = products.find<PhotonMap>(key);
        const auto shot = paths(job, result.scene, g, key, map != nullptr, products, control, [&](double fraction) {
            control.progress(Stage::shoot, share * (done + 0.8 * fraction) / on);
        });
        if (!shot) return cancelled();
        counters.causticPhotons += shot->caustic;
        counters.pathsCutOff += shot->cutOff;
        counters.ledger += shot->ledger;
        ++counters.groupsBaked;
        if (!map) {
            const StageClock clock("tree", control);
            map = PhotonMap::build(shot, control.stop());
            if (!map) return cancelled();
            products.keep(key, map, clock.stop());
            products.replace(key, std::make_shared<const PhotonPaths>(shot->withoutPhotons()));
        }
        counters.photonsStored += map->size();
        result.maps.push_back(map);
        control.progress(Stage::shoot, share * ++done / on);
    }
    return result;
}

} // namespace lightloom
