// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Words of the command line as values.
namespace lightloom::cli {

inline constexpr std::uint64_t kMostWhole = 1ull << 53; ///< the largest number that files keep exactly

template<std::size_t N>
std::vector<std::string> texts(const std::array<std::string_view, N>& names)
{
    return {names.begin(), names.end()};
}

/// Place of a checked name in the list that its enum follows.
template<class Enum, std::size_t N>
Enum named(const std::array<std::string_view, N>& names, std::string_view name)
{
    return static_cast<Enum>(std::ranges::find(names, name) - names.begin());
}

/// Empty if `text` is a whole number that files keep exactly, else what is wrong with it. CLI11 alone reads -1 as a
/// huge unsigned number.
[[nodiscard]] std::string wholeNumber(const std::string& text);

/// Width and height of "640x480", within what image files may hold.
[[nodiscard]] std::optional<std::pair<int, int>> sizeOf(const std::string& text);

} // namespace lightloom::cli
