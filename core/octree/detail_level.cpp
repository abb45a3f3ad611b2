// SPDX-License-Identifier: Apache-2.0
#include "core/octree/detail_level.h"
#include "core/octree/layer_fit.h"
#include "core/trace/cell_clip.h"
#include <algorithm>

namespace lightloom {
namespace {

constexpr int kAround = 2; ///< cells to each side whose evidence counts
/// Squared error, in variances of a child's own noise, that pays for splitting. Below 1: interpolation between leaves
/// takes off some of that noise.
constexpr double kWorthIt = 0.6;

struct Sum {
    double gain = 0.0, count = 0.0;
    Sum& operator+=(const Sum& o)
    {
        gain += o.gain, count += o.count;
        return *this;
    }
};

std::vector<Sum> sumsByParent(const DetailCandidates& level)
{
    const OctreeGeometry& g = *level.geometry;
    std::vector<Sum> sums(level.parents.size());
    for (std::size_t i = 0; i < g.cells.size(); ++i) {
        Sum& sum = sums[level.parentOf(i)];
        for (std::uint32_t e = g.firstEntry[i]; e < g.firstEntry[i + 1]; ++e)
            sum += {static_cast<double>(level.gain[e]), 1.0};
    }
    return sums;
}

/// The leaves whose parents are split.
DetailLevel kept(const DetailCandidates& level)
{
    const OctreeGeometry& all = *level.geometry;
    auto geometry = std::make_shared<OctreeGeometry>();
    geometry->depth = all.depth, geometry->lowest = all.lowest, geometry->rootSize = all.rootSize;
    auto layer = std::make_shared<VdlLayer>();
    layer->group = level.layer->group, layer->count = level.layer->count;
    layer->tolerance = level.layer->tolerance;
    for (std::size_t i = 0; i < all.cells.size(); ++i) {
        if (!level.splits[level.parentOf(i)]) continue;
        geometry->cells.push_back(all.cells[i]);
        geometry->firstEntry.push_back(static_cast<std::uint32_t>(geometry->entries.size()));
        for (std::uint32_t e = all.firstEntry[i]; e < all.firstEntry[i + 1]; ++e) {
            geometry->entries.push_back(all.entries[e]);
            layer->scalar.push_back(level.layer->scalar[e]);
            layer->noise.push_back(level.layer->noise[e]);
            const std::span<const Vdl> lights = level.layer->of(e);
            layer->vdls.insert(layer->vdls.end(), lights.begin(), lights.end());
        }
    }
    geometry->firstEntry.push_back(static_cast<std::uint32_t>(geometry->entries.size()));
    dropUnused(*layer);
    return {geometry, layer};
}

} // namespace

std::size_t DetailCandidates::parentOf(std::size_t leaf) const
{
    const auto at = std::ranges::lower_bound(parents, geometry->cells[leaf] >> 3);
    return static_cast<std::size_t>(at - parents.begin());
}

void judge(DetailCandidates& level)
{
    const std::vector<Sum> sums = sumsByParent(level);
    level.splits.assign(level.parents.size(), false);
    for (std::size_t i = 0; i < level.parents.size(); ++i) {
        const glm::ivec3 cell(mortonCell(level.parents[i]));
        Sum around;
        for (int z = -kAround; z <= kAround; ++z) {
            for (int y = -kAround; y <= kAround; ++y) {
                for (int x = -kAround; x <= kAround; ++x) {
                    const glm::ivec3 next = cell + glm::ivec3(x, y, z);
                    if (glm::any(glm::lessThan(next, glm::ivec3(0)))) continue;
                    const std::uint64_t code = mortonCode(glm::uvec3(next));
                    const auto at = std::ranges::lower_bound(level.parents, code);
                    if (at != level.parents.end() && *at == code)
                        around += sums[static_cast<std::size_t>(at - level.parents.begin())];
                }
            }
        }
        level.splits[i] = around.gain > kWorthIt * around.count;
    }
}

LampDetail splitLeaves(std::vector<DetailCandidates>& levels)
{
    for (std::size_t l = levels.size(); l-- > 1;) {
        std::vector<std::uint64_t>& above = levels[l - 1].parents;
        for (std::size_t i = 0; i < levels[l].parents.size(); ++i) {
            if (!levels[l].splits[i]) continue;
            const auto at = std::ranges::lower_bound(above, levels[l].parents[i] >> 3);
            levels[l - 1].splits[static_cast<std::size_t>(at - above.begin())] = true;
        }
    }
    LampDetail detail;
    for (const DetailCandidates& level : levels) {
        DetailLevel some = kept(level);
        if (some.geometry->cells.empty()) break;
        detail.push_back(std::move(some));
    }
    return detail;
}

} // namespace lightloom
