// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/light_flood.h"
#include "core/trace/light_sampler.h"
#include <functional>

namespace lightloom {

/// What the lamps of one light group shine on themselves. Borrows all it is made with. Any thread.
class LampLight {
public:
    LampLight(const RayScene& rays, const SideElements& elements, const Scene& scene, const LightSampler& lights,
              int group);

    /// Photons `first` to `end` as far as the surface they fall on; `use` gets the random numbers that follow, too.
    void firstHits(std::uint64_t first, std::uint64_t end,
                   const std::function<void(const OpenPoint& hit, Rng& rng)>& use) const;

    /// Points that the lamps shine on, at least one on each element that they shine on and that is not in `known` (by
    /// element). The same on any number of threads. False: stopped.
    [[nodiscard]] bool findOutside(std::vector<std::uint8_t> known, Workers& workers, const std::stop_token& stop,
                                   std::vector<OpenPoint>& points) const;

private:
    void findLit(std::uint32_t element, std::vector<OpenPoint>& found) const;

    const RayScene& rays_;
    const SideElements& elements_;
    const LightSampler& lights_;
    int group_;
    std::uint64_t stream_;
};

} // namespace lightloom
