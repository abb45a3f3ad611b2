// SPDX-License-Identifier: Apache-2.0
#include "core/transport/row_order.h"
#include "core/base/rng.h"
#include <bit>
#include <unordered_map>

namespace lightloom {
namespace {

constexpr std::uint32_t kFew = 16; ///< entries of one normal, below which they stand with all others

/// The same for equal normals; where others share it, they stand together with them.
std::uint64_t keyOf(glm::vec3 normal)
{
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) key = mixBits(key ^ std::bit_cast<std::uint32_t>(normal[axis] + 0.0f));
    return key;
}

} // namespace

RowOrder::RowOrder(std::span<const Orientation> entries)
{
    std::unordered_map<std::uint64_t, std::uint32_t> numbers; // of normals, as they are met first
    std::vector<std::uint32_t> normal(entries.size()), counts;
    for (std::size_t e = 0; e < entries.size(); ++e) {
        const auto next = static_cast<std::uint32_t>(counts.size());
        normal[e] = numbers.emplace(keyOf(entries[e].normal), next).first->second;
        if (normal[e] == next) counts.push_back(0);
        ++counts[normal[e]];
    }
    std::vector<std::uint32_t> firstRow; // by normal; what few share: at the end
    std::uint32_t rows = 0;
    for (const std::uint32_t count : counts) {
        firstRow.push_back(rows);
        if (count >= kFew) rows += count;
    }
    entryOf.resize(entries.size()), rowOf.resize(entries.size() + 1), orientations.resize(entries.size());
    for (std::size_t e = 0; e < entries.size(); ++e) {
        const std::uint32_t row = counts[normal[e]] >= kFew ? firstRow[normal[e]]++ : rows++;
        entryOf[row] = static_cast<std::uint32_t>(e);
        rowOf[e] = row;
        orientations[row] = entries[e];
    }
    rowOf.back() = static_cast<std::uint32_t>(entries.size());
}

std::size_t RowOrder::memoryBytes() const
{
    return (entryOf.size() + rowOf.size()) * sizeof(std::uint32_t) + orientations.size() * sizeof(Orientation);
}

} // namespace lightloom
