// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/light_sampler.h"
#include "core/transport/entry_values.h"
#include "core/transport/surface_voxels.h"
#include <functional>

namespace lightloom {

/// Illuminance (lux) of each entry by light of lamps that has met mirrors and glass alone on its way: what no shadow
/// ray finds. By photons that end at the first surface which scatters them (the 2009 paper, section 3: first light from
/// photons of path length one), `photons` of each of `groups` (light groups by number), red, green and blue of one
/// group after the other. Right in the mean; entries that few photons meet are noisy. Photon i of a group depends on
/// (seed, group, i) alone: the same bits on any number of threads, whatever other groups are asked for. `caught`, where
/// given: photons that arrived by such ways. Empty: stopped.
[[nodiscard]] EntryValues specularLight(const LightSampler& lights, const SurfaceVoxels& voxels,
                                        std::span<const int> groups, std::uint64_t photons, std::uint64_t seed,
                                        Workers& workers, const std::stop_token& stop, std::uint64_t* caught = nullptr,
                                        const std::function<void(double fraction)>& progress = {});

} // namespace lightloom
