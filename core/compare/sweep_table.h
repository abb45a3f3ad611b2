// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/compare/sweep.h"
#include <filesystem>

/// Sweeps as tables (SWEEP.csv): one row per bake, every parameter of the method, times in seconds, memory in MiB,
/// errors as fractions. Numbers read back to the same bits.
namespace lightloom {

struct SweepTable {
    std::vector<SweepRow> rows;
    bool isDamaged = false; ///< the last line was broken off and left out
};

/// Columns of a table of `method`, in order.
[[nodiscard]] std::vector<std::string> sweepColumns(Method method);

/// With `wanted`, a last line says that so many rows were wanted and these are only the first to be done.
[[nodiscard]] std::string sweepText(const std::vector<SweepRow>& rows, Method method,
                                    std::optional<std::size_t> wanted = {});

/// A table of `method`, interrupted ones too. A last line that is broken is left out; Errors name any other line, and a
/// header that is not a sweep's of this method.
[[nodiscard]] Result<SweepTable> parseSweep(std::string_view csv, Method method);

/// What an earlier run left in `file`, if anything: rows of this plan and judge, whether the axes ask for them or not.
/// Errors: a file that is no such table, or rows of another scene, reference or program, which must not be mixed.
[[nodiscard]] Result<SweepTable> resumeSweep(const std::filesystem::path& file, const SweepPlan& plan,
                                             const Judge& judge);

/// Rows in the order of their keys in `wanted`, those that it does not name after them.
void sortLike(std::vector<SweepRow>& rows, const std::vector<std::string>& wanted);

} // namespace lightloom
