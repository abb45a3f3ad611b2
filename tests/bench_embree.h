// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/parallel.h"
#include "core/trace/ray_scene.h"
#include <embree3/rtcore.h>
#include <limits>
#include <vector>

namespace lightloom {

/// Rays one by one through bare rtcIntersect1: what benches compare with. How many hit.
inline double bareEmbree(const RayScene& rays, const std::vector<Ray>& recorded)
{
    const FlushDenormals flush;
    const auto tree = static_cast<RTCScene>(rays.embreeScene());
    double sum = 0.0;
    for (const Ray& ray : recorded) {
        RTCRayHit query;
        query.ray = {ray.origin.x,
                     ray.origin.y,
                     ray.origin.z,
                     0.0f,
                     ray.travel.x,
                     ray.travel.y,
                     ray.travel.z,
                     0.0f,
                     std::numeric_limits<float>::infinity(),
                     0xFFFFFFFFu,
                     0,
                     0};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(tree, &context, &query);
        sum += query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? 0.0 : 1.0;
    }
    return sum;
}

} // namespace lightloom
