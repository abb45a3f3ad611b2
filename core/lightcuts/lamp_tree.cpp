// SPDX-License-Identifier: Apache-2.0
#include "core/lightcuts/lamp_tree.h"

namespace lightloom {
namespace {

float areaOf(const RayScene& rays, int instance)
{
    const auto number = static_cast<std::uint32_t>(instance);
    float area = 0.0f;
    for (std::uint32_t t = rays.firstTriangle(number); t < rays.triangleCount() && rays.triangle(t).instance == number;
         ++t)
        area += rays.triangleArea(t);
    return area;
}

} // namespace

std::shared_ptr<const LightTree> lampTree(const LightSampler& lights, const Mix& mix, int samples, std::uint64_t seed,
                                          bool* hasOthers)
{
    std::vector<DiscLight> discs;
    std::vector<glm::vec3> exitance;
    if (hasOthers) *hasOthers = false;
    for (std::size_t e = 0; e < lights.emitters().size(); ++e) {
        const Emitter& emitter = lights.emitters()[e];
        const glm::vec3 gain = gainOf(mix, emitter.group);
        if (emitter.kind != Emitter::Kind::surface) {
            if (hasOthers && gain * emitter.flux != glm::vec3(0.0f)) *hasOthers = true;
            continue;
        }
        const float area = areaOf(*lights.rays(), emitter.instance) / static_cast<float>(samples);
        for (int i = 0; i < samples; ++i) {
            Rng rng(seed, hashName("lamp tree") + e, static_cast<std::uint64_t>(i));
            EmittedPhoton photon;
            if (!lights.emitFrom(static_cast<int>(e), rng, photon)) continue;
            discs.push_back({photon.position, area, photon.side});
            exitance.push_back(gain * photon.flux / (static_cast<float>(samples) * area));
        }
    }
    return LightTree::build(discs, exitance, 0.0f, seed);
}

} // namespace lightloom
