// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/light_sampler.h"
#include <array>

namespace lightloom {

/// Which emitter a point asks for light: mostly those that could give it much (flux over squared distance, shadows and
/// cosines unknown), one in ten evenly, so that none that shines is ever left out. With many emitters distance is
/// ignored, which keeps the cost of a choice flat. Built for one mix, then only read.
class EmitterChoice {
public:
    EmitterChoice(const LightSampler& lights, const Mix& mix);

    /// An emitter for `p` by uniform `u`, and the chance it had; -1 if nothing shines.
    [[nodiscard]] int pick(glm::vec3 p, float u, float& chance) const;
    /// The chance that `pick` takes `emitter` at `p`.
    [[nodiscard]] float chance(glm::vec3 p, int emitter) const;

private:
    static constexpr std::size_t kMostWeighed = 32;
    struct Candidate {
        int emitter = 0;
        float power = 0.0f;     ///< luminance of flux / 4 pi, as the mix sets it; lux for directional lights
        bool isDistant = false; ///< directional
    };
    using Weights = std::array<float, kMostWeighed>;
    /// Share that goes by merit for each candidate, summing to 1. Only when there are at most kMostWeighed.
    void weigh(glm::vec3 p, Weights& weights) const;

    const LightSampler& lights_;
    std::vector<Candidate> candidates_;
    std::vector<int> candidateOf_; ///< by emitter, -1 where dark
    std::vector<double> sums_;     ///< of power, for the flat choice
};

} // namespace lightloom
