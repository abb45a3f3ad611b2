// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/field/bake_control.h"
#include "core/field/bake_products.h"

namespace lightloom {

/// What to bake. Lamps whose gain in `mix` is zero in all channels are off: they are not shot and get no layer.
struct BakeJob {
    std::shared_ptr<const Scene> scene;
    BakeParams params;
    Mix mix; ///< one gain per light group; empty: all 1
    Isa isa = Isa::automatic;
    bool roughFirst = false;  ///< publish a rough picture from a few photons before anything else; for windows
    std::uint64_t serial = 0; ///< given by the session
};

/// One method. Runs on the bake worker and owns no thread.
class Solver {
public:
    virtual ~Solver() = default;
    /// Publishes each refinement, coarse first, the last one marked final. Returns when done, or soon after a stop (an
    /// Error of kind cancelled; what was published stays valid).
    virtual Result<Done> bake(const BakeJob& job, BakeProducts& products, BakeControl& control) = 0;
};

} // namespace lightloom
