// SPDX-License-Identifier: Apache-2.0
#include "core/bake/vdb_seal.h"
#include "core/base/hash.h"
#include <algorithm>
#include <cstring>
#include <string_view>

namespace lightloom {
namespace {

constexpr std::string_view kMark = "LLSUM1";
constexpr std::size_t kTrailer = kMark.size() + 32;
// OpenVDB's header: magic (8), file version (4), library version (8), has-offsets flag (1), then the UUID as text
constexpr std::size_t kUuidAt = 21, kUuidLength = 36;

Sha256::Digest sumOf(const void* bytes, std::size_t count)
{
    Sha256 sum;
    sum.add(bytes, count);
    return sum.finish();
}

} // namespace

std::string withContentUuid(std::string stream)
{
    if (stream.size() >= kUuidAt + kUuidLength) {
        std::fill_n(stream.begin() + kUuidAt, kUuidLength, '0');
        const std::string hex = toHex(sumOf(stream.data(), stream.size()));
        std::string uuid = hex.substr(0, 32);
        for (const std::size_t dash : {8u, 13u, 18u, 23u}) uuid.insert(dash, 1, '-');
        std::ranges::copy(uuid, stream.begin() + kUuidAt);
    }
    return stream;
}

std::vector<std::uint8_t> sealVdb(std::string stream)
{
    stream = withContentUuid(std::move(stream));
    const Sha256::Digest digest = sumOf(stream.data(), stream.size());
    std::vector<std::uint8_t> file(stream.begin(), stream.end());
    file.insert(file.end(), kMark.begin(), kMark.end());
    file.insert(file.end(), digest.begin(), digest.end());
    return file;
}

Result<std::span<const std::uint8_t>> openSeal(std::span<const std::uint8_t> file)
{
    const auto bad = [](const char* what) { return Error{Error::Kind::badInput, what}; };
    const bool marked =
        file.size() > kTrailer && std::memcmp(file.data() + file.size() - kTrailer, kMark.data(), kMark.size()) == 0;
    if (!marked) return bad("not a complete Lightloom bake (its end is missing); bake again");
    const std::span<const std::uint8_t> content = file.first(file.size() - kTrailer);
    const Sha256::Digest digest = sumOf(content.data(), content.size());
    if (!std::ranges::equal(digest, file.last(digest.size())))
        return bad("the bake is damaged (its checksum differs); bake again");
    return content;
}

} // namespace lightloom
