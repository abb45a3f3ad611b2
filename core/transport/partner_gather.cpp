// SPDX-License-Identifier: Apache-2.0
#include "core/transport/partner_gather.h"
#include <algorithm>
#include <cassert>
#include <cmath>

namespace lightloom {
namespace {

constexpr std::size_t kRow = PartnerBlock::kDirections;

struct Place {
    const BlockDirections& directions;
    const Orientation* entries;
    std::size_t first, end;
    const float* values;
    float *sums, *cosines;
};

template<std::size_t kWidth, class Number>
[[gnu::always_inline]] inline void addRows(const Place& place, const Number* rows)
{
    const float *x = place.directions.x, *y = place.directions.y, *z = place.directions.z;
    for (std::size_t e = place.first; e < place.end; ++e) {
        const glm::vec3 n = place.entries[e].normal;
        float cosine[kRow];
        for (std::size_t i = 0; i < kRow; ++i) cosine[i] = std::abs(n.x * x[i] + n.y * y[i] + n.z * z[i]);
        Floats4 sum[kWidth];
        for (std::size_t w = 0; w < kWidth; ++w) sum[w] = lanesOf<Floats4>(place.sums, e * kWidth + w);
        for (std::size_t i = 0; i < kRow; ++i) {
            const std::size_t from = rows[e * kRow + i] * kWidth;
            for (std::size_t w = 0; w < kWidth; ++w) sum[w] += lanesOf<Floats4>(place.values, from + w) * cosine[i];
        }
        for (std::size_t w = 0; w < kWidth; ++w) lanesOf<Floats4>(place.sums, e * kWidth + w) = sum[w];
        Floats4 all{};
        for (std::size_t i = 0; i < kRow / 4; ++i) all += lanesOf<Floats4>(cosine, i);
        place.cosines[e] += (all[0] + all[1]) + (all[2] + all[3]);
    }
}

/// A function of its own for each width and size of numbers, for each width of the machine's vectors.
#define LIGHTLOOM_ADD_ROWS(NAME, WIDTH, NUMBER)                                                                        \
    LIGHTLOOM_EIGHT_WIDE_VECTORS void NAME(const Place& place, const NUMBER* rows) { addRows<WIDTH>(place, rows); }
LIGHTLOOM_ADD_ROWS(add1, 1, std::uint16_t)
LIGHTLOOM_ADD_ROWS(add2, 2, std::uint16_t)
LIGHTLOOM_ADD_ROWS(add3, 3, std::uint16_t)
LIGHTLOOM_ADD_ROWS(add4, 4, std::uint16_t)
LIGHTLOOM_ADD_ROWS(add1, 1, std::uint32_t)
LIGHTLOOM_ADD_ROWS(add2, 2, std::uint32_t)
LIGHTLOOM_ADD_ROWS(add3, 3, std::uint32_t)
LIGHTLOOM_ADD_ROWS(add4, 4, std::uint32_t)
#undef LIGHTLOOM_ADD_ROWS

} // namespace

BlockDirections::BlockDirections(std::span<const LineDirection> set, std::size_t block)
{
    const std::size_t first = block * kRow;
    for (std::size_t i = 0; i < kRow && first + i < set.size(); ++i) {
        const glm::vec3 unit = set[first + i].unit;
        x[i] = unit.x, y[i] = unit.y, z[i] = unit.z;
    }
}

void gatherRows(const PartnerBlock& block, const BlockDirections& directions, std::span<const Orientation> entries,
                std::size_t first, std::size_t end, const ChannelLines& values, ChannelLines& sums,
                std::vector<float>& cosines)
{
    assert(values.width == sums.width && values.width <= ChannelLines::kMostWidth && end <= entries.size());
    const Place place{directions, entries.data(), first, end, values.line(0), sums.line(0), cosines.data()};
    block.withRows([&](const auto* rows) {
        switch (values.width) {
        case 1:
            add1(place, rows);
            break;
        case 2:
            add2(place, rows);
            break;
        case 3:
            add3(place, rows);
            break;
        default:
            add4(place, rows);
            break;
        }
    });
}

} // namespace lightloom
