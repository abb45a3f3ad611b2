// SPDX-License-Identifier: Apache-2.0
#include "app/cli/words.h"
#include <charconv>

namespace lightloom::cli {

std::string wholeNumber(const std::string& text)
{
    std::uint64_t value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool isFine = code == std::errc{} && end == text.data() + text.size() && value <= kMostWhole;
    return isFine ? "" : text + " is not a whole number from 0 to " + std::to_string(kMostWhole);
}

std::optional<std::pair<int, int>> sizeOf(const std::string& text)
{
    int width = 0, height = 0;
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, width);
    if (first.ec != std::errc{} || first.ptr == end || *first.ptr != 'x') return {};
    const auto second = std::from_chars(first.ptr + 1, end, height);
    if (second.ec != std::errc{} || second.ptr != end) return {};
    const bool fits = width >= 1 && height >= 1 && width <= 16384 && height <= 16384;
    if (!fits || std::int64_t{width} * height > 64'000'000) return {};
    return std::pair(width, height);
}

} // namespace lightloom::cli
