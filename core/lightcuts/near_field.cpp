// SPDX-License-Identifier: Apache-2.0
#include "core/lightcuts/near_field.h"
#include "core/base/low_discrepancy.h"
#include "core/base/sampling.h"

namespace lightloom {

glm::vec3 gatherNear(const RayScene& rays, const NearField& field, const Receiver& at, const NearRange& range,
                     int count, std::uint64_t seed, std::uint64_t number, std::vector<CutLight>* seen)
{
    glm::vec3 sum(0.0f);
    if (count < 1 || range.isEmpty()) return sum;
    Rng rng(seed, hashName("near field"), number);
    const ShiftedPoints points(count, rng);
    const Frame frame(at.normal);
    const glm::vec3 origin = rays.leave(at.position, at.normal);
    for (int i = 0; i < count; ++i) {
        const glm::vec3 travel = frame.toWorld(sampleCosineHemisphere(points[i].x, points[i].y));
        Hit hit;
        if (!rays.intersect(origin, travel, range.outer, hit)) continue;
        // each ray stands for pi / count of cosine and solid angle, and a surface shows exitance / pi
        const glm::vec3 lux =
            range.shareOfRays(hit.distance) / static_cast<float>(count) * glm::max(field.exitance(hit), 0.0f);
        if (!isFinite(lux)) continue;
        sum += lux;
        if (seen && lux != glm::vec3(0.0f)) seen->push_back({travel, lux});
    }
    return sum;
}

} // namespace lightloom
