// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/atlas/flat_check.h"
#include "core/base/parallel.h"
#include "core/trace/ray_scene.h"
#include <functional>

namespace lightloom {

/// A piece of surface that lies flat in the plane without folds or overlap, true to scale as a whole.
struct Chart {
    std::uint32_t instance = 0;
    std::vector<std::uint32_t> sides; ///< 2 * triangle, + 1 for its back; rising
    std::vector<glm::uvec3> corners;  ///< per side: places of the triangle's corners a, b, c, in `uv`
    std::vector<glm::vec2> uv;        ///< metres, in [0, size]; counter-clockwise as seen from the chart's side
    glm::vec2 size{0.0f};             ///< metres; the box of least area, longer side first
    Stretch stretch;
};

/// Cuts the sides of a scene's triangles (rising numbers) into charts: pieces grow Voronoi fashion until each lies flat
/// well enough: flat pieces as they are, curved ones as discs by least squares conformal maps. A piece that folds,
/// overlaps itself or is stretched too much is halved; single triangles always lie flat, so this ends. Sides without
/// area get no chart. Each instance has charts of its own. The same charts on any number of threads; empty if stopped.
/// `progress` from 0 to 1, on any worker.
[[nodiscard]] std::vector<Chart> makeCharts(const RayScene& rays, const std::vector<std::uint32_t>& sides,
                                            Workers& workers, const std::stop_token& stop,
                                            const std::function<void(double)>& progress = {});

inline constexpr double kMostStrayShare = 0.02; ///< of a chart's area may be scaled by more than kStrayScale
inline constexpr double kMostScale = 3.0;       ///< no triangle of a chart is scaled by more, or by less than 1 over it
} // namespace lightloom
