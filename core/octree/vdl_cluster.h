// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/direction_clusters.h"
#include "core/octree/light_octree.h"
#include <span>

namespace lightloom {

/// Fits at most `out.size()` VDLs to `lights` for an entry with unit normal `n`; unused ones are black.
/// corrected (METHODS section 3): V_j = sum colour * toLight per channel; direction of the luminance-weighted V_j;
/// colour max(0, V_jc . n) / max(d_j . n, eps), so that the sum of colour * (n . d_j) is the sum of V_j . n for every
/// k. paper (2007, section 3.1.2): colour = sum of colours, direction = mean direction.
void fitVdls(std::span<const LightVector> lights, glm::vec3 n, VdlForm form, std::span<Vdl> out,
             ClusterScratch& scratch);

/// Scales the colours of corrected VDLs, channel by channel and at most fourfold, so that together they give `lux` on a
/// surface facing `n`; what is missing then comes from n itself.
/// Where photons lie on surfaces that face other ways than the entry, sums of flux over cosine are noisy and lose light
/// (figure: relRMSE .140, bias -2.6 %); the density is neither (.089, -.6 %).
void scaleTo(glm::vec3 lux, glm::vec3 n, std::span<Vdl> vdls);

/// Merges `vdls` of an entry with unit normal `n` into as few as keep, for every normal that the entry answers for (65
/// of them are looked at), each channel's illuminance within .6 `tolerance` of the largest luminance over these
/// normals, which leaves 99 % of entries within `tolerance` on any normal.
/// Gives their number, 0 if all are black; those beyond are black. On `n` itself nothing changes (corrected form).
std::size_t spendVdls(std::span<Vdl> vdls, glm::vec3 n, VdlForm form, float tolerance, ClusterScratch& scratch);

inline constexpr float kLeastCosine = 0.02f; ///< floor under cosines that are divided by

} // namespace lightloom
