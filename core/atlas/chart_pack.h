// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/atlas/charts.h"

namespace lightloom {

/// Charts are placed by blocks of 4 x 4 texels, which are single texels of mip 2. A chart owns every block that lies
/// within kPadding texels of it: all that lookups with bilinear filtering read on its surface, in mips 0, 1 and 2.
inline constexpr int kBlock = 4, kPadding = 2;

/// Where a chart lies.
struct ChartPlace {
    glm::ivec2 block{0};   ///< of its low corner; the chart's own box begins kPadding texels from it
    bool isTurned = false; ///< by a quarter
    /// Texel coordinates of a point of the chart.
    [[nodiscard]] glm::dvec2 texel(const Chart& chart, glm::vec2 uv, double texelsPerMetre) const
    {
        const glm::dvec2 p = isTurned ? glm::dvec2(chart.size.y - uv.y, uv.x) : glm::dvec2(uv);
        return p * texelsPerMetre + double(kPadding) + glm::dvec2(block * kBlock);
    }
};

struct Packing {
    int side = 0; ///< blocks along each side of the square
    double texelsPerMetre = 0.0;
    std::vector<ChartPlace> places;  ///< by chart
    std::vector<std::int32_t> owner; ///< chart of each block, row by row; -1: none
    [[nodiscard]] int texels() const { return side * kBlock; }
};

/// Blocks at the low corner that no chart gets: they stay black, for faces that light never reaches.
inline constexpr int kVoidBlocks = 2;

/// Places all charts at a scale, by first fit from the top, the largest first, turned by a quarter where that fits
/// earlier. Nothing if they do not fit, or if stopped.
[[nodiscard]] std::optional<Packing> pack(const std::vector<Chart>& charts, int side, double texelsPerMetre,
                                          const std::stop_token& stop);

/// The same at the largest scale that fits into `side` blocks, found by halving to within 1 %.
[[nodiscard]] std::optional<Packing> packIntoSide(const std::vector<Chart>& charts, int side,
                                                  const std::stop_token& stop);

} // namespace lightloom
