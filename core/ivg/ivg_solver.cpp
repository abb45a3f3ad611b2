// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/ivg_solver.h"
#include "core/base/memory_use.h"
#include "core/ivg/grid_deposit.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_products.h"
#include <algorithm>
#include <fmt/format.h>

namespace lightloom {
namespace {

/// Blocks of photons that are traced, then summed. Part of the result's definition: sums of a batch are in float.
constexpr std::uint64_t kBatch = 128;
constexpr double kPlaceShare = 0.05; ///< of a bake's time that the grid itself takes

/// What a light group's layer was made from.
struct GridShot {
    PhotonPaths counts; ///< without photons
    std::uint64_t stored = 0, deposits = 0;
};

class GridBake {
public:
    GridBake(const BakeJob& job, const SceneProducts& scene, BakeProducts& products, BakeControl& control)
        : job_(job), scene_(scene), products_(products), control_(control)
    {
    }

    [[nodiscard]] Result<std::shared_ptr<const GridGeometry>> geometry()
    {
        const BakeParams& p = job_.params;
        const std::string key = fmt::format("{}grid {} {} {} {} shift{}", scene_.reachKey, p.gridSize, p.gridSizeX,
                                            p.gridSizeY, p.gridSizeZ, p.gridShift);
        if (auto kept = products_.find<GridGeometry>(key)) return kept;
        const StageClock clock("grid", control_);
        const GridLattice lattice =
            placeGrid(*scene_.rays, {p.gridSize, {p.gridSizeX, p.gridSizeY, p.gridSizeZ}}, p.gridShift);
        if (const Result<Done> fits = checkGridFits(lattice, static_cast<int>(job_.scene->groups.size())); !fits)
            return fits.error();
        const auto openness = findOpenness(*scene_.rays, *scene_.reach, lattice, control_.workers(), control_.stop());
        if (!openness) return cancelled();
        const auto made = std::make_shared<const GridGeometry>(GridGeometry{lattice, *openness});
        products_.keep<GridGeometry>(key, made, clock.stop());
        return made;
    }

    /// Null: stopped. Tells progress from `before` on, for `share` of the bake.
    [[nodiscard]] std::shared_ptr<const GridLayer> layer(const std::shared_ptr<const GridGeometry>& geometry, int group,
                                                         double before, double share)
    {
        const std::string key = scene_.layerKey(static_cast<std::size_t>(group)) +
                                stageKey(job_.params, Stage::fit, Method::irradianceGrid);
        const auto shot = products_.find<GridShot>(key);
        auto layer = products_.find<GridLayer>(key);
        if (shot && layer) {
            products_.counters.photonsReused += shot->counts.shot;
            ++products_.counters.groupsReused;
            count(*shot);
            return layer;
        }
        StageCost shooting{"shoot"}, depositing{"deposit"};
        const auto made = std::make_shared<GridShot>();
        GridDeposit deposit(geometry, job_.params.gridEstimator);
        const PhotonJob photons{group, job_.params.seed, photonsOf(group), job_.params.pathDepth};
        const std::uint64_t all = segmentBlocks(photons.count);
        for (std::uint64_t first = 0; first < all; first += kBatch) {
            control_.waitWhilePaused();
            std::vector<SegmentBlock>& blocks = blocks_;
            blocks.resize(std::min(kBatch, all - first));
            if (!shootBatch(photons, first, blocks, shooting) || !depositBatch(deposit, blocks, depositing))
                return nullptr;
            for (const SegmentBlock& block : blocks) add(block, *made);
            const double done = static_cast<double>(first + blocks.size()) / static_cast<double>(all);
            control_.progress(Stage::shoot, before + share * done);
        }
        made->counts.group = group;
        made->deposits = deposit.deposits();
        products_.counters.photonsShot += made->counts.shot;
        products_.counters.raysTraced += made->counts.rays;
        count(*made);
        products_.keep<GridShot>(key, made, shooting);
        const StageClock clock("deposit", control_);
        layer = std::make_shared<const GridLayer>(deposit.layer(group));
        addTo(depositing, clock.stop());
        products_.keep<GridLayer>(key, layer, depositing);
        return layer;
    }

private:
    [[nodiscard]] std::uint64_t photonsOf(int group) const
    {
        const bool isDark = scene_.lights->groupFlux(group) == glm::vec3(0.0f);
        return isDark ? 0 : static_cast<std::uint64_t>(job_.params.photonCount);
    }
    static void addTo(StageCost& sum, const StageCost& cost)
    {
        sum.wallMs += cost.wallMs;
        sum.cpuMs += cost.cpuMs;
    }
    bool shootBatch(const PhotonJob& photons, std::uint64_t first, std::span<SegmentBlock> blocks, StageCost& cost)
    {
        const StageClock clock("shoot", control_);
        const bool all =
            traceSegments(*scene_.rays, *scene_.lights, photons, first, blocks, control_.workers(), control_.stop());
        addTo(cost, clock.stop());
        return all;
    }
    bool depositBatch(GridDeposit& deposit, std::span<const SegmentBlock> blocks, StageCost& cost)
    {
        const StageClock clock("deposit", control_);
        const bool all = deposit.add(blocks, control_.workers(), control_.stop());
        addTo(cost, clock.stop());
        return all;
    }
    static void add(const SegmentBlock& block, GridShot& sum)
    {
        sum.counts.shot += block.counts.shot;
        sum.counts.rays += block.counts.rays;
        sum.counts.caustic += block.counts.caustic;
        sum.counts.cutOff += block.counts.cutOff;
        sum.counts.ledger += block.counts.ledger;
        sum.stored += block.stored;
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
    const SceneProducts& scene_;
    BakeProducts& products_;
    BakeControl& control_;
    std::vector<SegmentBlock> blocks_; // of a batch
};

} // namespace

GridShow gridShow(const BakeParams& params) { return {params.gridRemap, params.gridFilter, params.gridOffset}; }

Result<Done> checkGridFits(const GridLattice& lattice, int groups)
{
    const auto vertices = static_cast<double>(lattice.cells.x + 1) * (lattice.cells.y + 1) * (lattice.cells.z + 1);
    const double kept = vertices * (sizeof(IrradianceVectors) + sizeof(std::array<float, 6>)) * groups;
    const double wanted = kept + GridDeposit::bytesFor(lattice) + vertices * 300.0, have = 0.9 * machineMemoryBytes();
    if (wanted <= have && vertices < 2e9) return Done{};
    return Error{
        Error::Kind::outOfMemory,
        fmt::format("a grid of {} x {} x {} cells for {} light groups needs about {:.1f} GiB, this machine has "
                    "{:.1f}; lower grid.size",
                    lattice.cells.x, lattice.cells.y, lattice.cells.z, groups, wanted / (1 << 30), have / (1 << 30))};
}

Result<Done> IvgSolver::bake(const BakeJob& job, BakeProducts& products, BakeControl& control)
{
    control.progress(Stage::shoot, 0.0);
    const Result<SceneProducts> scene = sceneProducts(job, products, control);
    if (!scene) return scene.error();
    GridBake bake(job, *scene, products, control);
    const Result<std::shared_ptr<const GridGeometry>> geometry = bake.geometry();
    if (!geometry) return geometry.error();
    products.counters.vertices =
        static_cast<std::uint64_t>(std::ranges::count((*geometry)->openness.isOpen, std::uint8_t{1}));
    const int groups = static_cast<int>(job.scene->groups.size());
    std::vector<std::shared_ptr<const GridLayer>> layers(static_cast<std::size_t>(groups));
    int on = 0, done = 0;
    for (int g = 0; g < groups; ++g) on += isOff(job.mix, g) ? 0 : 1;
    for (int g = 0; g < groups; ++g) {
        if (isOff(job.mix, g)) {
            ++products.counters.groupsOff;
            continue;
        }
        const double share = (1.0 - kPlaceShare) / on;
        auto& layer = layers[static_cast<std::size_t>(g)];
        layer = bake.layer(*geometry, g, kPlaceShare + share * done++, share);
        if (!layer) return cancelled();
    }
    auto field = std::make_shared<IrradianceGrid>(*geometry, std::move(layers), job.params.gridEstimator, job.mix,
                                                  gridShow(job.params));
    control.progress(Stage::fit, 1.0);
    control.publish(std::move(field), 0, true);
    return Done{};
}

} // namespace lightloom
