// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include <algorithm>
#include <cstddef>
#include <vector>

/// Sorting and selecting for lists that may be so long that a stop must be seen within.
namespace lightloom {

/// Sorts `values` on all workers: runs of a fixed length, then merges of pairs, these too in pieces of that length.
/// `less` must order strictly and totally (no two values alike), then the result is the same on any number of threads.
/// O(n log n), once more the memory. False: stopped, the order is anything.
template<class T, class Less>
[[nodiscard]] bool sortOn(Workers& workers, const std::stop_token& stop, std::vector<T>& values, Less less)
{
    constexpr std::size_t kPiece = std::size_t(1) << 14; // half a millisecond; divides the length of every run
    const std::size_t n = values.size(), pieces = (n + kPiece - 1) / kPiece;
    const auto at = [](auto& list, std::size_t i) { return list.begin() + static_cast<std::ptrdiff_t>(i); };
    const bool ordered = workers.run(pieces, stop, [&](std::size_t piece) {
        std::sort(at(values, piece * kPiece), at(values, std::min(n, (piece + 1) * kPiece)), less);
    });
    if (!ordered) return false;
    std::vector<T> merged(n > kPiece ? n : 0);
    for (std::size_t run = kPiece; run < n; run *= 2) {
        const bool all = workers.run(pieces, stop, [&](std::size_t piece) {
            const std::size_t first = piece * kPiece, last = std::min(n, first + kPiece);
            const std::size_t left = first / (2 * run) * (2 * run); // the pair of runs that this piece comes from
            const std::size_t middle = std::min(n, left + run), right = std::min(n, left + 2 * run);
            // how many of the pair's first `count` values come out of its left run
            const auto fromLeft = [&](std::size_t count) {
                std::size_t low = count > right - middle ? count - (right - middle) : 0;
                std::size_t high = std::min(count, middle - left);
                while (low < high) {
                    const std::size_t half = (low + high) / 2;
                    if (less(values[middle + count - half - 1], values[left + half]))
                        high = half;
                    else
                        low = half + 1;
                }
                return low;
            };
            const std::size_t a = fromLeft(first - left), b = fromLeft(last - left);
            std::merge(at(values, left + a), at(values, left + b), at(values, middle + (first - left - a)),
                       at(values, middle + (last - left - b)), at(merged, first), less);
        });
        if (!all) return false;
        values.swap(merged);
    }
    return true;
}

/// std::nth_element that sees a stop, `nth` before `last`: afterwards *nth is what sorting would put there, nothing
/// before it is larger and nothing behind it smaller. `less` as above, or with equal values, whose places are then
/// anybody's. O(n) typical. False: stopped, the order is anything.
template<class Iterator, class Less>
[[nodiscard]] bool selectNth(Iterator first, Iterator nth, Iterator last, Less less, const std::stop_token& stop)
{
    constexpr std::ptrdiff_t kShort = std::ptrdiff_t(1) << 20; // ten milliseconds
    while (last - first > kShort) {
        if (stop.stop_requested()) return false;
        // a pivot near the place in question, from values spread over the list
        constexpr std::ptrdiff_t kSamples = 1023;
        const std::ptrdiff_t step = (last - first) / kSamples;
        for (std::ptrdiff_t i = 0; i < kSamples; ++i) std::iter_swap(first + i, first + i * step);
        const std::ptrdiff_t rank = (nth - first) / step;
        std::nth_element(first, first + std::min(rank, kSamples - 1), first + kSamples, less);
        std::iter_swap(first, first + std::min(rank, kSamples - 1));

        // first holds the pivot; Hoare's scheme stops at equals on both sides, so that many of them split evenly
        Iterator i = first, j = last;
        std::size_t swaps = 0;
        while (true) {
            while (less(*++i, *first)) {
                if (i + 1 == last) break;
            }
            while (less(*first, *--j)) {
            }
            if (i >= j) break;
            std::iter_swap(i, j);
            if (++swaps % 65536 == 0 && stop.stop_requested()) return false;
        }
        std::iter_swap(first, j);
        if (j == nth) return true;
        if (j < nth)
            first = j + 1;
        else
            last = j;
    }
    std::nth_element(first, nth, last, less);
    return true;
}

} // namespace lightloom
