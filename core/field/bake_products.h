// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/stage_cost.h"
#include "core/trace/light_reach.h"
#include "core/trace/photon_tracer.h"
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <typeindex>

namespace lightloom {

/// What a bake did, counted. Shown by `bake --json` and in the window; tests hold the zeros.
struct WorkCounters {
    std::uint64_t photonsShot = 0, photonsStored = 0, photonsReused = 0; ///< reused: kept from an earlier bake
    std::uint64_t raysTraced = 0, causticPhotons = 0, pathsCutOff = 0;
    std::uint64_t groupsBaked = 0, groupsOff = 0, groupsReused = 0;
    std::uint64_t leaves = 0, entries = 0, gathers = 0, clusterings = 0;
    std::uint64_t vertices = 0, deposits = 0; ///< of a grid: in the open; faces crossed or cells passed by photons
    std::uint64_t voxels = 0, bounces = 0;    ///< of voxel radiosity; its entries count above
    std::uint64_t degenerateEntries = 0; ///< gathers whose kernel had no area; their photons were spread over a floor
    std::uint64_t photonsPerGroup = 0;   ///< of a grid, where it was chosen for the scene too
    double keptBytes = 0, mostBytes = 0; ///< of a grid, computed before the bake: of the field; at once meanwhile
    Ledger ledger;
    std::vector<StageCost> stages; ///< in order of their first end; kept ones where they were found
};

/// What earlier bakes left, so that nothing is computed twice: photon paths, trees, geometry, layers, each under a key
/// that names all it depends on (surface, lamp, reach, stage's parameters). Owned by the session; one bake at a time
/// works on it. Keeps what the newest bakes used and drops the rest; a bake that was cut short, as most are while a
/// lamp is dragged, drops nothing that the last whole ones used. A product remembers what it cost: the first `find` in
/// a round adds that to the counters as kept.
class BakeProducts {
public:
    template<class T>
    [[nodiscard]] std::shared_ptr<const T> find(const std::string& key)
    {
        std::lock_guard lock(mutex_);
        const auto found = kept_.find({typeid(T), key});
        if (found == kept_.end()) return nullptr;
        Kept& kept = found->second;
        if (kept.lastUse != round_ && kept.cost) addCost(counters.stages, *kept.cost);
        kept.lastUse = round_;
        return std::static_pointer_cast<const T>(kept.value);
    }
    template<class T>
    void keep(const std::string& key, std::shared_ptr<const T> value)
    {
        std::lock_guard lock(mutex_);
        kept_[{typeid(T), key}] = {std::move(value), round_, 0, {}};
    }
    /// The same for a product whose making was measured; adds `cost` to the counters.
    template<class T>
    void keep(const std::string& key, std::shared_ptr<const T> value, StageCost cost)
    {
        std::lock_guard lock(mutex_);
        addCost(counters.stages, cost);
        cost.isKept = true;
        kept_[{typeid(T), key}] = {std::move(value), round_, 0, std::move(cost)};
    }
    /// Puts `value` in the place of a kept product, which has cost what it did.
    template<class T>
    void replace(const std::string& key, std::shared_ptr<const T> value)
    {
        std::lock_guard lock(mutex_);
        const auto found = kept_.find({typeid(T), key});
        if (found != kept_.end()) found->second.value = std::move(value);
    }
    /// Call at the start of a bake: products that neither this, nor the `rounds` before it, nor the last `rounds` whole
    /// ones use are dropped.
    void beginRound(int rounds = 2);
    /// Call where a bake came to its end: what it used outlasts bakes that do not.
    void endRound();
    void clear();
    [[nodiscard]] std::size_t count(); ///< of products that are kept

    WorkCounters counters; ///< of the bake that ran last

private:
    struct Kept {
        std::shared_ptr<const void> value;
        std::uint64_t lastUse = 0;
        std::uint64_t lastWholeUse = 0; ///< by a bake that came to its end, counted among those; 0: none
        std::optional<StageCost> cost;  ///< marked as kept
    };
    std::mutex mutex_;
    std::map<std::pair<std::type_index, std::string>, Kept> kept_;
    std::uint64_t round_ = 0, wholeRounds_ = 0;
};

/// Ray scene, lights and reach of the job's scene, from `products` or built now, and what keys of products that depend
/// on them start with. No key holds more of the scene than its product depends on.
struct SceneProducts {
    std::shared_ptr<const RayScene> rays;
    std::shared_ptr<const LightSampler> lights;
    std::shared_ptr<const LightReach> reach;
    std::string sceneKey;              ///< surface and all lamps
    std::vector<std::string> lampKeys; ///< surface and one light group's lamps: photons
    std::string reachKey;              ///< the surface that is reached, whatever lamps reach it: areas, leaves
    [[nodiscard]] const std::string& lampKey(std::size_t group) const { return lampKeys[group]; }
    /// Reach and one light group: layers.
    [[nodiscard]] std::string layerKey(std::size_t group) const { return reachKey + lampKeys[group]; }
};

} // namespace lightloom
