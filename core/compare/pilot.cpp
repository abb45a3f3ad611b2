// SPDX-License-Identifier: Apache-2.0
#include "core/compare/pilot.h"
#include "core/base/units.h"
#include "core/compare/field_probe.h"
#include "core/compare/sweep.h"
#include "core/octree/layer_fit.h"
#include "core/octree/octree_solver.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/photonmap/photon_products.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr std::uint64_t kPilotPoints = 77;                                   ///< seed; not that of the judge
constexpr std::size_t kBlock = 32;                                           ///< entries
constexpr std::array<double, 5> kRatios{0.5e-3, 1.25e-3, 3e-3, 8e-3, 20e-3}; ///< K/N; blur is clearest in wide kernels
constexpr std::array<double, 2> kOctreeRatios{0.4e-3, 3e-3};
constexpr int kLeastCount = 8; ///< fewer photons are no density

using Values = std::vector<double>; ///< luminance at the probes

/// Photons of one seed, and what they cost.
struct Shot {
    PhotonProducts photons;
    double shootSeconds = 0, treeSeconds = 0;
};

class Pilot {
public:
    Pilot(const BakeJob& job, Method method, const PilotSize& size, BakeProducts& products, BakeControl& control)
        : job_(job), method_(method), size_(size), products_(products), control_(control)
    {
        job_.params.photonCount = size.photons;
    }

    Result<PilotFindings> run(const ReferenceStore& store)
    {
        const double began = processCpuSeconds();
        for (const std::uint64_t seed : {job_.params.seed, otherSeed(job_.params.seed)})
            if (const Result<Done> done = shoot(seed); !done) return done.error();
        costsOfPhotons();
        if (const Result<Done> done = findJudge(store); !done) return done.error();
        bool all = measureKernels();
        if (method_ == Method::lightOctree) {
            for (const int depth : size_.depths) all = all && measureOctree(depth);
            found_.costs.fitGather(gathers_);
        }
        if (!all || control_.isStopped()) return cancelled();
        found_.cpuSeconds = processCpuSeconds() - began - keptSeconds_;
        return std::move(found_);
    }

private:
    [[nodiscard]] const SceneProducts& at() const { return shots_.front().photons.scene; }

    Result<Done> shoot(std::uint64_t seed)
    {
        BakeJob job = job_;
        job.params.seed = seed;
        BakeControl quiet(control_, {});
        products_.beginRound();
        Result<PhotonProducts> photons = photonProducts(job, products_, quiet, 1.0);
        if (!photons) return photons.error();
        Shot shot{*std::move(photons)};
        for (const StageCost& s : products_.counters.stages) {
            const double seconds = s.cpuMs / 1000.0;
            if (s.stage == "shoot")
                shot.shootSeconds += seconds;
            else if (s.stage == "tree")
                shot.treeSeconds += seconds;
            else
                addShared(s, shots_.empty() ? found_.costs.fixedSeconds : ignored_);
        }
        shots_.push_back(std::move(shot));
        return Done{};
    }

    /// What any bake of this scene pays, and finds done.
    void addShared(const StageCost& cost, double& sum)
    {
        sum += cost.cpuMs / 1000.0;
        if (!cost.isKept) keptSeconds_ += cost.cpuMs / 1000.0;
    }

    void costsOfPhotons()
    {
        double groups = 0, stored = 0, nLogN = 0, shootSeconds = 0, treeSeconds = 0;
        for (const Shot& shot : shots_) {
            shootSeconds += shot.shootSeconds, treeSeconds += shot.treeSeconds;
            for (const auto& map : shot.photons.maps) {
                if (!map) continue;
                const auto n = static_cast<double>(map->size());
                groups += 1.0, stored += n, nLogN += n * std::log2(std::max(n, 2.0));
            }
        }
        const double all = std::max(groups * size_.photons, 1.0);
        CostModel& c = found_.costs;
        c.groups = groups / static_cast<double>(shots_.size());
        c.shootPerPhoton = shootSeconds / all;
        c.storedPerPhoton = stored / all;
        c.measuredWith = stored / std::max(groups, 1.0);
        c.treePerNLogN = nLogN > 0.0 ? treeSeconds / nLogN : 0.0;
    }

    Result<Done> findJudge(const ReferenceStore& store)
    {
        ReferenceJob job;
        job.paths = size_.paths, job.pathDepth = job_.params.pathDepth, job.directSamples = 1;
        Result<Judge> judge = traceJudge(at(), probeRows(at(), size_.probes, kPilotPoints), job, store,
                                         control_.workers(), control_.stop(), {}, job_.mix);
        if (!judge) return judge.error();
        double flux = 0;
        for (const Shot& shot : shots_) {
            for (const auto& map : shot.photons.maps) {
                for (std::size_t i = 0; map && i < map->size(); ++i)
                    flux += static_cast<double>(luminance(map->photon(static_cast<std::uint32_t>(i)).flux));
            }
        }
        const double mean = flux / (static_cast<double>(shots_.size()) * shots_.front().photons.area->total());
        if (mean > 0.0) judge->mean = mean;
        found_.judge = *std::move(judge);
        return Done{};
    }

    /// Light that a field gives at the probes; empty if stopped.
    Values look(const IndirectField& field)
    {
        const FieldProbe probe(*at().rays, *at().lights, &field, job_.params);
        const auto light = probe.indirect(found_.judge.points, control_.workers(), control_.stop());
        return light ? luminances(*light) : Values{};
    }

    /// K for these ratios, each well above the one before.
    [[nodiscard]] std::vector<int> countsOf(std::span<const double> ratios) const
    {
        std::vector<int> counts;
        for (const double ratio : ratios) {
            const int least = counts.empty() ? kLeastCount : counts.back() + counts.back() / 2;
            counts.push_back(std::max(least, static_cast<int>(std::lround(ratio * size_.photons))));
        }
        return counts;
    }

    /// Measures with each K for both seeds; `valuesOf(params, shot)` gives light at the probes. False: stopped.
    template<class ValuesOf>
    bool measure(int depth, std::span<const double> ratios, const ValuesOf& valuesOf)
    {
        for (const int count : countsOf(ratios)) {
            BakeParams params = job_.params;
            params.gatherCount = count;
            const Values a = valuesOf(params, shots_[0]), b = valuesOf(params, shots_[1]);
            if (a.empty() || b.empty()) return false;
            const SplitSquares squares = splitSquares(a, b, found_.judge);
            found_.errors.push_back({depth, static_cast<double>(count), static_cast<double>(size_.photons),
                                     squares.noise.value, squares.noise.sigma, squares.systematic.value,
                                     squares.systematic.sigma});
        }
        return true;
    }

    /// Noise and blur of kernels alone: densities at the probes themselves, as from an octree without end.
    bool measureKernels()
    {
        return measure(0, kRatios, [&](const BakeParams& params, const Shot& shot) {
            const PhotonProducts& p = shot.photons;
            return look(*photonMapField(params, job_.scene->bounds, p.area, p.maps, job_.mix));
        });
    }

    /// What cells add to it, and how long leaves take.
    bool measureOctree(int depth)
    {
        const auto geometry = octreeGeometry(job_, shots_.front().photons, depth, products_, control_);
        if (!geometry) return false;
        double build = 0;
        for (const StageCost& s : products_.counters.stages) {
            if (s.stage == fmt::format("octree d{}", depth)) addShared(s, build);
        }
        found_.costs.depths.push_back({depth, build, static_cast<double>(geometry->entries.size())});
        const auto part = std::make_shared<const OctreeGeometry>(leavesRead(*geometry, found_.judge.points));
        return measure(depth, kOctreeRatios, [&](const BakeParams& params, const Shot& shot) {
            return valuesOfLeaves(part, shot.photons, params);
        });
    }

    /// Light at the probes by an octree of these leaves alone; empty if stopped. Times gather and area apart.
    Values valuesOfLeaves(const std::shared_ptr<const OctreeGeometry>& part, const PhotonProducts& photons,
                          const BakeParams& params)
    {
        GatherSample sample{static_cast<double>(params.gatherCount), static_cast<double>(size_.photons), 0, 0};
        std::vector<std::shared_ptr<const VdlLayer>> layers(photons.maps.size());
        double fits = 0;
        for (std::size_t g = 0; g < layers.size(); ++g) {
            if (!photons.maps[g]) continue;
            const auto layer = emptyLayer(*part, static_cast<int>(g), params);
            const LayerFit fit(*part, *photons.maps[g], *photons.area, params, *layer);
            if (!timeLayer(*part, fit, *photons.area, sample)) return {};
            fits += static_cast<double>(part->entries.size());
            layers[g] = layer;
        }
        sample.areaSeconds /= std::max(fits, 1.0);
        sample.gatherSeconds /= std::max(fits, 1.0);
        gathers_.push_back(sample);
        return look(LightOctree(part, std::move(layers), params.vdlForm, job_.mix));
    }

    /// Fits all entries, and measures their areas once more for the time that takes. False: stopped.
    bool timeLayer(const OctreeGeometry& part, const LayerFit& fit, const SurfaceArea& area, GatherSample& sample)
    {
        const DensityKernel& kernel = fit.kernel();
        std::vector<float> radii(part.entries.size());
        const double began = threadWorkSeconds();
        const bool isFitted = forEntries(part, [&](std::size_t e) {
            thread_local FitScratch scratch;
            static_cast<void>(fit.fit(static_cast<std::uint32_t>(e), scratch));
            radii[e] = scratch.gathered.radius;
        });
        const double fitted = threadWorkSeconds();
        const bool isMeasured = forEntries(part, [&](std::size_t e) {
            const KernelPlace place{part.entries[e].centroid, part.entries[e].normal, kernel.stretch,
                                    kernel.leastCosine, part.screensOf(e)};
            radii[e] = static_cast<float>(area.under(place, radii[e]));
        });
        const double areaSeconds = threadWorkSeconds() - fitted;
        sample.areaSeconds += areaSeconds;
        sample.gatherSeconds += std::max(fitted - began - areaSeconds, 0.0);
        return isFitted && isMeasured;
    }

    template<class Visit>
    bool forEntries(const OctreeGeometry& part, const Visit& visit)
    {
        return control_.forBlocks((part.entries.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
            for (std::size_t e = block * kBlock; e < std::min(part.entries.size(), (block + 1) * kBlock); ++e) visit(e);
        });
    }

    BakeJob job_;
    Method method_;
    const PilotSize& size_;
    BakeProducts& products_;
    BakeControl& control_;
    PilotFindings found_;
    std::vector<Shot> shots_; ///< of two seeds
    std::vector<GatherSample> gathers_;
    double keptSeconds_ = 0; ///< spent on what the bake will find
    double ignored_ = 0;
};

} // namespace

Result<PilotFindings> runPilot(const BakeJob& job, Method method, const PilotSize& size, const ReferenceStore& store,
                               BakeProducts& products, BakeControl& control)
{
    return Pilot(job, method, size, products, control).run(store);
}

} // namespace lightloom
