// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/compare/judge.h"
#include "core/compare/sweep_axis.h"
#include "core/field/solver.h"
#include <array>

/// A sweep: one method baked with many parameters, each bake timed and judged. Bakes share what they can (photons are
/// not shot again when only K changes); a row's cost is what its bake would cost alone, since kept products carry their
/// cost along.
namespace lightloom {

/// What is to be swept. Ends in rows, not in pictures; lamps as the scene has them.
struct SweepPlan {
    std::shared_ptr<const Scene> scene;
    Method method = Method::lightOctree; ///< one that can be baked
    Isa isa = Isa::automatic;
    BakeParams base;             ///< values of all parameters that no axis varies
    std::vector<SweepAxis> axes; ///< none: one row, `base`
    std::string program;         ///< version; rows of another one are not taken for ours
};

/// Parts of a bake that stages are summed up to.
enum class SweepPart { prepare, shoot, tree, build, gather, other };
inline constexpr std::array<std::string_view, 6> kSweepPartNames{"prepare", "shoot",  "tree",
                                                                 "build",   "gather", "other"};
/// Part that a stage's name (`StageCost::stage`) belongs to.
[[nodiscard]] SweepPart sweepPart(std::string_view stage);

struct PartCost {
    double wallSeconds = 0, cpuSeconds = 0;
};

/// One row: parameters, cost, error. Costs are means over the bakes of two seeds; the error figures are those of the
/// first seed, the one in `params`: exactly what `compare` gives for that bake. `split` comes from both (judge.h).
struct SweepRow {
    BakeParams params;
    int threads = 0; ///< that the wall times are of
    std::array<PartCost, kSweepPartNames.size()> parts{};
    double processPeakMiB =
        0;               ///< most memory the whole program held while the row was made, kept products and reference
                         ///< included; where the system cannot forget an older peak, since the program began
    double fieldMiB = 0; ///< the result alone
    ErrorMetrics error;
    ErrorSplit split;
    double referenceNoise = 0; ///< `Judge::noise`
    std::string key;           ///< `SweepKeys`

    [[nodiscard]] double wallSeconds() const;
    [[nodiscard]] double cpuSeconds() const; ///< of all threads
};

/// What a row depends on, as a short hash: equal keys mean the same figures but for times and memory.
class SweepKeys {
public:
    SweepKeys(const SweepPlan& plan, const Judge& judge);
    [[nodiscard]] std::string of(const BakeParams& params) const;

private:
    std::string common_; ///< scene, method, instruction set, program, judge
    Method method_;
};

/// The second seed of a row.
[[nodiscard]] std::uint64_t otherSeed(std::uint64_t seed);

/// Bakes the rows of `plan` that `known` does not hold and hands each to `onRow` as soon as it is done (on the calling
/// thread, in `sweepOrder`). Stop and pause through `control`; its progress covers the rows to be baked, with the
/// remaining time estimated from those done. `products` may be another bake's. Errors: a method that cannot be baked;
/// what bakes say, with the row's place; cancelled. Rows handed over stay good.
Result<Done> runSweep(const SweepPlan& plan, const Judge& judge, const std::vector<SweepRow>& known,
                      BakeProducts& products, BakeControl& control, const std::function<void(SweepRow)>& onRow);

/// "photons=150000 gather.count=50": the row's values of the plan's axes.
[[nodiscard]] std::string axesText(const std::vector<SweepAxis>& axes, const BakeParams& params);

} // namespace lightloom
