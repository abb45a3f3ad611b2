// SPDX-License-Identifier: Apache-2.0
#include "core/compare/csv_text.h"
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

std::string_view trimmed(std::string_view cell)
{
    const auto isSpace = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!cell.empty() && isSpace(cell.front())) cell.remove_prefix(1);
    while (!cell.empty() && isSpace(cell.back())) cell.remove_suffix(1);
    return cell;
}

} // namespace

Error badLine(std::size_t line, const std::string& what)
{
    return {Error::Kind::badInput, fmt::format("line {}: {}", line, what)};
}

std::string shownCell(std::string_view cell)
{
    std::string text(cell.substr(0, 24));
    std::ranges::replace_if(
        text, [](unsigned char c) { return c < 0x20 || c == 0x7F; }, '?');
    return text.empty() ? "nothing" : '"' + text + '"';
}

std::vector<std::string_view> cellsOf(std::string_view line)
{
    std::vector<std::string_view> cells;
    while (true) {
        const std::size_t comma = line.find(',');
        cells.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) return cells;
        line.remove_prefix(comma + 1);
    }
}

CsvLines::CsvLines(std::string_view text) : rest_(text)
{
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
    while (!rest_.empty() && (rest_.back() == '\n' || rest_.back() == '\r' || rest_.back() == ' ')) {
        rest_.remove_suffix(1);
    }
}

bool CsvLines::next(std::string_view& line)
{
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = trimmed(rest_.substr(0, end));
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++number_;
    return true;
}

bool parseNumber(std::string_view cell, double& value)
{
    const char* end = cell.data() + cell.size();
    const auto [stop, code] = std::from_chars(cell.data(), end, value);
    return code == std::errc{} && stop == end && std::isfinite(value);
}

} // namespace lightloom
