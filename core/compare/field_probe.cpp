// SPDX-License-Identifier: Apache-2.0
#include "core/compare/field_probe.h"
#include <atomic>

namespace lightloom {
namespace {

constexpr std::uint64_t kGatherStream = hashName("probe gather");
constexpr int kShadowRaysPerHit = 4; ///< hundreds of hits share the noise

} // namespace

FieldProbe::FieldProbe(const RayScene& rays, const LightSampler& lights, const IndirectField* field,
                       const BakeParams& params)
    : rays_(rays), lights_(lights), field_(field), seed_(params.seed), directSamples_(params.directSamples),
      probeRays_(params.probeRays)
{
    cached_ = [this](glm::vec3 p, glm::vec3 n, glm::vec3& lux) { return field_->lookupQuick(p, n, lux); };
}

glm::vec3 FieldProbe::direct(const ProbePoint& point) const
{
    Rng rng(seed_, point.stream, 0);
    return directIlluminance(rays_, lights_, {}, point.position, point.normal, directSamples_, rng);
}

glm::vec3 FieldProbe::indirect(const ProbePoint& point) const
{
    glm::vec3 lux(0.0f);
    if (!field_ || field_->lookup(point.position, point.normal, lux)) return lux;
    Rng rng(seed_, mixBits(point.stream ^ kGatherStream), 0);
    return gatherIndirect(rays_, lights_, {}, cached_, point.position, point.normal, probeRays_, kShadowRaysPerHit,
                          rng);
}

std::optional<std::vector<glm::vec3>> FieldProbe::indirect(const std::vector<ProbePoint>& points, Workers& workers,
                                                           const std::stop_token& stop,
                                                           const std::function<void(double)>& progress) const
{
    std::vector<glm::vec3> values(points.size());
    std::atomic<std::size_t> done = 0;
    const bool all = workers.run(points.size(), stop, [&](std::size_t i) {
        values[i] = indirect(points[i]);
        const std::size_t ended = ++done;
        if (progress) progress(static_cast<double>(ended) / static_cast<double>(points.size()));
    });
    if (!all) return {};
    return values;
}

} // namespace lightloom
