// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/params/voxel_choices.h"
#include "core/transport/entry_values.h"
#include "core/transport/partner_table.h"

namespace lightloom {

struct BounceParams {
    int directions = 512;     ///< of the first bounce; each later one has half as many,
    int leastDirections = 64; ///< at least these
    float leastGain = .005f;  ///< a light group's bounces end when one adds less than this share,
    float seriesOff = .5f;    ///< or when a series in place of all further ones is off by this share of that; 0: never
    int mostBounces = 64;     ///< what is still missing then, and after `leastGain`, is a geometric series: it is added
    VoxelBounces order = VoxelBounces::halving; ///< `gaussSeidel` wants all directions stored
};

/// Parts of the surface that Gauss-Seidel takes in turn, as many entries each, in RowOrder: a bounce then
/// carries on at once what it has brought to the parts before. Within a part entries do not wait for each other, so
/// that threads share them.
inline constexpr std::size_t kBounceParts = 16;

/// What light does after it first leaves the surface: carried from entry to entry along discrete lines, one bounce
/// after the other (the papers of 2006 and 2009, as docs/methods/voxel-lightcuts.md has it). `radiosity`: lm/m2 that
/// leave each entry at first, reflected or emitted; `albedo`: red, green and blue of each. Gives the illuminance (lux)
/// that arrives with this light and all it becomes. What an entry receives is divided by the sum of cosines of all
/// directions that it could have come from, those where nothing was found too. Where few entries send most of a
/// group's light, their light comes by shadow rays (`brightestOf`; Gauss-Seidel looks for them at its first bounce
/// alone, which is when lamps make them). O(directions x entries).
///
/// Along directions that `stored` holds, made of the same voxels, no line is walked; along others (all, without it)
/// lines are walked anew each bounce, by several light groups together. `rays` of the same scene look where lines lose
/// their way (ExactPartners). The same bits with and without `stored`, and on any number of threads; each light group's
/// are those that it has alone. Empty: stopped. `bounces`, where given: the most that a light group took.
/// `progress` is told the share that is done, as far as that can be known, on the calling thread.
[[nodiscard]] EntryValues bounceLight(const RayScene& rays, const SurfaceVoxels& voxels, const VoxelOrders& orders,
                                      const EntryValues& radiosity, std::span<const glm::vec3> albedo,
                                      const BounceParams& params, Workers& workers, const std::stop_token& stop,
                                      int* bounces = nullptr, const PartnerTable* stored = nullptr,
                                      const std::function<void(double)>& progress = {});

} // namespace lightloom
