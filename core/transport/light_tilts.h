// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/entry_values.h"
#include "core/transport/partner_table.h"

namespace lightloom {

/// How the light of entries leans: with V = sum of L omega over what an entry facing n sees along `directions` discrete
/// lines, the part of V / (V . n) across n, at most kMostTilt long; of a surface in the voxel that faces m the light
/// changes with m . tilt, to first order. x, y and z by light group, of luminance. `radiosity`: lm/m2 that leave each
/// entry in the end. 0 for an entry that is dark, and for a light group whose light a few entries send (`brightestOf`):
/// lines would meet them by chance. Scaled by no lamp's strength. `stored` as in `bounceLight`; the same bits with and
/// without, and on any number of threads. O(directions x entries). Empty: stopped.
[[nodiscard]] EntryValues lightTilts(const RayScene& rays, const SurfaceVoxels& voxels, const VoxelOrders& orders,
                                     const EntryValues& radiosity, int directions, Workers& workers,
                                     const std::stop_token& stop, const PartnerTable* stored = nullptr);
inline constexpr float kMostTilt = 1.0f;   ///< light from 45 degrees
inline constexpr int kTiltDirections = 64; ///< 128 and 256 do the same (docs/decisions/022)

} // namespace lightloom
