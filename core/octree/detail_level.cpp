// SPDX-License-Identifier: Apache-2.0
#include "core/octree/detail_level.h"
#include "core/octree/layer_fit.h"
#include "core/trace/cell_clip.h"
#include <algorithm>
#include <cmath>

namespace lightloom {
namespace {

constexpr int kAround = 2;      ///< cells to each side whose evidence counts
constexpr double kBeside = 0.1; ///< how much those beside it count for a cell's own darkness
constexpr double kChance = 0.5; ///< of the variance of photons found
/// Squared error, in variances of a child's own noise, that pays for splitting. Below 1: interpolation between leaves
/// takes off some of that noise.
constexpr double kWorthIt = 0.6;

/// What the entries of a parent say together.
struct Sum {
    double gain = 0.0, count = 0.0, found = 0.0, expected = 0.0;
    void add(const Sum& o, double weight = 1.0)
    {
        gain += weight * o.gain, count += weight * o.count;
        found += weight * o.found, expected += weight * o.expected;
    }
};

std::vector<Sum> sumsByParent(const DetailCandidates& level)
{
    const OctreeGeometry& g = *level.geometry;
    std::vector<Sum> sums(level.parents.size());
    for (std::size_t i = 0; i < g.cells.size(); ++i) {
        Sum& sum = sums[level.parentOf(i)];
        for (std::uint32_t e = g.firstEntry[i]; e < g.firstEntry[i + 1]; ++e) {
            const auto [found, expected] = level.few[e];
            sum.add(
                {static_cast<double>(level.gain[e]), 1.0, static_cast<double>(found), static_cast<double>(expected)});
        }
    }
    return sums;
}

/// The sums of the parents up to `around` cells beside parent `i`; the squared distance tells how much they count.
template<class WeightOf>
Sum sumAround(const DetailCandidates& level, const std::vector<Sum>& sums, std::size_t i, int around,
              const WeightOf& weightOf)
{
    const glm::ivec3 cell(mortonCell(level.parents[i]));
    Sum sum;
    for (int z = -around; z <= around; ++z) {
        for (int y = -around; y <= around; ++y) {
            for (int x = -around; x <= around; ++x) {
                const glm::ivec3 next = cell + glm::ivec3(x, y, z);
                if (glm::any(glm::lessThan(next, glm::ivec3(0)))) continue;
                const std::uint64_t code = mortonCode(glm::uvec3(next));
                const auto at = std::ranges::lower_bound(level.parents, code);
                if (at == level.parents.end() || *at != code) continue;
                sum.add(sums[static_cast<std::size_t>(at - level.parents.begin())], weightOf(x * x + y * y + z * z));
            }
        }
    }
    return sum;
}

/// Share of light that is left where fewer photons are found than expected: found / expected, less what chance makes of
/// it (James and Stein).
double leftOf(const Sum& sum)
{
    const double less = sum.expected - sum.found;
    if (!(less > 0.0)) return 1.0;
    return 1.0 - less / sum.expected * std::max(0.0, 1.0 - kChance * sum.expected / (less * less));
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
            geometry->take(all, e);
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

void darken(DetailCandidates& level, const std::stop_token& stop)
{
    const std::vector<Sum> sums = sumsByParent(level);
    std::vector<float> left;
    for (std::size_t i = 0; i < level.parents.size(); ++i) {
        if (i % 4096 == 0 && stop.stop_requested()) return;
        const Sum sum = sumAround(level, sums, i, 1, [](int squared) { return std::pow(kBeside, squared); });
        left.push_back(static_cast<float>(leftOf(sum)));
    }
    VdlLayer& layer = *level.layer;
    const OctreeGeometry& geometry = *level.geometry;
    for (std::size_t leaf = 0; leaf < geometry.cells.size(); ++leaf) {
        const float by = left[level.parentOf(leaf)];
        for (std::uint32_t e = geometry.firstEntry[leaf]; e < geometry.firstEntry[leaf + 1]; ++e) {
            if (!(level.few[e].expected > 0.0f)) continue;
            layer.scalar[e] *= by, layer.noise[e] *= by;
            const auto count = static_cast<std::size_t>(layer.count);
            for (Vdl& vdl : std::span(layer.vdls).subspan(e * count, count)) vdl.colour *= by;
        }
    }
}

void judge(DetailCandidates& level, const std::stop_token& stop)
{
    const std::vector<Sum> sums = sumsByParent(level);
    level.splits.assign(level.parents.size(), false);
    for (std::size_t i = 0; i < level.parents.size(); ++i) {
        if (i % 4096 == 0 && stop.stop_requested()) return;
        const Sum around = sumAround(level, sums, i, kAround, [](int) { return 1.0; });
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
