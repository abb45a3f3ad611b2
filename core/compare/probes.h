// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/reference.h"
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Probe points and their light in text tables (DESIGN, command line). Comma-separated, first line the header, numbers
/// written as the shortest text that reads back to the same bits. Errors name the line.
namespace lightloom {

/// A row as its file has it: position in the scene file's frame, metres; normal of any length but zero.
struct ProbeRow {
    glm::dvec3 position{0.0}, normal{0.0};
    bool operator==(const ProbeRow&) const = default;
};

/// Columns `x,y,z,nx,ny,nz`. Errors: another header, a row that is not six finite numbers, a zero normal.
[[nodiscard]] Result<std::vector<ProbeRow>> parsePoints(std::string_view csv);
[[nodiscard]] Result<std::vector<ProbeRow>> readPoints(const std::filesystem::path& path);
[[nodiscard]] std::string pointsText(const std::vector<ProbeRow>& rows);

/// The point in scene space, normal made unit. Its random stream depends on the row's own six numbers alone, so that a
/// row gives the same light in any file, at any place in it.
[[nodiscard]] ProbePoint inScene(const Scene& scene, const ProbeRow& row);

/// Light at probes, lux per channel. All filled vectors have the same length.
struct ProbeTable {
    std::vector<ProbeRow> points; ///< empty if the table has no positions
    std::vector<glm::vec3> direct, indirect;
    std::vector<glm::vec3> standardError; ///< of direct + indirect; empty but for `reference`
    std::vector<glm::vec3> caustic;       ///< part of `indirect` by photons; empty where none were shot
    std::vector<float> causticBlur;       ///< bound on its blur (luminance), beside the standard error
};

/// `x,y,z,nx,ny,nz,direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b[,stderr_r,stderr_g,stderr_b]` and, where
/// the reference shot photons, `,caustic_r,caustic_g,caustic_b,caustic_blur`. With
/// `wanted`, a last line says that the table was interrupted and holds only the first rows of so many; `parseResult`
/// refuses such a table, and so does any reader that expects numbers.
[[nodiscard]] std::string resultText(const ProbeTable& table, std::optional<std::size_t> wanted = {});

/// The same from text. Positions and standard errors may be missing, other columns are ignored, the order is free:
/// references made with other programs are read too. Every number must be finite.
[[nodiscard]] Result<ProbeTable> parseResult(std::string_view csv);
[[nodiscard]] Result<ProbeTable> readResult(const std::filesystem::path& path);

} // namespace lightloom
