// SPDX-License-Identifier: Apache-2.0
#include "core/transport/exact_partners.h"
#include <algorithm>
#include <limits>

namespace lightloom {

void ExactPartners::complete(const LineDirection& direction, std::span<std::uint32_t> partners) const
{
    const auto without = static_cast<std::size_t>(std::ranges::count(partners, LinePartners::kNothing));
    if (without > partners.size() / 20) return;
    for (std::size_t e = 0; e < partners.size(); ++e) {
        if (partners[e] != LinePartners::kNothing) continue;
        const float cosine = glm::dot(voxels_.entries[e].normal, direction.unit);
        if (glm::abs(cosine) > kAlongSurface)
            partners[e] = seenFrom(voxels_.entries[e], cosine > 0.0f ? direction.unit : -direction.unit);
    }
}

std::uint32_t ExactPartners::seenFrom(const Orientation& entry, glm::vec3 towards) const
{
    Hit hit;
    const glm::vec3 origin = rays_.leave(entry.centroid, entry.normal);
    if (!rays_.intersect(origin, towards, std::numeric_limits<float>::infinity(), hit)) return LinePartners::kNothing;
    const std::size_t voxel = voxels_.voxelAt(hit.position, hit.facing());
    if (voxel == voxels_.voxels.size()) return LinePartners::kNothing;
    std::uint32_t best = LinePartners::kNothing;
    float bestCosine = 0.0f;
    for (std::uint32_t e = voxels_.firstEntry[voxel]; e < voxels_.firstEntry[voxel + 1]; ++e) {
        const float cosine = glm::dot(voxels_.entries[e].normal, hit.facing());
        if (cosine > bestCosine) bestCosine = cosine, best = e;
    }
    return best;
}

} // namespace lightloom
