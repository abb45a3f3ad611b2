// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/light_flood.h"
#include "core/trace/light_sampler.h"
#include <map>
#include <mutex>
#include <span>

namespace lightloom {

/// What the lamps of one light group reach.
struct GroupReach {
    std::vector<int> spaces;             ///< rising
    std::vector<std::uint32_t> elements; ///< outside these spaces, rising
};

/// How closely spaces are looked at.
struct SpaceDetail {
    int depth = 6;               ///< of the lattice that large surfaces are cut by
    std::uint32_t walks = 8'192; ///< of light, a generation
    /// For a first picture: in a tenth of the time; what lies half in the open counts whole.
    static SpaceDetail rough() { return {4, 1'024}; }
};

/// The scene's surface in spaces: what is joined by light, through any number of bounces. A space is flooded from a
/// seed, a point that the surface alone decides, so that it is the same to the bit wherever in it a lamp stands; it is
/// flooded when the first lamp turns out to be in it. Threads that ask take turns.
class LightSpaces {
public:
    /// Elements and seeds: O(n log n) on all workers. Null: stopped.
    static std::shared_ptr<const LightSpaces> build(std::shared_ptr<const RayScene> rays, SpaceDetail detail,
                                                    Workers& workers, const std::stop_token& stop);
    ~LightSpaces();

    /// What the lamps of `group` reach: the spaces that their light meets, and what else it meets where that is no
    /// space with a seed of its own (the outside of a building, say). Depends on the surface and this group alone,
    /// whatever was asked before. `scene` and `lights`: of this surface. Some milliseconds once the space is known.
    /// Null: stopped.
    [[nodiscard]] std::shared_ptr<const GroupReach> ofGroup(const Scene& scene, const LightSampler& lights, int group,
                                                            Workers& workers, const std::stop_token& stop) const;

    /// By element, whether any of the groups reaches it (not 0). Empty: stopped.
    [[nodiscard]] std::vector<std::uint8_t> united(std::span<const std::shared_ptr<const GroupReach>> groups,
                                                   Workers& workers, const std::stop_token& stop) const;
    [[nodiscard]] const SideElements& elements() const { return *elements_; }

private:
    struct Lit;   // points that a group's light meets
    struct Space; // one that was flooded
    LightSpaces(std::shared_ptr<const RayScene> rays, SpaceDetail detail);
    bool placeSeeds(Workers& workers, const std::stop_token& stop);
    bool shine(const Scene& scene, const LightSampler& lights, int group, Workers& workers, const std::stop_token& stop,
               Lit& lit) const;
    [[nodiscard]] bool isSeedSeen(int seed, const std::vector<OpenPoint>& points) const;
    [[nodiscard]] const Space* flooded(int seed, Workers& workers, const std::stop_token& stop) const;
    [[nodiscard]] std::optional<int> spaceOf(int seed, Workers& workers, const std::stop_token& stop) const;
    [[nodiscard]] bool addOutside(const Scene& scene, const LightSampler& lights, int group, Workers& workers,
                                  const std::stop_token& stop, GroupReach& reach) const;

    std::shared_ptr<const RayScene> rays_;
    SpaceDetail detail_;
    std::unique_ptr<const SideElements> elements_;
    std::vector<OpenPoint> seeds_;                               // the most open first
    mutable std::mutex mutex_;                                   // of what was found out so far:
    mutable std::map<int, std::unique_ptr<const Space>> spaces_; // by the seed that was flooded
};

} // namespace lightloom
