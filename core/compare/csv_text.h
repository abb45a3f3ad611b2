// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include <string>
#include <string_view>
#include <vector>

/// What readers of comma-separated tables share. No quoting: our tables hold numbers and plain names.
namespace lightloom {

/// An Error of kind bad input that names the line.
[[nodiscard]] Error badLine(std::size_t line, const std::string& what);

/// What a user is shown of a cell that may hold anything: quoted, short, printable.
[[nodiscard]] std::string shownCell(std::string_view cell);

/// Cells of a line, without the blanks around them.
[[nodiscard]] std::vector<std::string_view> cellsOf(std::string_view line);

/// Walks a table line by line; blank lines are allowed at the end only, where editors leave them. Skips the byte order
/// mark that spreadsheets put in front.
class CsvLines {
public:
    explicit CsvLines(std::string_view text);
    bool next(std::string_view& line);
    [[nodiscard]] std::size_t number() const { return number_; } ///< of the line that came last, from 1
    [[nodiscard]] bool isAtEnd() const { return rest_.empty(); } ///< nothing follows

private:
    std::string_view rest_;
    std::size_t number_ = 0;
};

/// The whole cell as a finite number. False: it is something else.
[[nodiscard]] bool parseNumber(std::string_view cell, double& value);

} // namespace lightloom
