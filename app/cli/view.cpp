// SPDX-License-Identifier: Apache-2.0
#include "app/cli/view.h"
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace lightloom::cli {
namespace {

/// A scene without cameras is looked at from the front (+Z); what stands in the way, a room's wall say, is cut away.
Camera frontView(const Scene& scene, float aspect)
{
    Camera camera;
    camera.name = "front";
    const glm::vec3 size = scene.bounds.size(), centre = scene.bounds.centre();
    const float tanHalf = std::tan(0.5f * camera.yFov);
    const float distance = 0.5f * glm::max(size.y, size.x / aspect) / tanHalf;
    camera.position = {centre.x, centre.y, scene.bounds.high.z + glm::max(distance, 1e-3f * scene.bounds.diagonal())};
    camera.nearPlane = (camera.position.z - scene.bounds.high.z) + 0.01f * size.z;
    return camera;
}

} // namespace

Result<Camera> cameraNamed(const Context& context, const Scene& scene, const std::string& name, float aspect)
{
    if (scene.cameras.empty() && (name.empty() || name == "front")) {
        log(context.log, LogLevel::warning, "the scene has no camera; it is seen from the front");
        return frontView(scene, aspect);
    }
    if (name.empty()) return scene.cameras.front();
    std::vector<std::string> names;
    for (const Camera& camera : scene.cameras) {
        if (camera.name == name) return camera;
        names.push_back(camera.name);
    }
    std::size_t index = 0;
    const auto [end, code] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (code == std::errc{} && end == name.data() + name.size() && index < scene.cameras.size()) {
        return scene.cameras[index];
    }
    return Error{Error::Kind::badInput, fmt::format("there is no camera {}; the scene has {}{}", name, names.size(),
                                                    names.empty() ? "" : fmt::format(": {}", fmt::join(names, ", ")))};
}

ViewJob viewJob(const Lighting& lighting, const Camera& camera, int width, int height)
{
    const BakeParams& p = lighting.params;
    ViewJob job{camera, width, height};
    job.indirect = lighting.field                         ? ViewJob::Indirect::field
                   : lighting.method == Method::reference ? ViewJob::Indirect::paths
                                                          : ViewJob::Indirect::none;
    job.samples = p.pixelSamples;
    if (job.indirect == ViewJob::Indirect::paths) job.targetError = p.referenceStderr;
    job.directSamples = p.directSamples;
    job.gatherRays = p.probeRays;
    job.pathDepth = p.pathDepth;
    job.seed = p.seed;
    return job;
}

} // namespace lightloom::cli
