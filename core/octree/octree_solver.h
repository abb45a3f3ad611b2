// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"

namespace lightloom {

/// Photons -> kd-tree -> octree of rising depth -> gather and cluster per entry; each depth is published.
class OctreeSolver final : public Solver {
public:
    Result<Done> bake(const BakeJob& job, BakeProducts& products, BakeControl& control) override;
};

} // namespace lightloom
