// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/compare/sweep.h"

namespace lightloom {

/// How long rows will take, learnt from those done. Before the first it goes by typical rates. Bakes are taken to
/// share photons with the row before them as they do in `sweepOrder`.
class SweepEffort {
public:
    SweepEffort(Method method, std::size_t groups) : method_(method), groups_(static_cast<double>(groups)) {}

    /// Wall seconds of making a row, both seeds, after a row with `before` (null: nothing is kept).
    [[nodiscard]] double seconds(const BakeParams& row, const BakeParams* before) const;
    /// A row took `seconds`.
    void learn(const BakeParams& row, const BakeParams* before, double seconds);

private:
    [[nodiscard]] double units(const BakeParams& row, const BakeParams* before) const;
    Method method_;
    double groups_;
    double unitsDone_ = 0, secondsDone_ = 0;
};

} // namespace lightloom
