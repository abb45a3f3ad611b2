// SPDX-License-Identifier: Apache-2.0
#include "app/cli/methods.h"
#include "app/cli/progress.h"
#include "core/bake/bake_file.h"
#include "core/bake/packed_octree.h"
#include "core/bake/solver_for.h"
#include "core/base/memory_use.h"
#include "core/ivg/irradiance_grid.h"
#include "core/octree/light_octree.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/gltf_reader.h"
#include "core/voxel/voxel_field.h"
#include <chrono>
#include <fmt/format.h>

namespace lightloom::cli {
namespace {

/// Runs the method's solver on the scene as it is (all lamps on) and keeps its last field.
Result<Done> bakeNow(const Context& context, const LightingRequest& request, double share, Lighting& lighting)
{
    Result<std::shared_ptr<const Scene>> scene = readScene(request.scene, context.log, context.stop);
    if (!scene) return scene.error();
    BakeJob job{*scene, lighting.params, {}, request.options.isa, 0};
    BakeProducts products;
    if (hasBudget(request.options)) {
        Result<BudgetReport> picked = pickForBudget(context, request.options, job, lighting.method,
                                                    storeOf(context, request.scene, request.cache), products);
        if (!picked) return picked.error();
        lighting.params = job.params = picked->plan.params;
        lighting.budget = *std::move(picked);
        products.beginRound();
    }
    BakeControl::Sinks sinks;
    sinks.publish = [&](const Snapshot& snapshot) { lighting.field = snapshot.field; };
    sinks.progress = [&](const Progress& p) { context.report->progress(stageName(p.stage), share * p.fraction); };
    BakeControl control(*context.workers, std::move(sinks), context.stop);
    const Result<Done> baked = solverFor(lighting.method)->bake(job, products, control);
    if (!baked) return baked.error();
    lighting.bakeSeconds = control.elapsedMs() / 1000.0;
    const Result<SceneProducts> kept = sceneProducts(job, products, control); // finds what the solver left
    if (!kept) return kept.error();
    lighting.lit = {*scene, kept->rays, kept->lights, kept->reach};
    lighting.counters = products.counters;
    if (lighting.budget) {
        const double cpuSeconds = allCpuSeconds(lighting.counters.stages);
        const Result<Done> judged = judgeBudget(context, *lighting.budget, *kept, *lighting.field, cpuSeconds);
        if (!judged) return judged.error();
    }
    log(context.log, LogLevel::debug,
        fmt::format("{} baked in {:.2f} s, {:.1f} MiB", methodName(lighting.method), lighting.bakeSeconds,
                    static_cast<double>(lighting.field->memoryBytes()) / (1 << 20)));
    return Done{};
}

/// Options may change how a finished bake is shown, not what it is.
Result<BakeParams> shownWith(const BakeParams& baked, const BakeOptions& options, Method method)
{
    if (options.isPresetGiven) {
        return Error{Error::Kind::badInput, "--preset cannot change a finished bake; leave it or --bake out"};
    }
    const Result<BakeParams> asked = withOptions(baked, options);
    if (!asked) return asked;
    for (const ParamSpec& spec : kParams) {
        const bool counts = (spec.methods & (1u << static_cast<unsigned>(method))) != 0 && spec.redo != Stage::show;
        if (!counts || paramValue(baked, spec) == paramValue(*asked, spec)) continue;
        return Error{Error::Kind::badInput,
                     fmt::format("{0}={1} was asked for, the bake was made with {0}={2}; bake anew", spec.key,
                                 paramText(*asked, spec), paramText(baked, spec))};
    }
    return asked;
}

/// The photon map's field over a file's photons; trees and reached surface are made anew.
Result<Done> fromPhotons(const Context& context, BakeFile& file, Lighting& lighting)
{
    const LitScene& lit = lighting.lit;
    const auto reach = LightReach::find(*lit.rays, *lit.lights, *context.workers, context.stop);
    if (!reach) return cancelled();
    std::vector<std::shared_ptr<const PhotonMap>> maps;
    for (const auto& photons : file.photons) {
        maps.push_back(photons ? PhotonMap::build(photons, context.stop) : nullptr);
        if (photons && !maps.back()) return cancelled();
    }
    const auto area = SurfaceArea::build(*reach, context.stop);
    if (!area) return cancelled();
    const auto direct = photonMapField(lighting.params, lit.scene->bounds, area, maps, Mix{});
    lighting.field = direct;
    if (lighting.params.photonLookup == PhotonLookup::direct) return Done{};
    const auto cached = withCaches(*direct, std::move(file.caches), context.stop);
    if (!cached) return cached.error();
    lighting.field = *cached;
    return Done{};
}

Result<Done> readBaked(const Context& context, const LightingRequest& request, Lighting& lighting)
{
    Result<LitScene> lit = readLitScene(context, request.scene, request.options.isa);
    if (!lit) return lit.error();
    lighting.lit = *std::move(lit);
    Result<BakeFile> file = readBake(request.bakeFile, *lighting.lit.scene);
    if (!file) return file.error();
    lighting.method = file->info.method;
    lighting.field = file->octree;
    if (file->grid) lighting.field = file->grid;
    if (file->voxels) lighting.field = file->voxels;
    if (!request.method.empty() && request.method != methodName(lighting.method)) {
        return Error{Error::Kind::badInput, fmt::format("{} was made with {}, not {}", request.bakeFile,
                                                        methodName(lighting.method), request.method)};
    }
    const Result<BakeParams> params = shownWith(file->info.params, request.options, lighting.method);
    if (!params) return params.error();
    lighting.params = *params;
    if (lighting.method == Method::photonMap) return fromPhotons(context, *file, lighting);
    return Done{};
}

} // namespace

Result<LitScene> readLitScene(const Context& context, const std::string& path, Isa isa)
{
    Result<std::shared_ptr<const Scene>> scene = readScene(path, context.log, context.stop);
    if (!scene) return scene.error();
    Result<std::shared_ptr<const RayScene>> rays = RayScene::build(*scene, isa, context.stop);
    if (!rays) return rays.error();
    return LitScene{*scene, *rays, std::make_shared<LightSampler>(*rays), nullptr};
}

Result<Done> checkRequest(const LightingRequest& request)
{
    if (request.method.empty() && request.bakeFile.empty()) {
        return Error{Error::Kind::badInput,
                     "say with what: --method " + std::string(kMethodNames[0]) + ", for example"};
    }
    Result<Method> method = Method::lightOctree; // a finished bake's own values count
    if (!request.method.empty()) {
        method = methodNamed(request.method);
        if (!method) return method.error();
    }
    if (const Result<BakeParams> params = bakeParams(request.options, *method); !params) return params.error();
    const Result<Done> fine = checkBudget(request.options, request.method, request.bakeFile);
    if (!fine) return fine.error();
    if (request.cache.resume && request.method != methodName(Method::reference)) {
        return Error{Error::Kind::badInput, "--resume goes on with a reference: --method reference"};
    }
    if (request.cache.resume && !request.cache.isUsed) {
        return Error{Error::Kind::badInput, "--resume finds what was done in the cache; leave --no-cache out"};
    }
    return Done{};
}

namespace {

Result<Lighting> withShown(Lighting lighting)
{
    Result<std::shared_ptr<const IndirectField>> shown =
        shownField(lighting.field, lighting.params, lighting.lit.lights);
    if (!shown) return shown.error();
    lighting.shown = *std::move(shown);
    return lighting;
}

} // namespace

Result<Lighting> prepareLighting(const Context& context, const LightingRequest& request, double bakeShare)
{
    Lighting lighting;
    if (!request.bakeFile.empty()) {
        const Result<Done> read = readBaked(context, request, lighting);
        if (!read) return read.error();
        return withShown(std::move(lighting));
    }
    const Result<Method> method = methodNamed(request.method);
    if (!method) return method.error();
    const Result<BakeParams> params = bakeParams(request.options, *method);
    if (!params) return params.error();
    lighting.method = *method;
    lighting.params = *params;
    if (*method == Method::reference) makeRoomForTarget(lighting.params, request.options);
    if (solverFor(*method)) {
        const Result<Done> baked = bakeNow(context, request, bakeShare, lighting);
        if (!baked) return baked.error();
        return withShown(std::move(lighting));
    }
    Result<LitScene> lit = readLitScene(context, request.scene, request.options.isa);
    if (!lit) return lit.error();
    lighting.lit = *std::move(lit);
    return lighting;
}

BakeInfo bakeInfo(const Lighting& lighting)
{
    BakeInfo info;
    info.method = lighting.method;
    info.params = lighting.params;
    info.isa = std::string(lighting.lit.rays->isaName());
    info.sceneHash = sceneHash(*lighting.lit.scene);
    for (const LightGroup& group : lighting.lit.scene->groups) info.groups.push_back(group.id);
    info.program = LIGHTLOOM_VERSION;
    return info;
}

ReferenceStore storeOf(const Context& context, const std::string& scene, const CacheUse& cache)
{
    return cache.isUsed ? ReferenceStore(scene, context.log, cache.resume) : ReferenceStore();
}

int failUsage(const Error& error)
{
    logLine(LogLevel::error, error.message);
    return kUsage;
}

Result<Done> checkFits(double bytes, const std::string& what, const std::string& wayOut)
{
    const double have = machineMemoryBytes();
    if (bytes <= 0.9 * have) return Done{};
    return Error{Error::Kind::outOfMemory, fmt::format("{} needs about {:.1f} GiB, this machine has {:.1f}; {}", what,
                                                       bytes / (1 << 30), have / (1 << 30), wayOut)};
}

} // namespace lightloom::cli
