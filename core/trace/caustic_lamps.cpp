// SPDX-License-Identifier: Apache-2.0
#include "core/trace/caustic_lamps.h"
#include "core/base/units.h"
#include "core/trace/material.h"

namespace lightloom {
namespace {

constexpr float kSmall = 1e-4f;    ///< area of a small lamp, in squared diagonals of the scene
constexpr double kEvenShare = 0.1; ///< of the photons; the rest by flux

bool hasMirrorsOrGlass(const Scene& scene)
{
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
        if (mayMirror(material) || mayTransmit(material)) return true;
    }
    return false;
}

bool isSmall(const RayScene& rays, const Emitter& emitter)
{
    if (emitter.kind != Emitter::Kind::surface) return true;
    const auto i = static_cast<std::uint32_t>(emitter.instance);
    double area = 0.0;
    for (std::uint32_t t = rays.firstTriangle(i); t < rays.firstTriangle(i + 1); ++t)
        area += static_cast<double>(rays.triangleArea(t));
    const float diagonal = rays.scene().bounds.diagonal();
    return area <= static_cast<double>(kSmall * diagonal * diagonal);
}

} // namespace

CausticLamps::CausticLamps(const RayScene& rays, const LightSampler& lights, const Mix& mix)
    : lights_(lights), mix_(mix), isChosen_(lights.emitters().size(), false)
{
    if (!hasMirrorsOrGlass(rays.scene())) return;
    std::vector<double> power;
    double all = 0.0;
    for (std::size_t e = 0; e < isChosen_.size(); ++e) {
        const Emitter& emitter = lights.emitters()[e];
        const glm::vec3 flux = emitter.flux * gainOf(mix_, emitter.group);
        if (!(maxChannel(flux) > 0.0f) || !isSmall(rays, emitter)) continue;
        isChosen_[e] = true;
        chosen_.push_back({static_cast<int>(e), 0.0, 0.0f});
        power.push_back(static_cast<double>(luminance(flux)));
        all += power.back();
        flux_ += static_cast<double>(maxChannel(flux));
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
        const double even = 1.0 / static_cast<double>(chosen_.size());
        const double chance = (1.0 - kEvenShare) * power[i] / all + kEvenShare * even;
        chosen_[i].sum = sum += chance;
        chosen_[i].chance = static_cast<float>(chance);
    }
}

bool CausticLamps::emit(Rng& rng, EmittedPhoton& photon) const
{
    const double at = rng.uniformDouble() * chosen_.back().sum;
    std::size_t i = 0;
    while (i + 1 < chosen_.size() && at >= chosen_[i].sum) ++i;
    const Choice& choice = chosen_[i];
    if (!lights_.emitFrom(choice.emitter, rng, photon)) return false;
    photon.flux *= gainOf(mix_, lights_.emitters()[static_cast<std::size_t>(choice.emitter)].group) / choice.chance;
    return maxChannel(photon.flux) > 0.0f;
}

} // namespace lightloom
