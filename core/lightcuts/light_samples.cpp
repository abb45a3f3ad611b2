// SPDX-License-Identifier: Apache-2.0
#include "core/lightcuts/light_samples.h"
#include "core/base/rng.h"
#include <algorithm>

namespace lightloom {

LightSamples::LightSamples(const LightTree& tree, std::size_t count, std::uint64_t seed)
{
    std::vector<double> upTo; // area of the lights up to and with each that is lit
    std::vector<std::uint32_t> lit;
    for (std::uint32_t i = 0; i < tree.lights().size(); ++i) {
        if (tree.fluxOf(i) == glm::vec3(0.0f)) continue;
        area_ += static_cast<double>(tree.lights()[i].area);
        upTo.push_back(area_);
        lit.push_back(i);
    }
    if (lit.empty()) return;
    for (std::size_t i = 0; i < count; ++i) {
        const double at = Rng(seed, hashName("light samples"), i).uniformDouble() * area_;
        const auto found = std::ranges::upper_bound(upTo, at) - upTo.begin();
        drawn_.push_back(lit[std::min(static_cast<std::size_t>(found), lit.size() - 1)]);
    }
}

} // namespace lightloom
