// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/entry_means.h"

namespace lightloom {

/// What arrives along lines (`lines`, lux), put right by what arrives along a few exact rays (`rays`): lines are off
/// alike over whole neighbourhoods where a scene is finer than its voxels, rays are right in the mean and noisy. With D
/// the mean of rays - lines around an entry and V a quarter of its variance there, of luminance, an entry gets
/// D (1 - V / D^2) more, nothing where V > D^2: as far as neighbours agree. (A quarter: were the neighbours' errors all
/// apart, the mean would have a thirteenth.) `open`: the share of each entry that is not hidden
/// (RayPartners::open), which it counts by; `rays` are of this part. None becomes negative; each light group by itself.
/// The same bits on any number of threads. Empty: stopped.
[[nodiscard]] EntryValues correctedByRays(EntryValues lines, const EntryValues& rays, const std::vector<float>& open,
                                          const EntryMeans& neighbours, Workers& workers, const std::stop_token& stop);

/// Light for the hidden part of entries, which lookups beside them would take for lit: that of the open surface around,
/// by its area. With `open` 1 an entry keeps what it has, and where nothing around is open. The same bits on any number
/// of threads. Empty: stopped.
[[nodiscard]] EntryValues spreadIntoHidden(EntryValues lux, const std::vector<float>& open,
                                           const EntryMeans& neighbours, Workers& workers, const std::stop_token& stop);

} // namespace lightloom
