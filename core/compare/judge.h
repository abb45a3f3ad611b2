// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/compare/image_error.h"
#include "core/compare/probes.h"
#include "core/compare/reference_store.h"
#include "core/field/bake_products.h"

namespace lightloom {

/// What a method's result is held against: probe points and the indirect light that a reference found there.
struct Judge {
    std::vector<ProbePoint> points;
    std::vector<double> reference;     ///< luminance of the indirect light, lux
    std::vector<double> standardError; ///< of `reference`, luminance; all 0 where the reference does not tell
    double mean = 0;                   ///< of `reference`
    double noise = 0;                  ///< sqrt(mean(standardError^2)) / mean
    std::string digest;                ///< of points and reference: equal digests judge alike
};

/// Accuracy figures everywhere mean these points (DESIGN): area-uniform over the surface that light can reach.
inline constexpr std::uint64_t kJudgePoints = 2000, kJudgeSeed = 1;

/// The rows that `lightloom-cli points` writes: `count` points in the scene file's frame.
[[nodiscard]] std::vector<ProbeRow> probeRows(const SceneProducts& at, std::uint64_t count, std::uint64_t seed);

/// A judge from a reference's table. Errors: no points in it, a reference that is black or negative.
[[nodiscard]] Result<Judge> judgeFrom(const ProbeTable& table, const Scene& scene);

/// A judge traced now (or found in `store`) at `rows`; noise of a probe at most `job.targetError` of the mean, if
/// `job.paths` allow it. Error also when stopped.
[[nodiscard]] Result<Judge> traceJudge(const SceneProducts& at, const std::vector<ProbeRow>& rows,
                                       const ReferenceJob& job, const ReferenceStore& store, Workers& workers,
                                       const std::stop_token& stop,
                                       const std::function<void(double fraction)>& progress = {}, const Mix& mix = {});

/// Noise and bias of a method, told apart by bakes of two seeds, E1 and E2, against a reference R with standard errors
/// s (means over the points, m the mean of R). What differs between the seeds is noise; what they share is not:
///   noise^2      = mean((E1 - E2)^2) / 2 / m^2
///   systematic^2 = mean((E1 - R) (E2 - R)) / m^2 - mean(s^2) / m^2, not below 0
/// The product is free of the bakes' noise, since the seeds are independent; the reference's own error stands in both
/// factors alike and is subtracted. The mean of both squared errors is noise^2 + systematic^2 + mean(s^2) / m^2.
struct ErrorSplit {
    double noise = 0;      ///< random part of relRMSE; another seed gives another one
    double systematic = 0; ///< local bias, root mean square: blur, cells, leaks; the same for every seed
};
[[nodiscard]] ErrorSplit splitError(std::span<const double> e1, std::span<const double> e2, const Judge& judge);

/// A mean of squares over the points, over the square of the mean light.
struct MeanSquare {
    double value = 0;
    double sigma = 0; ///< standard error from the noise of what was measured at these points
};

/// The squares behind `splitError`. `systematic` is not cut off at 0, so that it is unbiased and may be averaged.
struct SplitSquares {
    MeanSquare noise, systematic;
    double systematicSpread = 0; ///< standard error of `systematic` from having these points and not others
};
/// With the same values twice, `systematic` is relRMSE^2 of that one result.
[[nodiscard]] SplitSquares splitSquares(std::span<const double> e1, std::span<const double> e2, const Judge& judge);

} // namespace lightloom
