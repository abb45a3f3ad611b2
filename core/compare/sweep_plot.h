// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/compare/svg_plot.h"
#include "core/compare/sweep.h"

namespace lightloom {

/// True for each row on the Pareto front of CPU time and relRMSE.
[[nodiscard]] std::vector<bool> sweepFront(const std::vector<SweepRow>& rows);

/// Error over CPU time: a series for each value of the first parameter that varies among the rows, lines along the last
/// one, the Pareto front marked, the reference's noise as a dashed line.
[[nodiscard]] LogPlot sweepPlot(const std::vector<SweepRow>& rows, Method method, const std::string& sceneName);

/// Parameters that differ among rows, in the order of `kParams`.
[[nodiscard]] std::vector<SweepAxis> axesOf(const std::vector<SweepRow>& rows, Method method);

} // namespace lightloom
