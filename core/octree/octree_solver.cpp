// SPDX-License-Identifier: Apache-2.0
#include "core/octree/octree_solver.h"
#include "core/base/units.h"
#include "core/octree/octree_build.h"
#include "core/octree/vdl_cluster.h"
#include "core/params/param_text.h"
#include "core/photonmap/density.h"
#include "core/photonmap/photon_products.h"
#include <atomic>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr double kPhotonShare = 0.4; ///< of a bake's time; the rest goes by the number of cells of each depth

/// What one thread needs to fit entries.
struct FitScratch {
    Gathered gathered;
    ClusterScratch clusters;
    std::vector<LightVector> lights;
};

/// Gathers and clusters the entries of one layer.
class LayerFit {
public:
    LayerFit(const OctreeGeometry& geometry, const PhotonMap& map, const SurfaceArea& area, const BakeParams& params,
             VdlLayer& layer)
        : geometry_(geometry), map_(map), area_(area), form_(params.vdlForm), layer_(layer),
          kernel_(DensityKernel::of(params, map, area, geometry.cellSize()))
    {
    }

    /// True if the entry's kernel had no area worth the name.
    bool fit(std::uint32_t e, FitScratch& s)
    {
        const OctreeEntry& entry = geometry_.entries[e];
        const Density density = estimateDensity(map_, area_, kernel_, entry.centroid, entry.normal, s.gathered);
        s.lights.clear();
        glm::dvec3 scalar(0.0);
        double squares = 0.0;
        for (const std::uint32_t number : s.gathered.photons) {
            const Photon& photon = map_.photon(number);
            const glm::vec3 lux = photon.flux * static_cast<float>(density.perFlux);
            scalar += glm::dvec3(lux);
            squares += static_cast<double>(luminance(lux)) * static_cast<double>(luminance(lux));
            // a photon's density already holds the cosine at its own surface (METHODS section 3): divide it out, except
            // in the form as printed
            const float cosine = glm::max(glm::dot(photon.normal, photon.toLight), kLeastCosine);
            const glm::vec3 colour = form_ == VdlForm::corrected ? lux / cosine : lux;
            s.lights.push_back({photon.toLight, colour, luminance(photon.flux)});
        }
        const auto count = static_cast<std::size_t>(layer_.count);
        fitVdls(s.lights, entry.normal, form_, std::span(layer_.vdls).subspan(e * count, count), s.clusters);
        layer_.scalar[e] = glm::vec3(scalar);
        layer_.noise[e] = static_cast<float>(std::sqrt(squares)); // photons arrive independently, like rain
        return density.isDegenerate;
    }

private:
    const OctreeGeometry& geometry_;
    const PhotonMap& map_;
    const SurfaceArea& area_;
    VdlForm form_;
    VdlLayer& layer_;
    DensityKernel kernel_;
};

class OctreeBake {
public:
    OctreeBake(const BakeJob& job, BakeProducts& products, BakeControl& control, const PhotonProducts& photons,
               bool isRough = false)
        : job_(job), products_(products), control_(control), photons_(photons), isRough_(isRough)
    {
        for (int d = job.params.octreeFirstDepth; d <= job.params.octreeDepth; ++d) allCells_ += cellsOf(d);
    }

    Result<Done> depth(int d)
    {
        const auto geometry = geometryOf(d);
        if (!geometry) return cancelled();
        products_.counters.leaves = geometry->cells.size();
        products_.counters.entries = geometry->entries.size();
        std::vector<std::shared_ptr<const VdlLayer>> layers(photons_.maps.size());
        for (std::size_t g = 0; g < layers.size(); ++g) {
            if (!photons_.maps[g]) continue;
            layers[g] = layerOf(*geometry, g);
            if (!layers[g]) return cancelled();
            told_ += cellsOf(d) / static_cast<double>(layers.size());
        }
        const bool isFinal = d == job_.params.octreeDepth && !isRough_;
        if (isFinal) control_.progress(Stage::fit, 1.0);
        control_.publish(std::make_shared<LightOctree>(geometry, std::move(layers), job_.params.vdlForm, job_.mix), d,
                         isFinal, isRough_);
        return Done{};
    }

private:
    static double cellsOf(int d) { return static_cast<double>(1u << (2 * std::min(d, 12))); } // surfaces: 4 per level

    std::shared_ptr<const OctreeGeometry> geometryOf(int d)
    {
        const std::string key = fmt::format("{}d{} shift{}", photons_.scene.key, d, job_.params.gridShift);
        auto geometry = products_.find<OctreeGeometry>(key);
        if (geometry) return geometry;
        const StageClock clock(fmt::format("octree d{}", d), control_);
        geometry = buildOctree(job_.scene->bounds, *photons_.scene.reach, d, job_.params.gridShift, control_.workers(),
                               control_.stop());
        if (geometry) products_.keep(key, geometry, clock.stop());
        return geometry;
    }

    std::shared_ptr<const VdlLayer> layerOf(const OctreeGeometry& geometry, std::size_t g)
    {
        BakeParams atDepth = job_.params; // a layer of one depth does not depend on what other depths are shown
        atDepth.octreeDepth = atDepth.octreeFirstDepth = geometry.depth;
        const std::string key =
            photons_.scene.key + job_.scene->groups[g].id + "\n" + stageKey(atDepth, Stage::fit, Method::lightOctree);
        if (auto kept = products_.find<VdlLayer>(key)) return kept;
        const StageClock clock(fmt::format("gather d{}", geometry.depth), control_);
        auto layer = std::make_shared<VdlLayer>();
        layer->group = static_cast<int>(g);
        layer->count = job_.params.vdlCount;
        layer->vdls.resize(geometry.entries.size() * static_cast<std::size_t>(layer->count));
        layer->scalar.resize(geometry.entries.size());
        layer->noise.resize(geometry.entries.size());
        if (!fitAll(geometry, *photons_.maps[g], *layer)) return nullptr;
        products_.keep<VdlLayer>(key, layer, clock.stop());
        return layer;
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
    bool isRough_; // a picture before the bake proper: never final, and no part of its progress
    double allCells_ = 0.0, told_ = 0.0;
};

} // namespace

namespace {

/// The first depth from a sixteenth of the photons, for whoever waits for a picture. The bake proper does not depend on
/// it; the photons are the first of the same streams.
Result<Done> showRough(const BakeJob& job, BakeProducts& products, BakeControl& control)
{
    BakeJob rough = job;
    rough.params.photonCount = std::max(10'000, job.params.photonCount / 16);
    rough.params.gatherCount = std::max(20, job.params.gatherCount / 4);      // as wide a kernel within a factor of two
    if (rough.params.photonCount > job.params.photonCount / 4) return Done{}; // the bake proper is as quick
    const Result<PhotonProducts> photons = photonProducts(rough, products, control, 0.02);
    if (!photons) return photons.error();
    const Result<Done> shown = OctreeBake(rough, products, control, *photons, true).depth(job.params.octreeFirstDepth);
    // what was traced for it counts as work; what it holds is not part of the result
    WorkCounters& counters = products.counters;
    WorkCounters work;
    work.photonsShot = counters.photonsShot, work.raysTraced = counters.raysTraced;
    work.photonsReused = counters.photonsReused, work.stages = counters.stages;
    counters = work;
    return shown;
}

} // namespace

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
