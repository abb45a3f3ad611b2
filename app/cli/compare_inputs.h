// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "app/cli/commands.h"
#include "core/base/image.h"
#include "core/compare/legend.h"

/// What `compare` reads: two files, or a bake that is looked at as the reference was.
namespace lightloom::cli {

/// What two files have in common to be compared by.
struct Pair {
    std::vector<double> values, reference; ///< luminances
    FloatImage a, b;                       ///< pictures: what `values` were taken from; empty for tables
    std::string what;                      ///< for people: "indirect light, 2000 points"
    LegendUnit unit = LegendUnit::plain;   ///< of `values`
    std::vector<glm::vec3> standardErrors; ///< of the reference, where it tells

    [[nodiscard]] bool isPicture() const { return !b.pixels.empty(); }
};

/// Kinds of files that can stand on either side.
enum class FileKind { table, exr, png, bake };
[[nodiscard]] Result<FileKind> kindOf(const std::string& path);

/// Tells whether the command can be followed at all, before anything is read. Error: what does not go together.
[[nodiscard]] Result<Done> checkSides(const CompareCommand& command);

/// Reads both sides. Pictures by their indirect layers if both have one, unless FLIP is asked for (`asSeen`). A bake is
/// probed at the reference's points, or rendered through the reference's camera.
[[nodiscard]] Result<Pair> readSides(const Context& context, const CompareCommand& command, bool asSeen);

} // namespace lightloom::cli
