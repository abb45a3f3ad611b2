// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/light_sampler.h"

namespace lightloom {

/// Lamps whose light, where it meets a mirror or glass first, photons have to carry: from point, spot and directional
/// lamps no path can find it, to glowing surfaces under 1e-4 of the scene's squared diagonal hardly one does. Paths
/// then leave exactly this light out (PathWalk), so that nothing counts twice. Empty without mirrors and glass. Built
/// for one mix.
class CausticLamps {
public:
    CausticLamps(const RayScene& rays, const LightSampler& lights, const Mix& mix);

    [[nodiscard]] bool isEmpty() const { return chosen_.empty(); }
    [[nodiscard]] bool has(int emitter) const { return isChosen_[static_cast<std::size_t>(emitter)]; }
    /// Luminous flux of all of them as mixed, lumen in the largest channel.
    [[nodiscard]] double flux() const { return flux_; }
    /// A photon from one of them, mixed; `flux` as if it were the only one shot. False: dark at the point picked.
    [[nodiscard]] bool emit(Rng& rng, EmittedPhoton& photon) const;

private:
    struct Choice {
        int emitter;
        double sum; // chances up to and with this one
        float chance;
    };
    const LightSampler& lights_;
    Mix mix_;
    std::vector<Choice> chosen_;
    std::vector<bool> isChosen_;
    double flux_ = 0.0;
};

} // namespace lightloom
