// SPDX-License-Identifier: Apache-2.0
#include "core/transport/partner_gather.h"
#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

namespace lightloom {
namespace {

constexpr std::size_t kRow = PartnerBlock::kDirections;
constexpr std::size_t kFour = 4;   ///< rows that are summed side by side: sums do not wait for each other
constexpr std::size_t kBlocks = 4; ///< summed in one go, before sums are written

constexpr std::size_t kAhead = 16; ///< rows that are on their way to the processor: a table is larger than its caches

struct Place {
    const BlockDirections* directions;
    std::size_t blocks; // at most kBlocks
    const Orientation* rows;
    std::size_t first, end;
    const float* values;
    float *sums, *cosines;
};

/// Cosines of four rows along the directions of all blocks: of each, or one for all four, which face the same way.
struct Cosines {
    alignas(16) float of[kBlocks * kRow * kFour];
    Floats4 sums[kBlocks]; // of each row, by block: what they add up to depends on no other block
};

template<bool kAlike>
[[gnu::always_inline]] inline void findCosines(const Place& place, const Orientation* const* rows, Cosines& cosines)
{
    Floats4 x, y, z;
    for (std::size_t k = 0; k < kFour; ++k) {
        const glm::vec3 n = rows[k]->normal;
        x[k] = n.x, y[k] = n.y, z[k] = n.z;
    }
    for (std::size_t b = 0; b < place.blocks; ++b) {
        const BlockDirections& d = place.directions[b];
        Floats4 sum{};
        for (std::size_t i = 0; i < kRow; ++i) {
            const Floats4 along = x * d.x[i] + y * d.y[i] + z * d.z[i];
            const auto cosine = reinterpret_cast<Floats4>(reinterpret_cast<Ints4>(along) & 0x7FFFFFFF);
            sum += cosine;
            if constexpr (kAlike)
                cosines.of[b * kRow + i] = cosine[0];
            else
                lanesOf<Floats4>(cosines.of, b * kRow + i) = cosine;
        }
        cosines.sums[b] = sum;
    }
}

/// Four numbers of rows that follow each other, read at once where they are small.
template<class Number>
struct FourNumbers {
    explicit FourNumbers(const Number* from) : numbers(from) {}
    [[gnu::always_inline]] std::size_t operator[](std::size_t i) const { return numbers[i]; }
    const Number* numbers;
};
template<>
struct FourNumbers<std::uint16_t> {
    [[gnu::always_inline]] explicit FourNumbers(const std::uint16_t* from) { std::memcpy(&word, from, sizeof word); }
    [[gnu::always_inline]] std::size_t operator[](std::size_t i) const { return word >> (16 * i) & 0xFFFFu; }
    std::uint64_t word;
};

template<std::size_t kWidth>
[[gnu::always_inline]] inline void copy(const Floats4* from, Floats4* to)
{
    for (std::size_t w = 0; w < kWidth; ++w) to[w] = from[w];
}

/// Adds what one row sees along a direction.
template<std::size_t kWidth>
[[gnu::always_inline]] inline void addOne(const Floats4* values, std::size_t partner, float cosine, Floats4* sum)
{
    for (std::size_t w = 0; w < kWidth; ++w) sum[w] += values[partner * kWidth + w] * cosine;
}

/// Adds what some of four rows that follow each other see: direction after direction, not row after row, which the
/// compiler would rather do with a loop over rows, so that no sum waits for itself.
template<std::size_t kWidth, bool kAlike, class Number, std::size_t... kRows>
[[gnu::always_inline]] inline void addSome(const Place& place, const Number* const* blocks, std::size_t first,
                                           const Cosines& cosines, Floats4 (*sums)[kWidth],
                                           std::index_sequence<kRows...>)
{
    const auto* values = reinterpret_cast<const Floats4*>(place.values);
    Floats4 sum[sizeof...(kRows)][kWidth];
    (copy<kWidth>(sums[first + kRows], sum[kRows]), ...);
    for (std::size_t b = 0; b < place.blocks; ++b) {
        const Number* row = blocks[b] + first * kRow;
        const float* along = cosines.of + b * kRow * (kAlike ? 1 : kFour) + (kAlike ? 0 : first);
#pragma GCC unroll 1
        for (std::size_t i = 0; i < kRow; i += 4) {
            const FourNumbers<Number> numbers[] = {FourNumbers<Number>(row + kRows * kRow + i)...};
#pragma GCC unroll 4
            for (std::size_t j = 0; j < 4; ++j)
                (addOne<kWidth>(values, numbers[kRows][j], along[kAlike ? i + j : (i + j) * kFour + kRows], sum[kRows]),
                 ...);
        }
    }
    (copy<kWidth>(sum[kRows], sums[first + kRows]), ...);
}

template<std::size_t kWidth, bool kAlike, class Number>
[[gnu::always_inline]] inline void addFour(const Place& place, const Number* const* blocks, const Cosines& cosines,
                                           Floats4 (*sums)[kWidth])
{
    constexpr std::size_t kRows = kWidth > 2 ? 2 : kFour; // as many sums as there are registers for
    for (std::size_t first = 0; first < kFour; first += kRows)
        addSome<kWidth, kAlike>(place, blocks, first, cosines, sums, std::make_index_sequence<kRows>());
}

template<std::size_t kWidth, class Number>
[[gnu::always_inline]] inline void addRows(const Place& place, const Number* const* blocks)
{
    Cosines alike, each;
    const Orientation* faced = nullptr; // whose cosines `alike` holds
    for (std::size_t first = place.first; first < place.end; first += kFour) {
        const std::size_t count = std::min(kFour, place.end - first);
        const Orientation* rows[kFour];
        const Number* numbers[kBlocks];
        Number last[kBlocks][kFour * kRow]; // of fewer than four rows, which others must follow
        for (std::size_t k = 0; k < kFour; ++k) rows[k] = place.rows + first + std::min(k, count - 1);
        for (std::size_t b = 0; b < place.blocks; ++b) {
            numbers[b] = blocks[b] + first * kRow;
            for (std::size_t line = 0; line < kFour * kRow * sizeof(Number); line += 64)
                __builtin_prefetch(reinterpret_cast<const char*>(numbers[b] + kAhead * kRow) + line);
            if (count == kFour) continue;
            std::fill(std::copy_n(numbers[b], count * kRow, last[b]), std::end(last[b]), Number(0));
            numbers[b] = last[b];
        }
        Floats4 sums[kFour][kWidth] = {};
        for (std::size_t k = 0; k < count; ++k)
            for (std::size_t w = 0; w < kWidth; ++w)
                sums[k][w] = lanesOf<Floats4>(place.sums, (first + k) * kWidth + w);
        const glm::vec3 n = rows[0]->normal;
        const bool areAlike = n == rows[1]->normal && n == rows[2]->normal && n == rows[3]->normal;
        if (areAlike) {
            if (!faced || faced->normal != n) findCosines<true>(place, rows, alike);
            faced = rows[0];
            addFour<kWidth, true>(place, numbers, alike, sums);
        } else {
            findCosines<false>(place, rows, each);
            addFour<kWidth, false>(place, numbers, each, sums);
        }
        for (std::size_t k = 0; k < count; ++k) {
            for (std::size_t w = 0; w < kWidth; ++w)
                lanesOf<Floats4>(place.sums, (first + k) * kWidth + w) = sums[k][w];
            for (std::size_t b = 0; b < place.blocks; ++b)
                place.cosines[first + k] += (areAlike ? alike : each).sums[b][k];
        }
    }
}

/// A function of its own for each width and size of numbers, for each width of the machine's vectors.
#define LIGHTLOOM_ADD_ROWS(NAME, WIDTH, NUMBER)                                                                        \
    LIGHTLOOM_EIGHT_WIDE_VECTORS void NAME(const Place& place, const NUMBER* const* blocks)                            \
    {                                                                                                                  \
        addRows<WIDTH>(place, blocks);                                                                                 \
    }
LIGHTLOOM_ADD_ROWS(add1, 1, std::uint16_t)
LIGHTLOOM_ADD_ROWS(add2, 2, std::uint16_t)
LIGHTLOOM_ADD_ROWS(add3, 3, std::uint16_t)
LIGHTLOOM_ADD_ROWS(add4, 4, std::uint16_t)
LIGHTLOOM_ADD_ROWS(add1, 1, std::uint32_t)
LIGHTLOOM_ADD_ROWS(add2, 2, std::uint32_t)
LIGHTLOOM_ADD_ROWS(add3, 3, std::uint32_t)
LIGHTLOOM_ADD_ROWS(add4, 4, std::uint32_t)
#undef LIGHTLOOM_ADD_ROWS

template<class Number>
void add(const Place& place, std::size_t width, const PartnerBlock* const* blocks)
{
    const Number* rows[kBlocks] = {};
    for (std::size_t b = 0; b < place.blocks; ++b) rows[b] = blocks[b]->rows<Number>();
    switch (width) {
    case 1:
        return add1(place, rows);
    case 2:
        return add2(place, rows);
    case 3:
        return add3(place, rows);
    default:
        return add4(place, rows);
    }
}

} // namespace

BlockDirections::BlockDirections(std::span<const LineDirection> set, std::size_t block)
{
    const std::size_t first = block * kRow;
    for (std::size_t i = 0; i < kRow && first + i < set.size(); ++i) {
        const glm::vec3 unit = set[first + i].unit;
        x[i] = unit.x, y[i] = unit.y, z[i] = unit.z;
    }
}

void gatherRows(std::span<const PartnerBlock* const> blocks, std::span<const BlockDirections> directions,
                std::span<const Orientation> rows, std::size_t first, std::size_t end, const ChannelLines& values,
                ChannelLines& sums, std::vector<float>& cosines)
{
    assert(values.width == sums.width && values.width <= ChannelLines::kMostWidth && end <= rows.size());
    assert(blocks.size() == directions.size());
    for (std::size_t b = 0; b < blocks.size(); b += kBlocks) {
        const Place place{
            .directions = &directions[b],
            .blocks = std::min(kBlocks, blocks.size() - b),
            .rows = rows.data(),
            .first = first,
            .end = end,
            .values = values.line(0),
            .sums = sums.line(0),
            .cosines = cosines.data(),
        };
        if (blocks[b]->isNarrow())
            add<std::uint16_t>(place, values.width, &blocks[b]);
        else
            add<std::uint32_t>(place, values.width, &blocks[b]);
    }
}

} // namespace lightloom
