// SPDX-License-Identifier: Apache-2.0
#include "core/octree/detail_union.h"
#include <algorithm>

namespace lightloom {
namespace {

const OctreeGeometry* geometryOf(const std::shared_ptr<const LampDetail>& detail, std::size_t level)
{
    return detail && level < detail->size() ? (*detail)[level].geometry.get() : nullptr;
}

/// Appends leaf `i` of `from` with its entries.
void copyLeaf(const OctreeGeometry& from, std::size_t i, OctreeGeometry& to)
{
    to.cells.push_back(from.cells[i]);
    to.firstEntry.push_back(static_cast<std::uint32_t>(to.entries.size()));
    to.entries.insert(to.entries.end(), from.entries.begin() + from.firstEntry[i],
                      from.entries.begin() + from.firstEntry[i + 1]);
}

OctreeGeometry unite(const std::vector<const OctreeGeometry*>& parts)
{
    OctreeGeometry all;
    std::vector<std::size_t> next(parts.size(), 0);
    while (true) {
        const OctreeGeometry* lowest = nullptr; // whose next leaf comes first
        std::size_t leaf = 0;
        for (std::size_t g = 0; g < parts.size(); ++g) {
            if (!parts[g] || next[g] == parts[g]->cells.size()) continue;
            if (!lowest || parts[g]->cells[next[g]] < lowest->cells[leaf]) lowest = parts[g], leaf = next[g];
        }
        if (!lowest) break;
        const std::uint64_t cell = lowest->cells[leaf];
        copyLeaf(*lowest, leaf, all);
        for (std::size_t g = 0; g < parts.size(); ++g) {
            if (parts[g] && next[g] < parts[g]->cells.size() && parts[g]->cells[next[g]] == cell) ++next[g];
        }
    }
    all.firstEntry.push_back(static_cast<std::uint32_t>(all.entries.size()));
    return all;
}

std::vector<std::int32_t> numbersIn(const OctreeGeometry& part, const OctreeGeometry& all)
{
    std::vector<std::int32_t> numbers(all.entries.size(), -1);
    std::size_t i = 0;
    for (std::size_t leaf = 0; leaf < part.cells.size(); ++leaf) {
        while (all.cells[i] != part.cells[leaf]) ++i;
        const std::uint32_t to = all.firstEntry[i], from = part.firstEntry[leaf];
        for (std::uint32_t e = 0; from + e < part.firstEntry[leaf + 1]; ++e)
            numbers[to + e] = static_cast<std::int32_t>(from + e);
    }
    return numbers;
}

} // namespace

std::vector<UnionLevel> uniteDetails(const OctreeGeometry& base,
                                     const std::vector<std::shared_ptr<const LampDetail>>& details)
{
    std::vector<UnionLevel> levels;
    while (true) {
        std::vector<const OctreeGeometry*> parts;
        for (const auto& detail : details) parts.push_back(geometryOf(detail, levels.size()));
        if (std::ranges::all_of(parts, [](const OctreeGeometry* part) { return !part; })) return levels;
        UnionLevel level;
        level.geometry = unite(parts);
        level.geometry.depth = base.depth + 1 + static_cast<int>(levels.size());
        level.geometry.lowest = base.lowest, level.geometry.rootSize = base.rootSize;
        for (const OctreeGeometry* part : parts)
            level.own.push_back(part ? numbersIn(*part, level.geometry) : std::vector<std::int32_t>());
        levels.push_back(std::move(level));
    }
}

} // namespace lightloom
