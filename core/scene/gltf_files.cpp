// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf_files.h"
#include "core/base/atomic_file.h"
#include "core/scene/gltf_json.h"
#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>

namespace lightloom {
namespace fs = std::filesystem;
namespace {

Error bad(std::string message) { return {Error::Kind::badInput, std::move(message)}; }

int hexDigit(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

Result<std::string> percentDecoded(std::string_view uri)
{
    std::string text;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] != '%') {
            text += uri[i];
            continue;
        }
        const int high = i + 2 < uri.size() ? hexDigit(uri[i + 1]) : -1;
        const int low = i + 2 < uri.size() ? hexDigit(uri[i + 2]) : -1;
        if (high < 0 || low < 0) return bad("it holds a broken percent code");
        text += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return text;
}

/// "http:", "file:", "C:"
bool hasScheme(std::string_view uri)
{
    const std::size_t colon = uri.find(':');
    if (colon == std::string_view::npos || colon == 0) return false;
    return std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.';
    });
}

std::array<std::int8_t, 256> base64Values()
{
    std::array<std::int8_t, 256> values;
    values.fill(-1);
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < digits.size(); ++i) {
        values[static_cast<unsigned char>(digits[i])] = static_cast<std::int8_t>(i);
    }
    return values;
}

bool isBelow(const fs::path& file, const fs::path& folder)
{
    const auto [inFolder, inFile] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    return inFolder == folder.end() && inFile != file.end();
}

} // namespace

bool isDataUri(std::string_view uri)
{
    constexpr std::string_view scheme = "data:";
    return uri.size() >= scheme.size() && std::equal(scheme.begin(), scheme.end(), uri.begin(), [](char a, char b) {
               return a == std::tolower(static_cast<unsigned char>(b));
           });
}

Result<fs::path> relativePath(std::string_view uri)
{
    const auto refuse = [&](std::string_view why) {
        return bad(fmt::format("the uri \"{}\" is not followed: {}", plainName(uri), why));
    };
    if (uri.empty()) return refuse("it is empty");
    if (hasScheme(uri)) return refuse("only files in the scene's folder and data: uris are read");
    const Result<std::string> decoded = percentDecoded(uri);
    if (!decoded) return refuse(decoded.error().message);
    if (decoded->find('\0') != std::string::npos) return refuse("it holds a NUL");
    if (decoded->find('\\') != std::string::npos) return refuse("it holds a backslash; glTF separates folders by /");
    const fs::path path(*decoded);
    if (path.is_absolute()) return refuse("it is absolute; only files in the scene's folder are read");
    for (const fs::path& part : path) {
        if (part == "..") return refuse("it leads out of the scene's folder");
    }
    return path;
}

Result<std::vector<std::uint8_t>> decodeDataUri(std::string_view uri, std::uint64_t mostBytes)
{
    static const std::array<std::int8_t, 256> values = base64Values();
    const std::size_t comma = uri.find(',');
    constexpr std::string_view marker = ";base64";
    if (comma == std::string_view::npos || !uri.substr(0, comma).ends_with(marker)) {
        return bad("a data: uri is not base64");
    }
    std::string_view text = uri.substr(comma + 1);
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    if (text.size() / 4 * 3 > mostBytes) return bad(fmt::format("a data: uri holds more than {} bytes", mostBytes));
    std::vector<std::uint8_t> bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    int have = 0;
    for (const char c : text) {
        const int value = values[static_cast<unsigned char>(c)];
        if (value < 0) return bad("a data: uri holds a character that is not base64");
        bits = (bits << 6 | static_cast<std::uint32_t>(value)) & 0xFFFFFFu;
        have += 6;
        if (have < 8) continue;
        have -= 8;
        bytes.push_back(static_cast<std::uint8_t>(bits >> have & 0xFFu));
    }
    if (have == 6) return bad("a data: uri is cut off");
    return bytes;
}

Result<std::vector<std::uint8_t>> SceneFolder::read(const std::string& uri, std::uint64_t mostBytes) const
{
    if (isDataUri(uri)) return decodeDataUri(uri, mostBytes);
    const Result<fs::path> relative = relativePath(uri);
    if (!relative) return relative.error();
    std::error_code failed;
    const fs::path home = fs::canonical(folder_.empty() ? fs::path(".") : folder_, failed);
    if (failed) return Error{Error::Kind::io, fmt::format("cannot open the folder {}", folder_.string())};
    const fs::path file = fs::canonical(home / *relative, failed); // follows links
    if (failed) {
        return Error{Error::Kind::notFound,
                     fmt::format("there is no file {} beside the scene", plainName(relative->string()))};
    }
    if (!isBelow(file, home)) {
        return bad(fmt::format("{} is a link that leads out of the scene's folder; it is not followed",
                               plainName(relative->string())));
    }
    return readFile(file, mostBytes);
}

} // namespace lightloom
