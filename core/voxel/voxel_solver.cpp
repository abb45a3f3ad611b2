// SPDX-License-Identifier: Apache-2.0
#include "core/voxel/voxel_solver.h"
#include "core/base/memory_use.h"
#include "core/base/units.h"
#include "core/lightcuts/ray_partners.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_products.h"
#include "core/trace/cell_clip.h"
#include "core/transport/entry_means.h"
#include "core/transport/light_tilts.h"
#include "core/transport/specular_light.h"
#include "core/voxel/ray_correction.h"
#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace lightloom {
namespace {

// of a bake's time, up to the end of each
constexpr double kVoxelsUntil = 0.1, kPartnersUntil = 0.5, kFirstUntil = 0.8;

/// Entries whose light differs by more are not averaged (docs/measurements.md: .25 and .12 leave more bands, without a
/// limit atrium's spots of sun run).
constexpr float kSameLight = 0.5f, kAnyLight = std::numeric_limits<float>::infinity();

/// The voxels that were made last, with what they were made of.
struct VoxelsBefore {
    std::shared_ptr<const SurfaceVoxels> voxels;
    std::shared_ptr<const LightReach> reach;
};

EntryValues sum(EntryValues a, const EntryValues& b)
{
    for (std::size_t i = 0; i < a.values.size(); ++i) a.values[i] += b.values[i];
    return a;
}

using Layers = std::vector<std::shared_ptr<const VoxelLayer>>;

/// Error out of memory where `bytes` are more than nine tenths of what this machine has.
Result<Done> checkMemory(double bytes, const BakeParams& params)
{
    const double have = 0.9 * machineMemoryBytes();
    if (bytes <= have) return Done{};
    return Error{Error::Kind::outOfMemory,
                 fmt::format("voxel.size={} needs about {:.1f} GiB in this scene, this machine has {:.1f}; lower it",
                             params.voxelSize, bytes / (1 << 30), have / (1 << 30))};
}

/// Bytes of voxels before they are made, from the area they cover: a wall fills one to two voxels per square of their
/// size.
double voxelBytes(const Bounds& bounds, const LightReach& reach, int cells)
{
    const double size = static_cast<double>(bounds.longestSide()) / cells;
    const double voxels = 2.0 * reach.area() / std::max(size * size, 1e-300);
    constexpr double kOrders = 220.0; // bytes of an entry in the orders of its walks
    return voxels * (static_cast<double>(2 * sizeof(CellPiece) + 2 * sizeof(Orientation)) + kOrders);
}

class VoxelBake {
public:
    VoxelBake(const BakeJob& job, const BakeParams& params, const SceneProducts& scene, BakeProducts& products,
              BakeControl& control, double before, double share)
        : job_(job), params_(params), scene_(scene), products_(products), control_(control), before_(before),
          share_(share)
    {
    }

    [[nodiscard]] Result<std::shared_ptr<const VoxelField>> field()
    {
        const Result<std::shared_ptr<const VoxelGeometry>> geometry = this->geometry();
        if (!geometry) return geometry.error();
        tell(Stage::build, kVoxelsUntil);
        Layers layers(job_.scene->groups.size());
        const std::vector<int> missing = findKept(layers);
        if (const Result<Done> lit = light(**geometry, missing, layers); !lit) return lit.error();
        products_.counters.voxels = (*geometry)->voxels->voxels.size();
        products_.counters.entries = (*geometry)->voxels->entries.size();
        return std::make_shared<const VoxelField>((*geometry)->surface, std::move(layers), job_.mix);
    }

    /// Whether it takes so little, since an earlier bake left all that lamps do not change, that no rough picture is
    /// worth its time.
    [[nodiscard]] bool isSwift() const
    {
        constexpr double kFew = 1 << 24; // sums of a first bounce: a field in some 25 ms of one core
        const auto geometry = products_.find<VoxelGeometry>(geometryKey());
        if (!geometry || !products_.find<PartnerTable>(partnersKey()) || !products_.find<EntryPoints>(pointsKey()))
            return false;
        if (params_.voxelRays > 0 && !products_.find<RayPartners>(raysKey())) return false;
        if (params_.voxelPhotons > 0 && !geometry->surface->matt.empty()) return false;
        double missing = 0.0;
        for (int g = 0; g < static_cast<int>(job_.scene->groups.size()); ++g)
            missing += !isOff(job_.mix, g) && !products_.find<VoxelLayer>(layerKey(g)) ? 1.0 : 0.0;
        return missing * params_.voxelDirections * static_cast<double>(geometry->voxels->entries.size()) <= kFew;
    }

private:
    void tell(Stage stage, double fraction)
    {
        control_.waitWhilePaused();
        control_.progress(stage, before_ + share_ * fraction);
    }

    /// Tells progress of a stage that takes the bake from one share to another.
    [[nodiscard]] std::function<void(double)> within(Stage stage, double from, double to)
    {
        return [this, stage, from, to](double part) { tell(stage, from + part * (to - from)); };
    }

    [[nodiscard]] std::string geometryKey() const
    {
        return fmt::format("{}voxels {} shift {} {} ", scene_.reachKey, params_.voxelSize, params_.gridShift,
                           kVoxelLinesNames[static_cast<std::size_t>(params_.voxelLines)]);
    }
    [[nodiscard]] std::string partnersKey() const
    {
        return fmt::format("{}partners {} {}", geometryKey(), params_.voxelDirections, params_.voxelPartnerMemory);
    }
    [[nodiscard]] std::string pointsKey() const
    {
        return fmt::format("{}points {} seed {}", geometryKey(), params_.voxelSamples, params_.seed);
    }
    [[nodiscard]] std::string raysKey() const
    {
        return fmt::format("{}rays {} seed {}", geometryKey(), params_.voxelRays, params_.seed);
    }
    [[nodiscard]] Result<std::shared_ptr<const VoxelGeometry>> geometry()
    {
        const std::string key = geometryKey();
        const std::string place = fmt::format("voxels {} shift {}", params_.voxelSize, params_.gridShift);
        const auto before = products_.find<VoxelsBefore>(place);
        if (auto kept = products_.find<VoxelGeometry>(key)) return kept;
        const LightReach& reach = *scene_.reach;
        const Bounds& bounds = job_.scene->bounds;
        if (const Result<Done> fits = checkMemory(voxelBytes(bounds, reach, params_.voxelSize), params_); !fits)
            return fits.error();
        const StageClock clock("voxels", control_);
        const auto clipped =
            before ? revoxelise(*before->voxels, *before->reach, bounds, reach, params_.voxelSize, params_.gridShift,
                                control_.workers(), control_.stop())
                   : voxelise(bounds, reach, params_.voxelSize, params_.gridShift, control_.workers(), control_.stop());
        if (!clipped) return cancelled();
        products_.keep<VoxelsBefore>(place, std::make_shared<const VoxelsBefore>(VoxelsBefore{clipped, scene_.reach}));
        const auto voxels = voxelsFor(params_.voxelLines, clipped);
        auto surface = voxelSurface(*voxels, entryAlbedos(*scene_.rays, reach, *voxels),
                                    entryMattAlbedos(*scene_.rays, reach, *voxels));
        auto made = std::make_shared<const VoxelGeometry>(
            VoxelGeometry{voxels, VoxelOrders(*voxels, params_.voxelLines), std::move(surface)});
        products_.keep<VoxelGeometry>(key, made, clock.stop());
        return made;
    }

    /// Null: stopped.
    [[nodiscard]] std::shared_ptr<const PartnerTable> partners(const VoxelGeometry& geometry)
    {
        const std::string key = partnersKey();
        if (auto kept = products_.find<PartnerTable>(key)) return kept;
        const StageClock clock("partners", control_);
        const auto most = static_cast<std::size_t>(params_.voxelPartnerMemory) << 20;
        auto made =
            PartnerTable::make(*scene_.rays, *geometry.voxels, geometry.orders, params_.voxelDirections, most,
                               control_.workers(), control_.stop(), within(Stage::build, kVoxelsUntil, kPartnersUntil));
        if (made) products_.keep<PartnerTable>(key, made, clock.stop());
        return made;
    }

    /// Where lamps are looked for from; null: stopped, or they take too much to be kept.
    [[nodiscard]] std::shared_ptr<const EntryPoints> points(const SurfaceVoxels& voxels)
    {
        constexpr std::size_t kMostBytes = std::size_t(256) << 20;
        if (EntryPoints::bytesFor(voxels.entries.size(), params_.voxelSamples) > kMostBytes) return nullptr;
        const std::string key = pointsKey();
        if (auto kept = products_.find<EntryPoints>(key)) return kept;
        const StageClock clock("points", control_);
        auto made =
            entryPoints(*scene_.reach, voxels, params_.voxelSamples, params_.seed, control_.workers(), control_.stop());
        if (made) products_.keep<EntryPoints>(key, made, clock.stop());
        return made;
    }

    /// Null: stopped.
    [[nodiscard]] std::shared_ptr<const RayPartners> rays(const VoxelGeometry& geometry)
    {
        const std::string key = raysKey();
        if (auto kept = products_.find<RayPartners>(key)) return kept;
        const StageClock clock("partners by rays", control_);
        auto made = RayPartners::trace(*scene_.rays, *scene_.reach, *geometry.voxels, params_.voxelRays, params_.seed,
                                       control_.workers(), control_.stop());
        if (made) products_.keep<RayPartners>(key, made, clock.stop());
        return made;
    }

    /// Lamps' light by mirrors and glass, over neighbours: few photons meet one entry. Empty: stopped.
    [[nodiscard]] EntryValues specular(const VoxelGeometry& geometry, const std::vector<int>& groups)
    {
        const StageClock clock("photons by mirrors and glass", control_);
        const auto photons = static_cast<std::uint64_t>(params_.voxelPhotons);
        std::uint64_t caught = 0;
        EntryValues lux = specularLight(*scene_.lights, *geometry.voxels, groups, photons, params_.seed,
                                        control_.workers(), control_.stop(), &caught);
        products_.counters.photonsShot += photons * groups.size();
        products_.counters.causticPhotons += caught;
        lux = evened(geometry, std::move(lux), true, kAnyLight);
        addCost(products_.counters.stages, clock.stop());
        return lux;
    }

    /// Where light comes from (leaningLayer): what came along lines (`all`) leans as they say, `specular` (may be
    /// empty) not at all. Empty: stopped.
    [[nodiscard]] EntryValues towards(const VoxelGeometry& geometry, const EntryValues& radiosity,
                                      const EntryValues& all, const EntryValues& specular, const PartnerTable& partners)
    {
        const SurfaceVoxels& voxels = *geometry.voxels;
        const int directions = std::min(params_.voxelDirections, kTiltDirections);
        EntryValues towards = lightTilts(*scene_.rays, voxels, geometry.orders, radiosity, directions,
                                         control_.workers(), control_.stop(), &partners);
        for (std::size_t i = 0; i < towards.values.size(); i += 3) {
            float* v = &towards.values[i];
            const glm::vec3 n = voxels.entries[i / static_cast<std::size_t>(towards.channels)].normal;
            glm::vec3 tilt(v[0], v[1], v[2]);
            if (!specular.values.empty()) {
                const float byLines = luminance(all.groupAt(i)), other = luminance(specular.groupAt(i));
                tilt *= byLines > 0.0f ? byLines / (byLines + other) : 0.0f;
            }
            const glm::vec3 unit = glm::normalize(0.5f * n + tilt);
            v[0] = unit.x, v[1] = unit.y, v[2] = unit.z;
        }
        return towards;
    }

    /// Null: stopped.
    [[nodiscard]] std::shared_ptr<const EntryMeans> neighbours(const VoxelGeometry& geometry)
    {
        return means("neighbours",
                     [&] { return neighbourMeans(*geometry.voxels, control_.workers(), control_.stop()); });
    }
    /// Values with what `voxel.slivers` joins, and over neighbours where `isSmooth`. Empty: stopped.
    [[nodiscard]] EntryValues evened(const VoxelGeometry& geometry, EntryValues values, bool isSmooth,
                                     float within = kSameLight)
    {
        const SurfaceVoxels& voxels = *geometry.voxels;
        if (params_.voxelSlivers > 0.0f && !values.values.empty()) {
            const auto slivers = means(fmt::format("slivers {}", params_.voxelSlivers), [&] {
                return sliverMeans(voxels, params_.voxelSlivers, control_.workers(), control_.stop());
            });
            values = slivers ? slivers->of(values, kAnyLight, control_.workers(), control_.stop()) : EntryValues{};
        }
        if (isSmooth && !values.values.empty()) {
            const auto around = neighbours(geometry);
            values = around ? around->of(values, within, control_.workers(), control_.stop()) : EntryValues{};
        }
        return values;
    }
    /// Null: stopped.
    template<class Make>
    [[nodiscard]] std::shared_ptr<const EntryMeans> means(const std::string& name, Make make)
    {
        const std::string key = geometryKey() + name;
        auto kept = products_.find<EntryMeans>(key);
        if (kept) return kept;
        kept = make();
        if (kept) products_.keep<EntryMeans>(key, kept);
        return kept;
    }
    [[nodiscard]] bool smooths(VoxelSmooth what) const
    {
        return params_.voxelSmooth == what || params_.voxelSmooth == VoxelSmooth::both;
    }

    /// Gauss-Seidel goes over the surface in parts, which no walk of lines does.
    [[nodiscard]] Result<Done> checkPartners(std::size_t entries) const
    {
        const std::size_t bytes = PartnerTable::bytesFor(entries, params_.voxelDirections);
        const auto most = static_cast<std::size_t>(params_.voxelPartnerMemory) << 20;
        if (params_.voxelBounces == VoxelBounces::halving || bytes <= most) return Done{};
        return Error{Error::Kind::badInput,
                     fmt::format("voxel.bounces=gauss-seidel keeps all partners, {} MiB in this scene, "
                                 "voxel.partners={} allows less; raise that or use halving",
                                 (bytes >> 20) + 1, params_.voxelPartnerMemory)};
    }

    [[nodiscard]] std::string layerKey(int group) const
    {
        return scene_.layerKey(static_cast<std::size_t>(group)) + stageKey(params_, Stage::fit, Method::voxelLightcuts);
    }

    /// Light groups that have no layer from earlier bakes.
    [[nodiscard]] std::vector<int> findKept(Layers& layers)
    {
        WorkCounters& counters = products_.counters;
        std::vector<int> missing;
        for (int g = 0; g < static_cast<int>(layers.size()); ++g) {
            if (isOff(job_.mix, g)) {
                ++counters.groupsOff;
                continue;
            }
            ++counters.groupsBaked;
            auto& layer = layers[static_cast<std::size_t>(g)];
            layer = products_.find<VoxelLayer>(layerKey(g));
            if (layer)
                ++counters.groupsReused;
            else
                missing.push_back(g);
        }
        return missing;
    }

    [[nodiscard]] Result<Done> light(const VoxelGeometry& geometry, const std::vector<int>& missing, Layers& layers)
    {
        if (missing.empty()) return Done{};
        const SurfaceVoxels& voxels = *geometry.voxels;
        const std::vector<glm::vec3>& albedo = geometry.surface->albedo;
        const double channels = 3.0 * static_cast<double>(missing.size());
        const double bytes = static_cast<double>(voxels.entries.size()) * channels * 12.0 * sizeof(float);
        if (const Result<Done> fits = checkMemory(bytes, params_); !fits) return fits;

        if (const Result<Done> fits = checkPartners(voxels.entries.size()); !fits) return fits;
        const auto partners = this->partners(geometry);
        if (!partners) return cancelled();
        const auto points = this->points(voxels);
        const StageClock firstClock("first light", control_);
        EntryValues first = firstLight(*scene_.lights, *scene_.reach, voxels, missing, params_.voxelSamples,
                                       params_.seed, control_.workers(), control_.stop(),
                                       within(Stage::fit, kPartnersUntil, kFirstUntil), points.get());
        first = evened(geometry, std::move(first), smooths(VoxelSmooth::first));
        if (first.values.empty() && !voxels.entries.empty()) return cancelled();
        addCost(products_.counters.stages, firstClock.stop());
        EntryValues specular;
        if (params_.voxelPhotons > 0 && !geometry.surface->matt.empty()) {
            specular = this->specular(geometry, missing);
            if (specular.values.empty()) return cancelled();
        }
        const EntryValues leaving = specular.values.empty() ? reflected(first, albedo)
                                                            : reflected(sum(first, specular), geometry.surface->matt);
        const StageClock clock("bounces", control_);
        int bounces = 0;
        BounceParams bounce;
        bounce.directions = params_.voxelDirections;
        bounce.leastGain = params_.voxelGain;
        bounce.order = params_.voxelBounces;
        EntryValues all =
            bounceLight(*scene_.rays, voxels, geometry.orders, leaving, albedo, bounce, control_.workers(),
                        control_.stop(), &bounces, partners.get(), within(Stage::fit, kFirstUntil, 1.0));
        if (all.values.empty() && !voxels.entries.empty()) return cancelled();
        products_.counters.bounces += static_cast<std::uint64_t>(bounces);
        EntryValues byRays;
        std::shared_ptr<const RayPartners> rays;
        if (params_.voxelRays > 0 && !voxels.entries.empty()) {
            rays = this->rays(geometry);
            if (rays) byRays = rays->bounced(leaving, albedo, all, control_.workers(), control_.stop());
            if (byRays.values.empty()) return cancelled();
            byRays = evened(geometry, rays->ofOpen(std::move(byRays)), smooths(VoxelSmooth::bounced));
            if (byRays.values.empty()) return cancelled();
        }
        all = evened(geometry, std::move(all), smooths(VoxelSmooth::bounced));
        if (!byRays.values.empty()) {
            const auto around = neighbours(geometry);
            if (!around) return cancelled();
            all = correctedByRays(std::move(all), byRays, rays->open(), *around, control_.workers(), control_.stop());
            if (!all.values.empty())
                all = spreadIntoHidden(std::move(all), rays->open(), *around, control_.workers(), control_.stop());
            byRays = rays->ofAll(std::move(byRays));
        }
        if (all.values.empty() && !voxels.entries.empty()) return cancelled();
        EntryValues towards = this->towards(geometry, sum(leaving, reflected(all, albedo)), all, specular, *partners);
        if (towards.values.empty() && !voxels.entries.empty()) return cancelled();
        if (!specular.values.empty()) {
            all = sum(std::move(all), specular);
            if (!byRays.values.empty()) byRays = sum(std::move(byRays), specular);
        }
        const StageCost cost = clock.stop();
        for (std::size_t i = 0; i < missing.size(); ++i) {
            const auto layer = layerOf(*geometry.surface->leaves, first, all, towards, byRays, specular, i, missing[i]);
            layers[static_cast<std::size_t>(missing[i])] = layer;
            products_.keep<VoxelLayer>(layerKey(missing[i]), layer);
        }
        addCost(products_.counters.stages, cost);
        return Done{};
    }

    /// Values of light group number `i` of those that were carried together.
    [[nodiscard]] static std::shared_ptr<const VoxelLayer>
    layerOf(const OctreeGeometry& leaves, const EntryValues& first, const EntryValues& all, const EntryValues& towards,
            const EntryValues& byRays, const EntryValues& specular, std::size_t i, int group)
    {
        const auto taken = [i](const EntryValues& from) {
            std::vector<glm::vec3> values(from.entries());
            for (std::size_t e = 0; e < values.size(); ++e) {
                const float* v = &from.values[e * static_cast<std::size_t>(from.channels) + 3 * i];
                values[e] = {v[0], v[1], v[2]};
            }
            return values;
        };
        return std::make_shared<const VoxelLayer>(VoxelLayer{
            taken(first), leaningLayer(group, taken(all), taken(towards), leaves), taken(byRays), taken(specular)});
    }

    const BakeJob& job_;
    const BakeParams& params_;
    const SceneProducts& scene_;
    BakeProducts& products_;
    BakeControl& control_;
    double before_, share_; ///< of the whole bake's progress
};

/// All but a rough picture, which took `before` of the bake's time.
Result<Done> bakeWhole(const BakeJob& job, BakeProducts& products, BakeControl& control, double before)
{
    const Result<SceneProducts> scene = sceneProducts(job, products, control);
    if (!scene) return scene.error();
    const auto field = VoxelBake(job, job.params, *scene, products, control, before, 1.0 - before).field();
    if (!field) return field.error();
    control.progress(Stage::fit, 1.0);
    control.publish(*field, job.params.voxelSize, true);
    return Done{};
}

} // namespace

BakeParams roughVoxelParams(BakeParams params)
{
    params.voxelSize = std::min(params.voxelSize, 24);
    params.voxelSamples = std::min(params.voxelSamples, 2);
    params.voxelDirections = std::min(params.voxelDirections, 128);
    params.voxelRays = 0;
    params.voxelPhotons /= 16;
    return params;
}

std::shared_ptr<const VoxelSurface> voxelSurface(const SurfaceVoxels& voxels, std::vector<glm::vec3> albedo,
                                                 std::vector<glm::vec3> matt)
{
    auto leaves = std::make_shared<OctreeGeometry>();
    leaves->depth = voxels.lattice.depth;
    leaves->lowest = voxels.lattice.lowest;
    leaves->rootSize = voxels.lattice.rootSize;
    for (const glm::ivec3 voxel : voxels.voxels) leaves->cells.push_back(mortonCode(glm::uvec3(voxel)));
    leaves->firstEntry = voxels.firstEntry;
    for (const Orientation& o : voxels.entries) leaves->entries.push_back({o.centroid, o.normal, o.area});
    return std::make_shared<const VoxelSurface>(
        VoxelSurface{voxels.cells, std::move(leaves), std::move(albedo), std::move(matt)});
}

Result<Done> VoxelSolver::bake(const BakeJob& job, BakeProducts& products, BakeControl& control)
{
    if (const Result<Done> checked = checkTogether(job.params); !checked) return checked;
    control.progress(Stage::build, 0.0);
    const BakeParams rough = roughVoxelParams(job.params);
    const bool isRoughFirst = job.roughFirst && rough.voxelSize < job.params.voxelSize;
    constexpr double kRoughShare = 0.05;
    if (isRoughFirst) {
        const Result<SceneProducts> scene = sceneProducts(job, products, control, ReachWanted::quick);
        if (!scene) return scene.error();
        if (VoxelBake(job, job.params, *scene, products, control, 0.0, 1.0).isSwift())
            return bakeWhole(job, products, control, 0.0);
        const auto field = VoxelBake(job, rough, *scene, products, control, 0.0, kRoughShare).field();
        if (!field) return field.error();
        control.publish(*field, rough.voxelSize, false, true);
        WorkCounters work; // what was lit for it is not part of the result
        work.stages = products.counters.stages;
        products.counters = work;
    }
    return bakeWhole(job, products, control, isRoughFirst ? kRoughShare : 0.0);
}

} // namespace lightloom
