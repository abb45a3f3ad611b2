// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string_view>

namespace lightloom {

/// How photons that pass through the lattice become irradiance vectors (docs/methods/irradiance-grid.md): flux over
/// area and cosine at each face crossed, flux times way over volume in each cell passed, or as RR-6983 prints it.
enum class GridEstimator { crossings, tracks, paper };
/// How a surface's irradiance follows from the six vectors: their axial components on the axes and what harmonics say
/// between them, second-order harmonics fitted to all, axial components blended by the squared normal, or the remap
/// that RR-6983 prints.
enum class GridRemap { joined, harmonic, flux, paper };
/// Whether a finer grid lies within the grid: none, where its error is estimated largest, or in a box that is given.
enum class GridNest { off, automatic, box };
/// Interpolation between vertices.
enum class GridFilter { trilinear, bspline, catmullRom };

inline constexpr std::array<std::string_view, 3> kGridEstimatorNames{"crossings", "tracks", "paper"};
inline constexpr std::array<std::string_view, 4> kGridRemapNames{"joined", "harmonic", "flux", "paper"};
inline constexpr std::array<std::string_view, 3> kGridNestNames{"off", "auto", "box"};
inline constexpr std::array<std::string_view, 3> kGridFilterNames{"trilinear", "b-spline", "catmull-rom"};

} // namespace lightloom
