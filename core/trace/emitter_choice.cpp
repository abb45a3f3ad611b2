// SPDX-License-Identifier: Apache-2.0
#include "core/trace/emitter_choice.h"
#include "core/base/units.h"
#include "core/trace/direct_light.h"
#include <algorithm>

namespace lightloom {
namespace {
constexpr float kEvenShare = 0.1f;
}

EmitterChoice::EmitterChoice(const LightSampler& lights, const Mix& mix)
    : lights_(lights), candidateOf_(lights.emitters().size(), -1)
{
    double sum = 0.0;
    for (std::size_t e = 0; e < candidateOf_.size(); ++e) {
        const Emitter& emitter = lights.emitters()[e];
        const glm::vec3 gain = gainOf(mix, emitter.group);
        const bool isSurface = emitter.kind == Emitter::Kind::surface; // a texture may shine where its mean missed
        if (maxChannel(gain) <= 0.0f || (!isSurface && maxChannel(gain * emitter.flux) <= 0.0f)) continue;
        Candidate c;
        c.emitter = static_cast<int>(e);
        c.isDistant = emitter.kind == Emitter::Kind::directional;
        c.power = glm::max(0.0f, luminance(gain * emitter.flux)) / (4.0f * kPi);
        candidateOf_[e] = static_cast<int>(candidates_.size());
        candidates_.push_back(c);
        sums_.push_back(sum += static_cast<double>(c.power));
    }
}

void EmitterChoice::weigh(glm::vec3 p, Weights& weights) const
{
    float sum = 0.0f;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
        const Emitter& emitter = lights_.emitters()[static_cast<std::size_t>(candidates_[i].emitter)];
        float w = candidates_[i].power;
        if (emitter.kind == Emitter::Kind::surface) {
            const glm::vec3 d = emitter.centre - p;
            w /= glm::dot(d, d) + emitter.spreadSquared;
        } else { // the very illuminance, so that a spot that looks away is not asked
            LightSample s;
            const bool arrives = lights_.sample(candidates_[i].emitter, p, glm::vec2(0.0f), s);
            const float lumen = glm::max(luminance(emitter.flux), 1e-30f);
            w = arrives ? luminance(s.illuminance) * (4.0f * kPi * candidates_[i].power / lumen) : 0.0f;
        }
        sum += weights[i] = w;
    }
    const float even = 1.0f / static_cast<float>(candidates_.size());
    // nothing adds up, or too much: evenly
    const bool isUsable = sum > 0.0f && sum < std::numeric_limits<float>::max();
    for (std::size_t i = 0; i < candidates_.size(); ++i) weights[i] = isUsable ? weights[i] / sum : even;
}

int EmitterChoice::pick(glm::vec3 p, float u, float& chance) const
{
    if (candidates_.empty()) return -1;
    if (candidates_.size() == 1) {
        chance = 1.0f;
        return candidates_[0].emitter;
    }
    const float even = kEvenShare / static_cast<float>(candidates_.size());
    std::size_t i = 0;
    if (u < kEvenShare) {
        i = std::min(static_cast<std::size_t>(u / even), candidates_.size() - 1);
    } else if (candidates_.size() <= kMostWeighed) {
        Weights weights;
        weigh(p, weights);
        float at = (u - kEvenShare) / (1.0f - kEvenShare);
        while (i + 1 < candidates_.size() && at >= weights[i]) at -= weights[i++];
        chance = (1.0f - kEvenShare) * weights[i] + even;
        return candidates_[i].emitter;
    } else {
        const double at = static_cast<double>((u - kEvenShare) / (1.0f - kEvenShare)) * sums_.back();
        i = static_cast<std::size_t>(std::upper_bound(sums_.begin(), sums_.end(), at) - sums_.begin());
        i = std::min(i, candidates_.size() - 1);
    }
    chance = this->chance(p, candidates_[i].emitter);
    return candidates_[i].emitter;
}

float EmitterChoice::chance(glm::vec3 p, int emitter) const
{
    const int found = candidateOf_[static_cast<std::size_t>(emitter)];
    if (found < 0) return 0.0f;
    if (candidates_.size() == 1) return 1.0f;
    const auto i = static_cast<std::size_t>(found);
    const auto count = static_cast<float>(candidates_.size());
    float merit = 1.0f / count;
    if (candidates_.size() <= kMostWeighed) {
        Weights weights;
        weigh(p, weights);
        merit = weights[i];
    } else if (sums_.back() > 0.0) {
        merit = static_cast<float>(static_cast<double>(candidates_[i].power) / sums_.back());
    }
    return (1.0f - kEvenShare) * merit + kEvenShare / count;
}

} // namespace lightloom
