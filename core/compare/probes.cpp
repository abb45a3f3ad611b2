// SPDX-License-Identifier: Apache-2.0
#include "core/compare/probes.h"
#include "core/base/atomic_file.h"
#include "core/compare/csv_text.h"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

constexpr std::uint64_t kMostBytes = 1ull << 30;
constexpr std::string_view kPointsHeader = "x,y,z,nx,ny,nz";
constexpr std::string_view kLightHeader = "direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b";
constexpr std::string_view kErrorHeader = "stderr_r,stderr_g,stderr_b";
constexpr std::string_view kIncomplete = "# incomplete";

/// The finite numbers of one row, as many as the header has columns.
Result<Done> numbersOf(std::string_view line, std::size_t number, std::span<const std::string_view> columns,
                       std::vector<double>& values)
{
    if (line.starts_with(kIncomplete)) {
        return badLine(number, fmt::format("the table is marked as interrupted ({}); make it again", shownCell(line)));
    }
    const std::vector<std::string_view> cells = cellsOf(line);
    if (cells.size() != columns.size()) {
        return badLine(number, fmt::format("expected {} numbers, found {}", columns.size(), cells.size()));
    }
    values.resize(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (!parseNumber(cells[i], values[i])) {
            return badLine(number,
                           fmt::format("{} should be a finite number, it is {}", columns[i], shownCell(cells[i])));
        }
    }
    return Done{};
}

void appendPoint(std::string& text, const ProbeRow& row)
{
    const glm::dvec3 p = row.position, n = row.normal;
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{}", p.x, p.y, p.z, n.x, n.y, n.z);
}

void appendLight(std::string& text, glm::vec3 v)
{
    fmt::format_to(std::back_inserter(text), ",{},{},{}", v.x, v.y, v.z);
}

template<class T>
Result<T> readTable(const std::filesystem::path& path, Result<T> (*parse)(std::string_view))
{
    const Result<std::vector<std::uint8_t>> bytes = readFile(path, kMostBytes);
    if (!bytes) return bytes.error();
    Result<T> parsed = parse({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    if (!parsed) return parsed.error().in(path.string());
    return parsed;
}

/// Column numbers of three cells "<name><suffixes>", or -1s.
struct Triple {
    std::array<int, 3> column{-1, -1, -1};
    Triple(std::span<const std::string_view> header, std::array<std::string_view, 3> names)
    {
        for (std::size_t i = 0; i < 3; ++i) {
            const auto found = std::ranges::find(header, names[i]);
            if (found != header.end()) column[i] = static_cast<int>(found - header.begin());
        }
    }
    [[nodiscard]] bool isThere() const { return std::ranges::min(column) >= 0; }
    [[nodiscard]] glm::dvec3 of(const std::vector<double>& row) const
    {
        const auto value = [&](std::size_t i) { return row[static_cast<std::size_t>(column[i])]; };
        return {value(0), value(1), value(2)};
    }
};

} // namespace

Result<std::vector<ProbeRow>> parsePoints(std::string_view csv)
{
    CsvLines lines(csv);
    std::string_view line;
    const std::vector<std::string_view> columns = cellsOf(kPointsHeader);
    if (!lines.next(line) || cellsOf(line) != columns) {
        return badLine(1, fmt::format("expected the header {}, found {}", kPointsHeader, shownCell(line)));
    }
    std::vector<ProbeRow> rows;
    std::vector<double> v;
    while (lines.next(line)) {
        if (const Result<Done> read = numbersOf(line, lines.number(), columns, v); !read) return read.error();
        const ProbeRow row{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
        const double length = glm::length(row.normal);
        if (!(length > 0.0) || !std::isfinite(length)) {
            return badLine(lines.number(), fmt::format("the normal {} {} {} has no direction", v[3], v[4], v[5]));
        }
        rows.push_back(row);
    }
    return rows;
}

Result<std::vector<ProbeRow>> readPoints(const std::filesystem::path& path) { return readTable(path, parsePoints); }

std::string pointsText(const std::vector<ProbeRow>& rows)
{
    std::string text(kPointsHeader);
    text += '\n';
    for (const ProbeRow& row : rows) {
        appendPoint(text, row);
        text += '\n';
    }
    return text;
}

ProbePoint inScene(const Scene& scene, const ProbeRow& row)
{
    std::uint64_t key = 0;
    const glm::dvec3 p = row.position, n = row.normal;
    for (const double number : {p.x, p.y, p.z, n.x, n.y, n.z}) {
        key = mixBits(key ^ std::bit_cast<std::uint64_t>(number + 0.0)); // + 0: -0 and 0 are one number
    }
    return {scene.toScene(p), glm::vec3(glm::normalize(n)), key};
}

std::string resultText(const ProbeTable& table, std::optional<std::size_t> wanted)
{
    std::string text = fmt::format("{},{}", kPointsHeader, kLightHeader);
    if (!table.standardError.empty()) text += fmt::format(",{}", kErrorHeader);
    if (!table.caustic.empty()) text += ",caustic_r,caustic_g,caustic_b,caustic_blur";
    text += '\n';
    for (std::size_t i = 0; i < table.points.size(); ++i) {
        appendPoint(text, table.points[i]);
        appendLight(text, table.direct[i]);
        appendLight(text, table.indirect[i]);
        if (!table.standardError.empty()) appendLight(text, table.standardError[i]);
        if (!table.caustic.empty()) {
            appendLight(text, table.caustic[i]);
            text += fmt::format(",{}", table.causticBlur[i]);
        }
        text += '\n';
    }
    if (wanted) text += fmt::format("{}: {} of {} points\n", kIncomplete, table.points.size(), *wanted);
    return text;
}

Result<ProbeTable> parseResult(std::string_view csv)
{
    CsvLines lines(csv);
    std::string_view line;
    if (!lines.next(line)) return badLine(1, "the table is empty");
    const std::vector<std::string_view> header = cellsOf(line);
    const Triple position(header, {"x", "y", "z"}), normal(header, {"nx", "ny", "nz"});
    const Triple direct(header, {"direct_r", "direct_g", "direct_b"});
    const Triple indirect(header, {"indirect_r", "indirect_g", "indirect_b"});
    const Triple error(header, {"stderr_r", "stderr_g", "stderr_b"});
    if (!direct.isThere() || !indirect.isThere()) {
        return badLine(1, fmt::format("expected a header with {}, found {}", kLightHeader, shownCell(line)));
    }
    ProbeTable table;
    std::vector<double> row;
    while (lines.next(line)) {
        if (const Result<Done> read = numbersOf(line, lines.number(), header, row); !read) return read.error();
        if (position.isThere() && normal.isThere()) table.points.push_back({position.of(row), normal.of(row)});
        table.direct.emplace_back(direct.of(row));
        table.indirect.emplace_back(indirect.of(row));
        if (error.isThere()) table.standardError.emplace_back(error.of(row));
    }
    return table;
}

Result<ProbeTable> readResult(const std::filesystem::path& path) { return readTable(path, parseResult); }

} // namespace lightloom
