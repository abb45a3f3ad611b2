// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/view_passes.h"
#include "core/trace/caustic_light.h"

/// The share of a path-traced picture that CausticLamps leave to photons. In every round each pixel looks along one
/// camera ray for the matt surfaces it shows (in mirrors, glossy metal and behind glass, too); discs there catch new
/// photons.
namespace lightloom {

/// Rounds that the job asks for: one per sample up to 256, and these with a target.
[[nodiscard]] std::uint64_t causticRounds(const ViewJob& job);

/// Goes on with the rounds until there are enough. False: stopped; a round that was not finished has left nothing.
[[nodiscard]] bool traceCaustics(const ViewPass& pass, const RayScene& rays, const CausticLamps& lamps,
                                 ViewState& state);

/// Adds what the rounds so far say to the picture, and their noise to its errors. The discs are not kept clear of
/// edges: within their radius of a corner the light of lamps in mirrors is too dark.
void addCaustics(const ViewState& state, const ViewJob& job, View& view);

} // namespace lightloom
