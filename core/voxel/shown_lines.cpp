// SPDX-License-Identifier: Apache-2.0
#include "core/voxel/shown_lines.h"
#include "core/transport/exact_partners.h"
#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace lightloom {
namespace {

glm::vec3 middleOf(const SurfaceVoxels& voxels, std::uint32_t voxel)
{
    return voxels.lattice.lowest + (glm::vec3(voxels.voxels[voxel]) + 0.5f) * voxels.cellSize();
}

/// First and last voxel of each line, in the order of slices.
using Ends = std::unordered_map<std::uint32_t, std::pair<std::uint32_t, std::uint32_t>>;

Ends endsOf(const WalkOrder& order, const LineNumbers& numbers)
{
    Ends ends;
    for (const VoxelPlace& place : order.places) {
        const auto [at, isNew] = ends.try_emplace(numbers.of(place), place.voxel, place.voxel);
        at->second.second = place.voxel;
    }
    return ends;
}

void addPairs(const SurfaceVoxels& voxels, std::span<const std::uint32_t> byLines, std::span<const std::uint32_t> all,
              std::uint32_t voxel, ShownLines& out)
{
    for (std::uint32_t e = voxels.firstEntry[voxel]; e < voxels.firstEntry[voxel + 1]; ++e) {
        const std::uint32_t partner = all[e];
        if (partner >= all.size()) continue;
        const bool isTold = all[partner] == e && partner < e;
        if (!isTold) out.pairs.push_back({e, partner, byLines[e] >= all.size()});
    }
}

} // namespace

ShownLines shownLines(const RayScene& rays, const SurfaceVoxels& voxels, VoxelLines how, int number, std::size_t most)
{
    ShownLines out;
    out.direction = directionSet(number + 1).back();
    const VoxelOrders orders(voxels, how);
    const std::unique_ptr<PartnerFinder> walk = partnerFinder(voxels, orders);
    const std::span<std::uint32_t> partners = walk->find(out.direction, static_cast<std::uint32_t>(number));
    const std::vector<std::uint32_t> byLines(partners.begin(), partners.end());
    if (how == VoxelLines::covered) ExactPartners(rays, voxels).complete(out.direction, partners);

    const WalkOrder& order = orders.along(out.direction.major);
    const LineNumbers numbers(out.direction, voxels.cells);
    const Ends ends = endsOf(order, numbers);
    out.allLines = ends.size();
    const double share = static_cast<double>(out.allLines) / static_cast<double>(std::max<std::size_t>(most, 1));
    out.every = std::max(1, static_cast<int>(std::ceil(std::sqrt(share))));
    const auto each = static_cast<std::uint32_t>(out.every);
    std::unordered_set<std::uint32_t> isDrawn;
    for (const VoxelPlace& place : order.places) { // in their order, that of a hash is nobody's
        const std::uint32_t line = numbers.of(place);
        if (line / numbers.width() % each != 0 || line % numbers.width() % each != 0) continue;
        addPairs(voxels, byLines, partners, place.voxel, out);
        if (!isDrawn.insert(line).second) continue;
        const auto [first, last] = ends.at(line);
        const glm::vec3 from = middleOf(voxels, first), way = middleOf(voxels, last) - from;
        const int axis = out.direction.major;
        out.lines.push_back({from, from + out.direction.unit * (way[axis] / out.direction.unit[axis])});
    }
    return out;
}

} // namespace lightloom
