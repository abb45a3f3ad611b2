// SPDX-License-Identifier: Apache-2.0
#include "core/octree/octree_solver.h"
#include "core/octree/detail_fit.h"
#include "core/octree/detail_union.h"
#include "core/octree/entry_screens.h"
#include "core/octree/layer_fit.h"
#include "core/octree/octree_build.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_products.h"
#include <atomic>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr double kDetailShare = 0.3; ///< of the time of the last depth that its deeper leaves take
constexpr double kPhotonShare = 0.4; ///< of a bake's time; the rest goes by the number of cells of each depth

std::string layerKey(const BakeJob& job, const SceneProducts& scene, std::size_t group, int depth)
{
    BakeParams atDepth = job.params; // a layer of one depth does not depend on what other depths are shown
    atDepth.octreeDepth = atDepth.octreeFirstDepth = depth;
    atDepth.octreeDetail = 0; // nor on the leaves below it
    return scene.layerKey(group) + stageKey(atDepth, Stage::fit, Method::lightOctree);
}

class OctreeBake {
public:
    using Layers = std::vector<std::shared_ptr<const VdlLayer>>;
    /// `finished`: layers of the first depth, by light group, for a rough picture. Given at all: the picture is rough.
    OctreeBake(const BakeJob& job, BakeProducts& products, BakeControl& control, const PhotonProducts& photons,
               std::optional<Layers> finished = {})
        : job_(job), products_(products), control_(control), photons_(photons), isRough_(finished.has_value()),
          finished_(std::move(finished).value_or(Layers(photons.maps.size())))
    {
        for (int d = job.params.octreeFirstDepth; d <= job.params.octreeDepth; ++d) allCells_ += cellsOf(d);
        if (job.params.octreeDetail > 0) allCells_ += kDetailShare * cellsOf(job.params.octreeDepth);
    }

    Result<Done> depth(int d)
    {
        const auto geometry = octreeGeometry(job_, photons_, d, products_, control_);
        if (!geometry) return cancelled();
        products_.counters.leaves = geometry->cells.size();
        products_.counters.entries = geometry->entries.size();
        Layers layers = finished_;
        for (std::size_t g = 0; g < layers.size(); ++g) {
            if (!photons_.maps[g]) continue;
            layers[g] = layerOf(*geometry, g);
            if (!layers[g]) return cancelled();
            told_ += cellsOf(d) / static_cast<double>(layers.size());
        }
        const bool isFinal = d == job_.params.octreeDepth && !isRough_;
        std::vector<std::shared_ptr<const LampDetail>> details;
        if (isFinal && job_.params.octreeDetail > 0) {
            details.resize(layers.size());
            for (std::size_t g = 0; g < layers.size(); ++g) {
                if (!layers[g]) continue;
                details[g] = detailOf(*geometry, *layers[g], g);
                if (!details[g]) return cancelled();
                told_ += kDetailShare * cellsOf(d) / static_cast<double>(layers.size());
                control_.progress(Stage::fit, kPhotonShare + (1.0 - kPhotonShare) * told_ / allCells_);
            }
        }
        if (isFinal) control_.progress(Stage::fit, 1.0);
        auto octree = std::make_shared<LightOctree>(geometry, std::move(layers), job_.params.vdlForm, job_.mix,
                                                    OctreeShow::lights, std::move(details));
        for (const UnionLevel& level : octree->deeper()) {
            products_.counters.leaves += level.geometry.cells.size();
            products_.counters.entries += level.geometry.entries.size();
        }
        control_.publish(std::move(octree), d, isFinal, isRough_);
        return Done{};
    }

private:
    static double cellsOf(int d) { return static_cast<double>(1u << (2 * std::min(d, 12))); } // surfaces: 4 per level

    std::shared_ptr<const VdlLayer> layerOf(const OctreeGeometry& geometry, std::size_t g)
    {
        const std::string key = layerKey(job_, photons_.scene, g, geometry.depth);
        if (auto kept = products_.find<VdlLayer>(key)) return kept;
        const StageClock clock(fmt::format("gather d{}", geometry.depth), control_);
        const auto layer = emptyLayer(geometry, static_cast<int>(g), job_.params);
        if (!fitAll(geometry, *photons_.maps[g], *layer)) return nullptr;
        dropUnused(*layer);
        products_.keep<VdlLayer>(key, layer, clock.stop());
        return layer;
    }

    std::shared_ptr<const LampDetail> detailOf(const OctreeGeometry& geometry, const VdlLayer& layer, std::size_t g)
    {
        BakeParams direct = job_.params;
        direct.octreeFirstDepth = direct.octreeDepth;
        const std::string key = photons_.scene.layerKey(g) + stageKey(direct, Stage::fit, Method::lightOctree);
        if (auto kept = products_.find<LampDetail>(key)) return kept;
        const StageClock clock("detail", control_);
        const ScreenFinder finder(*photons_.scene.rays, *photons_.scene.reach, *photons_.area);
        const DetailJob job{geometry,       layer,      *photons_.scene.reach, finder, *photons_.maps[g],
                            *photons_.area, job_.params};
        const DetailResult made = fitDetail(job, control_);
        if (!made.detail) return nullptr;
        products_.counters.gathers += made.fits;
        products_.counters.clusterings += made.fits;
        products_.counters.degenerateEntries += made.degenerate;
        products_.keep<LampDetail>(key, made.detail, clock.stop());
        return made.detail;
    }

    bool fitAll(const OctreeGeometry& geometry, const PhotonMap& map, VdlLayer& layer)
    {
        constexpr std::size_t kBlock = 64;
        const std::size_t count = geometry.entries.size(), blocks = (count + kBlock - 1) / kBlock;
        LayerFit fit(geometry, map, *photons_.area, job_.params, layer);
        std::atomic<std::uint64_t> degenerate = 0, done = 0;
        const double share = cellsOf(geometry.depth) / static_cast<double>(photons_.maps.size());
        const bool all = control_.forBlocks(blocks, [&](std::size_t block) {
            thread_local FitScratch scratch;
            for (std::size_t e = block * kBlock; e < std::min(count, (block + 1) * kBlock); ++e) {
                if (control_.isStopped()) return;
                if (fit.fit(static_cast<std::uint32_t>(e), scratch)) ++degenerate;
            }
            const double part = static_cast<double>(++done) / static_cast<double>(blocks);
            if (isRough_) return;
            control_.progress(Stage::fit, kPhotonShare + (1.0 - kPhotonShare) * (told_ + share * part) / allCells_);
        });
        products_.counters.gathers += count;
        products_.counters.clusterings += count;
        products_.counters.degenerateEntries += degenerate;
        return all;
    }

    const BakeJob& job_;
    BakeProducts& products_;
    BakeControl& control_;
    const PhotonProducts& photons_;
    bool isRough_;    // a picture before the bake proper: never final, and no part of its progress
    Layers finished_; // of groups whose layer is not made here
    double allCells_ = 0.0, told_ = 0.0;
};

/// The first depth from a sixteenth of the photons, for whoever waits for a picture; lamps whose layer is there from an
/// earlier bake keep it. The bake proper does not depend on it; the photons are the first of the same streams.
Result<Done> showRough(const BakeJob& job, BakeProducts& products, BakeControl& control)
{
    BakeJob rough = job;
    const BakeParams few = roughParams(job.params);
    rough.params.photonCount = few.photonCount;
    rough.params.gatherCount = few.gatherCount;
    if (rough.params.photonCount > job.params.photonCount / 4) return Done{}; // the bake proper is as quick
    const Result<SceneProducts> scene = sceneProducts(job, products, control, ReachWanted::quick);
    if (!scene) return scene.error();
    std::size_t missing = 0;
    OctreeBake::Layers finished(job.scene->groups.size());
    for (std::size_t g = 0; g < finished.size(); ++g) {
        if (isOff(job.mix, static_cast<int>(g))) continue;
        finished[g] = products.find<VdlLayer>(layerKey(job, *scene, g, job.params.octreeFirstDepth));
        missing += finished[g] ? 0 : 1;
        if (!finished[g]) continue;
        rough.mix.resize(finished.size(), glm::vec3(1.0f));
        rough.mix[g] = glm::vec3(0.0f); // nothing to shoot
    }
    if (missing == 0) return Done{};
    const Result<PhotonProducts> photons = photonProducts(rough, products, control, 0.02, ReachWanted::quick);
    if (!photons) return photons.error();
    rough.mix = job.mix;
    const Result<Done> shown =
        OctreeBake(rough, products, control, *photons, std::move(finished)).depth(job.params.octreeFirstDepth);
    // what was traced for it counts as work; what it holds is not part of the result
    WorkCounters& counters = products.counters;
    WorkCounters work;
    work.photonsShot = counters.photonsShot, work.raysTraced = counters.raysTraced;
    work.photonsReused = counters.photonsReused, work.stages = counters.stages;
    counters = work;
    return shown;
}

} // namespace

BakeParams roughParams(BakeParams params)
{
    params.photonCount = std::max(10'000, params.photonCount / 16);
    params.gatherCount = std::max(20, params.gatherCount / 4); // as wide a kernel within a factor of two
    params.octreeDepth = params.octreeFirstDepth;
    params.octreeDetail = 0;
    return params;
}

std::shared_ptr<const OctreeGeometry> octreeGeometry(const BakeJob& job, const PhotonProducts& at, int depth,
                                                     BakeProducts& products, BakeControl& control)
{
    const bool isScreened = job.params.gatherScreens == Switch::on;
    const std::string key =
        fmt::format("{}d{} shift{}{}", at.scene.reachKey, depth, job.params.gridShift, isScreened ? " screens" : "");
    if (auto kept = products.find<OctreeGeometry>(key)) return kept;
    const StageClock clock(fmt::format("octree d{}", depth), control);
    const LightReach& reach = *at.scene.reach;
    const auto geometry =
        buildOctree(job.scene->bounds, reach, depth, job.params.gridShift, control.workers(), control.stop());
    if (!geometry) return nullptr;
    if (isScreened) {
        const ScreenFinder finder(*at.scene.rays, reach, *at.area);
        if (!findScreens(*geometry, finder, control.workers(), control.stop())) return nullptr;
    }
    products.keep<OctreeGeometry>(key, geometry, clock.stop());
    return geometry;
}

Result<Done> OctreeSolver::bake(const BakeJob& job, BakeProducts& products, BakeControl& control)
{
    if (const Result<Done> checked = checkTogether(job.params); !checked) return checked;
    if (job.roughFirst) {
        if (const Result<Done> shown = showRough(job, products, control); !shown) return shown;
    }
    const Result<PhotonProducts> photons = photonProducts(job, products, control, kPhotonShare);
    if (!photons) return photons.error();
    OctreeBake bake(job, products, control, *photons);
    for (int d = job.params.octreeFirstDepth; d <= job.params.octreeDepth; ++d) {
        if (const Result<Done> done = bake.depth(d); !done) return done;
    }
    return Done{};
}

} // namespace lightloom
