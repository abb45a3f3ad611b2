// SPDX-License-Identifier: Apache-2.0
#include "core/transport/exact_partners.h"
#include <algorithm>
#include <limits>

namespace lightloom {

static_assert(LinePartners::kNothing == SurfaceVoxels::kNoEntry);

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
    return voxels_.entryAt(hit.position, hit.facing());
}

} // namespace lightloom
