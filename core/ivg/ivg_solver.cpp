// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/ivg_solver.h"
#include "core/ivg/grid_advice.h"
#include "core/ivg/grid_batches.h"
#include "core/ivg/grid_deposit.h"
#include "core/ivg/grid_nest.h"
#include "core/ivg/grid_paths.h"
#include "core/ivg/grid_smooth.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_products.h"
#include <algorithm>
#include <bit>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr double kPlaceShare = 0.05;             ///< of a bake's time that the grid itself takes
constexpr double kNestShare = 0.4;               ///< of a bake's time that a finer grid inside takes
constexpr std::uint64_t kPilotPhotons = 1 << 17; ///< for a look at the noise
constexpr std::uint64_t kNoisePoints = 1000;
constexpr int kOuterLevel = 32; ///< of snapshots: above those of photons that are not all, by their logarithm

using Geometry = std::shared_ptr<const GridGeometry>;
using Layers = std::vector<std::shared_ptr<const GridLayer>>;

/// What a light group's layer was made from.
struct GridShot {
    PhotonPaths counts; ///< without photons
    std::uint64_t stored = 0, deposits = 0;

    void add(const SegmentBlock& block)
    {
        counts.shot += block.counts.shot;
        counts.rays += block.counts.rays;
        counts.caustic += block.counts.caustic;
        counts.cutOff += block.counts.cutOff;
        counts.ledger += block.counts.ledger;
        stored += block.stored;
    }
};

std::string latticeText(const GridLattice& l)
{
    return fmt::format("lattice {} {} {} / {} {} {} / {} {} {}\n", l.lowest.x, l.lowest.y, l.lowest.z, l.cellSize.x,
                       l.cellSize.y, l.cellSize.z, l.cells.x, l.cells.y, l.cells.z);
}

/// One light group on its way into a grid.
class GroupBake {
public:
    /// `surface` null: no fit.
    GroupBake(std::string key, std::unique_ptr<GridDeposit> deposit, std::unique_ptr<PathFeed> feed,
              const std::shared_ptr<const GridSurface>& surface, bool isSmooth, std::uint64_t photons, int group)
        : key_(std::move(key)), deposit_(std::move(deposit)), feed_(std::move(feed)), isSmooth_(isSmooth),
          photons_(photons), shot_(std::make_shared<GridShot>())
    {
        shot_->counts.group = group;
        if (surface) landed_ = std::make_unique<SurfaceLight>(surface);
    }
    [[nodiscard]] const std::string& key() const { return key_; }
    [[nodiscard]] const GridDeposit& deposit() const { return *deposit_; }
    [[nodiscard]] const PathFeed& feed() const { return *feed_; }

    /// False: stopped.
    bool advance(std::uint64_t first, std::uint64_t end, BakeControl& control)
    {
        const auto blocks = feed_->blocks(first, end, control, shooting_);
        if (blocks.size() != end - first) return false;
        const StageClock clock("deposit", control);
        const bool all = deposit_->add(blocks, control.workers(), control.stop()) &&
                         (!landed_ || landed_->add(blocks, control.workers(), control.stop()));
        const StageCost spent = clock.stop();
        depositing_.wallMs += spent.wallMs, depositing_.cpuMs += spent.cpuMs;
        for (const SegmentBlock* block : blocks) shot_->add(*block);
        return all;
    }
    /// The light of the photons so far.
    [[nodiscard]] std::shared_ptr<const GridLayer> layer(Workers& workers) const
    {
        const double scale =
            shot_->counts.shot == 0 ? 1.0 : static_cast<double>(photons_) / static_cast<double>(shot_->counts.shot);
        const auto made = std::make_shared<GridLayer>(deposit_->layer(shot_->counts.group, scale));
        const GridGeometry& geometry = *deposit_->geometry();
        if (isSmooth_) smoothVectors(geometry, deposit_->estimator(), *made, workers);
        if (!landed_) return made;
        // a grid of its own: what this lamp is corrected by does not depend on other lamps
        const auto alone = [&] { return IrradianceGrid(deposit_->geometry(), {made}, deposit_->estimator(), {}, {}); };
        SurfaceFit fit = fitToSurface(alone(), landed_->surface(), landed_->light(scale), workers);
        if (isSmooth_)
            smoothFit(geometry, deposit_->estimator(), fit, *made, workers);
        else
            made->onSurface = std::move(fit.correction);
        return made;
    }
    /// Hands the finished layer to `products`.
    std::shared_ptr<const GridLayer> finish(BakeProducts& products, BakeControl& control)
    {
        shot_->deposits = deposit_->deposits();
        products.keep<GridShot>(key_, shot_, shooting_);
        const StageClock clock("deposit", control);
        auto made = layer(control.workers());
        const StageCost spent = clock.stop();
        depositing_.wallMs += spent.wallMs, depositing_.cpuMs += spent.cpuMs;
        products.keep<GridLayer>(key_, made, depositing_);
        return made;
    }
    [[nodiscard]] const GridShot& shot() const { return *shot_; }

private:
    std::string key_;
    std::unique_ptr<GridDeposit> deposit_;
    std::unique_ptr<SurfaceLight> landed_; ///< null: no fit
    std::unique_ptr<PathFeed> feed_;
    bool isSmooth_;
    std::uint64_t photons_;
    std::shared_ptr<GridShot> shot_;
    StageCost shooting_{"shoot"}, depositing_{"deposit"};
};

/// Indirect segments per photon, over light groups.
struct SegmentCounts {
    double mean = 0.0, most = 0.0;
};

class GridBake {
public:
    /// `params` settled.
    GridBake(const BakeJob& job, BakeParams params, const SceneProducts& scene, SegmentCounts segments,
             BakeProducts& products, BakeControl& control)
        : job_(job), params_(std::move(params)), scene_(scene), segments_(segments), products_(products),
          control_(control)
    {
        for (int g = 0; g < groups(); ++g) on_ += isOff(job.mix, g) ? 0 : 1;
    }

    [[nodiscard]] Result<Geometry> outerGeometry()
    {
        return geometry(placeGrid(*scene_.rays,
                                  {params_.gridSize, {params_.gridSizeX, params_.gridSizeY, params_.gridSizeZ}},
                                  params_.gridShift));
    }
    [[nodiscard]] Result<Geometry> geometry(const GridLattice& lattice)
    {
        const std::string key = scene_.reachKey + latticeText(lattice);
        if (auto kept = products_.find<GridGeometry>(key)) return kept;
        const StageClock clock("grid", control_);
        const auto openness = findOpenness(*scene_.rays, *scene_.reach, lattice, control_.workers(), control_.stop());
        if (!openness) return cancelled();
        const auto made = std::make_shared<const GridGeometry>(GridGeometry{lattice, *openness});
        products_.keep<GridGeometry>(key, made, clock.stop());
        return made;
    }

    /// Null: light is not fitted to surface.
    [[nodiscard]] Result<std::shared_ptr<const GridSurface>> surface(const GridLattice& lattice)
    {
        std::shared_ptr<const GridSurface> made;
        if (!isFitted()) return made;
        const std::string key = scene_.reachKey + latticeText(lattice) + "surface\n";
        if (auto kept = products_.find<GridSurface>(key)) return kept;
        const StageClock clock("grid", control_);
        made = GridSurface::build(scene_.rays, *scene_.reach, lattice, control_.workers(), control_.stop());
        if (!made) return cancelled();
        products_.keep<GridSurface>(key, made, clock.stop());
        return made;
    }

    /// Layers of all lamps that are on; of lamps that are kept, those. Empty: stopped. Tells progress from `before` on,
    /// for `share` of the bake. `isOuter`: counts the work's photons, and publishes what there is meanwhile.
    [[nodiscard]] Layers layers(const Geometry& geometry, double before, double share, bool isOuter)
    {
        const auto surface = this->surface(geometry->lattice);
        if (!surface) return {};
        Layers layers(static_cast<std::size_t>(groups()));
        std::vector<GroupBake> missing;
        for (int g = 0; g < groups(); ++g) {
            if (isOff(job_.mix, g)) {
                products_.counters.groupsOff += isOuter ? 1 : 0;
                continue;
            }
            const std::string key = layerKey(g, geometry->lattice);
            const auto shot = products_.find<GridShot>(key);
            auto& layer = layers[static_cast<std::size_t>(g)];
            layer = products_.find<GridLayer>(key);
            if (!shot || !layer) {
                layer = nullptr;
                missing.push_back(started(g, key, geometry, *surface, missing));
                continue;
            }
            if (!isOuter) continue;
            products_.counters.photonsReused += shot->counts.shot;
            ++products_.counters.groupsReused;
            count(*shot);
        }
        if (!advance(missing, geometry, layers, before, share, isOuter)) return {};
        for (GroupBake& bake : missing) {
            layers[static_cast<std::size_t>(bake.shot().counts.group)] = bake.finish(products_, control_);
            const PathFeed& feed = bake.feed();
            products_.counters.photonsShot += feed.photonsTraced();
            products_.counters.raysTraced += feed.raysTraced();
            if (!isOuter) continue;
            products_.counters.photonsReused += feed.photonsKept();
            count(bake.shot());
        }
        return layers;
    }

    [[nodiscard]] std::shared_ptr<const IrradianceGrid> field(const Geometry& geometry, Layers layers) const
    {
        return std::make_shared<const IrradianceGrid>(geometry, std::move(layers), params_.gridEstimator, job_.mix,
                                                      gridShow(params_));
    }

    /// The box of the finer grid; none: nothing bends.
    [[nodiscard]] std::optional<Bounds> nestBox(const IrradianceGrid& outer) const
    {
        if (params_.gridNest == GridNest::automatic) return chooseNest(outer, params_.gridNestFine);
        const Scene& scene = *job_.scene;
        const GridLattice& lattice = outer.geometry().lattice;
        const glm::dvec3 low(params_.gridNestLowX, params_.gridNestLowY, params_.gridNestLowZ);
        const glm::dvec3 high(params_.gridNestHighX, params_.gridNestHighY, params_.gridNestHighZ);
        const glm::vec3 end = lattice.position(lattice.cells);
        const Bounds box{glm::clamp(glm::vec3(low - scene.origin), lattice.lowest, end),
                         glm::clamp(glm::vec3(high - scene.origin), lattice.lowest, end)};
        return glm::all(glm::lessThan(box.low, box.high)) ? std::optional(box) : std::nullopt;
    }

    [[nodiscard]] GridMemoryJob memoryJob() const
    {
        return {on_,
                static_cast<std::uint64_t>(params_.photonCount),
                segments_.mean,
                segments_.most,
                mostPathBytes(),
                params_.gridEstimator,
                params_.gridRemap,
                isFitted() ? scene_.reach->area() : 0.0,
                isSmooth(),
                job_.roughFirst};
    }
    [[nodiscard]] int groups() const { return static_cast<int>(job_.scene->groups.size()); }

private:
    /// The printed sums are meant to be as printed: surface would lighten them.
    [[nodiscard]] bool isFitted() const
    {
        return params_.gridFit == Switch::on && params_.gridEstimator != GridEstimator::paper;
    }
    [[nodiscard]] bool isSmooth() const
    {
        return params_.gridSmooth == Switch::on && params_.gridEstimator != GridEstimator::paper;
    }
    [[nodiscard]] double mostPathBytes() const { return params_.gridPathMemory * 1048576.0; }
    [[nodiscard]] std::uint64_t photonsOf(int group) const
    {
        const bool isDark = scene_.lights->groupFlux(group) == glm::vec3(0.0f);
        return isDark ? 0 : static_cast<std::uint64_t>(params_.photonCount);
    }
    [[nodiscard]] std::string photonKey() const { return stageKey(params_, Stage::shoot, Method::irradianceGrid); }
    [[nodiscard]] std::string layerKey(int group, const GridLattice& lattice) const
    {
        return scene_.layerKey(static_cast<std::size_t>(group)) + photonKey() + latticeText(lattice) +
               std::string(kGridEstimatorNames[static_cast<std::size_t>(params_.gridEstimator)]) +
               (isFitted() ? " fit" : "") + (isSmooth() ? " smooth" : "");
    }
    [[nodiscard]] GroupBake started(int group, const std::string& key, const Geometry& geometry,
                                    const std::shared_ptr<const GridSurface>& surface,
                                    const std::vector<GroupBake>& others)
    {
        auto deposit = others.empty() ? std::make_unique<GridDeposit>(geometry, params_.gridEstimator)
                                      : others.front().deposit().another();
        const PhotonJob photons{group, params_.seed, photonsOf(group), params_.pathDepth};
        auto feed =
            std::make_unique<PathFeed>(scene_, photons, scene_.lampKey(static_cast<std::size_t>(group)) + photonKey(),
                                       mostPathBytes() / std::max(on_, 1), segments_.most, blocks_, products_);
        return {key, std::move(deposit), std::move(feed), surface, isSmooth(), photons.count, group};
    }
    /// Takes all photons to their end, lamps side by side. False: stopped.
    bool advance(std::vector<GroupBake>& missing, const Geometry& geometry, const Layers& kept, double before,
                 double share, bool isOuter)
    {
        std::uint64_t all = 0;
        for (const GroupBake& bake : missing) all = std::max(all, segmentBlocks(photonsOf(bake.shot().counts.group)));
        for (std::uint64_t first = 0; first < all;) {
            const std::uint64_t end = gridBatchEnd(first, all);
            for (GroupBake& bake : missing) {
                control_.waitWhilePaused();
                if (photonsOf(bake.shot().counts.group) > 0 && !bake.advance(first, end, control_)) return false;
            }
            first = end;
            control_.progress(Stage::shoot, before + share * static_cast<double>(end) / static_cast<double>(all));
            if (!isOuter || !job_.roughFirst || end == all || !isGridMilestone(end)) continue;
            Layers soFar = kept;
            for (const GroupBake& bake : missing)
                soFar[static_cast<std::size_t>(bake.shot().counts.group)] = bake.layer(control_.workers());
            control_.publish(field(geometry, std::move(soFar)), std::countr_zero(end), false, true);
        }
        return true;
    }
    void count(const GridShot& shot)
    {
        WorkCounters& counters = products_.counters;
        counters.causticPhotons += shot.counts.caustic;
        counters.pathsCutOff += shot.counts.cutOff;
        counters.ledger += shot.counts.ledger;
        counters.photonsStored += shot.stored;
        counters.deposits += shot.deposits;
        ++counters.groupsBaked;
    }

    const BakeJob& job_;
    BakeParams params_;
    const SceneProducts& scene_;
    SegmentCounts segments_;
    BakeProducts& products_;
    BakeControl& control_;
    std::vector<SegmentBlock> blocks_; ///< of a batch
    int on_ = 0;                       ///< light groups that are
};

/// How many indirect segments photons have, over the first block of every light group. Nothing: stopped.
std::optional<SegmentCounts> countSegments(const BakeJob& job, const SceneProducts& scene, BakeControl& control)
{
    SegmentCounts counts;
    int groups = 0;
    for (int g = 0; g < static_cast<int>(job.scene->groups.size()); ++g) {
        if (isOff(job.mix, g) || scene.lights->groupFlux(g) == glm::vec3(0.0f)) continue;
        std::vector<SegmentBlock> block(1);
        const PhotonJob look{g, job.params.seed, kSegmentBlock, job.params.pathDepth};
        if (!traceSegments(*scene.rays, *scene.lights, look, 0, block, control.workers(), control.stop())) return {};
        const double each = static_cast<double>(block[0].segments.size()) / static_cast<double>(kSegmentBlock);
        counts.mean += each;
        counts.most = std::max(counts.most, each);
        ++groups;
    }
    counts.mean /= std::max(groups, 1);
    return counts;
}

std::string sceneKeyOf(const SceneProducts& scene, const BakeJob& job)
{
    std::string key = scene.reachKey + scene.sceneKey + "mix";
    for (int g = 0; g < static_cast<int>(job.scene->groups.size()); ++g) key += isOff(job.mix, g) ? '0' : '1';
    return key + "\n";
}

} // namespace

GridShow gridShow(const BakeParams& params) { return {params.gridRemap, params.gridFilter, params.gridOffset}; }

Result<BakeParams> settledGridParams(const BakeJob& job, const SceneProducts& scene, BakeProducts& products,
                                     BakeControl& control)
{
    if (job.params.gridSize != 0 && job.params.gridNoise == 0.0f) return job.params;
    const std::string key = sceneKeyOf(scene, job) + stageKey(job.params, Stage::fit, Method::irradianceGrid);
    if (const auto kept = products.find<BakeParams>(key)) {
        BakeParams settled = job.params;
        settled.gridSize = kept->gridSize, settled.photonCount = kept->photonCount, settled.gridNoise = 0.0f;
        return settled;
    }
    const StageClock clock("advice", control);
    BakeParams settled = job.params;
    settled.gridNoise = 0.0f;
    if (settled.gridSize == 0) {
        const GridMemoryJob memory = GridBake(job, settled, scene, {}, products, control).memoryJob();
        settled.gridSize = adviseGridSize(scene, memory, settled.gridShift).size;
    }
    if (job.params.gridNoise > 0.0f) {
        BakeParams few = settled;
        few.photonCount = static_cast<int>(kPilotPhotons);
        BakeProducts apart; // nothing of it is part of the bake
        const auto pilotOf = [&](Switch smooth) -> std::shared_ptr<const IrradianceGrid> {
            few.gridSmooth = smooth;
            GridBake pilot(job, few, scene, {}, apart, control);
            const Result<Geometry> geometry = pilot.outerGeometry();
            if (!geometry) return nullptr;
            Layers layers = pilot.layers(*geometry, 0.0, 0.01, false);
            return control.isStopped() ? nullptr : pilot.field(*geometry, std::move(layers));
        };
        const auto smoothed = pilotOf(settled.gridSmooth), raw = pilotOf(Switch::off);
        if (!smoothed || !raw) return cancelled();
        const auto points = samplePoints(*scene.rays, *scene.lights, *scene.reach, kNoisePoints, 1);
        settled.photonCount = static_cast<int>(
            photonsForNoise(*raw, *smoothed, kPilotPhotons, points, static_cast<double>(job.params.gridNoise)));
    }
    products.keep<BakeParams>(key, std::make_shared<const BakeParams>(settled), clock.stop());
    return settled;
}

Result<Done> IvgSolver::bake(const BakeJob& job, BakeProducts& products, BakeControl& control)
{
    if (const Result<Done> checked = checkTogether(job.params); !checked) return checked;
    control.progress(Stage::shoot, 0.0);
    const Result<SceneProducts> scene = sceneProducts(job, products, control);
    if (!scene) return scene.error();
    const Result<BakeParams> params = settledGridParams(job, *scene, products, control);
    if (!params) return params.error();
    const std::optional<SegmentCounts> segments = countSegments(job, *scene, control);
    if (!segments) return cancelled();
    GridBake bake(job, *params, *scene, *segments, products, control);
    const GridLattice lattice = placeGrid(
        *scene->rays, {params->gridSize, {params->gridSizeX, params->gridSizeY, params->gridSizeZ}}, params->gridShift);
    if (const Result<Done> fits = checkGridFits(lattice, bake.memoryJob()); !fits) return fits.error();
    const GridMemory memory = gridMemory(lattice, bake.memoryJob());
    products.counters.keptBytes = memory.kept, products.counters.mostBytes = memory.most;

    const Result<Geometry> geometry = bake.geometry(lattice);
    if (!geometry) return geometry.error();
    WorkCounters& counters = products.counters;
    counters.photonsPerGroup = static_cast<std::uint64_t>(params->photonCount);
    counters.vertices = static_cast<std::uint64_t>(std::ranges::count((*geometry)->openness.isOpen, std::uint8_t{1}));
    const bool isNested = params->gridNest != GridNest::off;
    const double share = 1.0 - kPlaceShare - (isNested ? kNestShare : 0.0);
    Layers layers = bake.layers(*geometry, kPlaceShare, share, true);
    if (control.isStopped()) return cancelled();
    std::shared_ptr<const IrradianceGrid> field = bake.field(*geometry, std::move(layers));
    const std::optional<Bounds> box = isNested ? bake.nestBox(*field) : std::nullopt;
    if (box) {
        if (job.roughFirst) control.publish(field, kOuterLevel, false);
        const GridLattice finer = nestLattice(*scene->rays, lattice, *box, params->gridNestFine);
        if (const Result<Done> fits = checkGridFits(finer, bake.memoryJob()); !fits) return fits.error();
        const Result<Geometry> inside = bake.geometry(finer);
        if (!inside) return inside.error();
        Layers more = bake.layers(*inside, 1.0 - kNestShare, kNestShare, false);
        if (control.isStopped()) return cancelled();
        counters.vertices +=
            static_cast<std::uint64_t>(std::ranges::count((*inside)->openness.isOpen, std::uint8_t{1}));
        field = field->withInside(joinNest(bake.field(*inside, std::move(more)), job.scene->bounds, lattice, *box));
    }
    control.progress(Stage::fit, 1.0);
    control.publish(std::move(field), kOuterLevel + 1, true);
    return Done{};
}

} // namespace lightloom
