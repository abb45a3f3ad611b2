// SPDX-License-Identifier: Apache-2.0
#include "core/bake/render_view.h"
#include "core/bake/view_passes.h"
#include "core/trace/material.h"
#include <limits>

namespace lightloom {
namespace {

/// Of one pixel.
glm::vec3 reflectanceAt(const RayScene& rays, const ViewJob& job, const Lens& lens, int x, int y)
{
    const std::size_t pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(job.width) + static_cast<std::size_t>(x);
    glm::vec3 sum(0.0f), origin, travel;
    for (int s = 0; s < job.samples; ++s) {
        lens.ray(x, y, placeInPixel(job, pixel, static_cast<std::uint64_t>(s), job.samples), origin, travel);
        Hit hit;
        if (!rays.intersect(origin, travel, std::numeric_limits<float>::infinity(), hit)) continue;
        const Surface surface = surfaceAt(rays, hit);
        if (surface.isSeenInto()) return glm::vec3(0.0f);
        sum += surface.diffuse;
    }
    return sum / static_cast<float>(job.samples);
}

} // namespace

FloatImage mattReflectance(const RayScene& rays, const ViewJob& job, Workers& workers, const std::stop_token& stop)
{
    FloatImage image(job.width, job.height);
    const Lens lens(job);
    const bool isWhole = workers.run(static_cast<std::size_t>(job.height), stop, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < job.width; ++x) image.at(x, y) = reflectanceAt(rays, job, lens, x, y);
    });
    return isWhole ? image : FloatImage();
}

} // namespace lightloom
