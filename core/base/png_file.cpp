// SPDX-License-Identifier: Apache-2.0
// libpng's simplified interface behind image_file.h: it neither throws nor jumps.
#include "core/base/atomic_file.h"
#include "core/base/image_file.h"
#include <algorithm>
#include <array>
#include <cassert>
#include <fmt/format.h>
#include <png.h>

namespace lightloom {
namespace {

constexpr std::uint32_t kMostSide = 16384;
constexpr std::uint64_t kMostPixels = 64'000'000;
constexpr std::uint64_t kMostBytes = 1ull << 30;
constexpr std::size_t kAfterIhdr = 8 + 25; // signature, then the one chunk that must come first

/// CRC-32 as PNG wants it (ISO 3309), bit by bit: notes are short.
std::uint32_t crc(std::span<const std::uint8_t> bytes)
{
    std::uint32_t c = 0xFFFFFFFFu;
    for (const std::uint8_t b : bytes) {
        c ^= b;
        for (int bit = 0; bit < 8; ++bit) c = (c & 1u) ? 0xEDB88320u ^ (c >> 1) : c >> 1;
    }
    return ~c;
}

void appendWord(std::vector<std::uint8_t>& to, std::uint32_t word)
{
    for (const int shift : {24, 16, 8, 0}) to.push_back(static_cast<std::uint8_t>(word >> shift));
}

/// The simplified interface knows no notes, so their chunks are made here.
std::vector<std::uint8_t> textChunk(const std::string& name, const std::string& text)
{
    std::string body = "tEXt" + name.substr(0, 79) + '\0';
    std::ranges::replace_copy(text, std::back_inserter(body), '\0', ' ');
    const std::vector<std::uint8_t> bytes(body.begin(), body.end());
    std::vector<std::uint8_t> chunk;
    appendWord(chunk, static_cast<std::uint32_t>(bytes.size() - 4));
    chunk.insert(chunk.end(), bytes.begin(), bytes.end());
    appendWord(chunk, crc(bytes));
    return chunk;
}

/// Frees what libpng holds, whichever way the function ends.
struct PngImage {
    png_image value{};
    PngImage() { value.version = PNG_IMAGE_VERSION; }
    ~PngImage() { png_image_free(&value); }
    PngImage(const PngImage&) = delete;
    PngImage& operator=(const PngImage&) = delete;
};

} // namespace

Result<Done> writePng(const std::filesystem::path& path, const ByteImage& image, const ImageNotes& notes)
{
    assert(image.rgb.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
    PngImage png;
    png.value.width = static_cast<png_uint_32>(image.width);
    png.value.height = static_cast<png_uint_32>(image.height);
    png.value.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png.value);
    std::vector<std::uint8_t> bytes(size);
    if (!png_image_write_to_memory(&png.value, bytes.data(), &size, 0, image.rgb.data(), 0, nullptr)) {
        return Error{Error::Kind::io, fmt::format("cannot write {}: {}", path.string(), png.value.message)};
    }
    bytes.resize(size);
    std::vector<std::uint8_t> chunks;
    for (const auto& [name, text] : notes) {
        const std::vector<std::uint8_t> chunk = textChunk(name, text);
        chunks.insert(chunks.end(), chunk.begin(), chunk.end());
    }
    bytes.insert(bytes.begin() + kAfterIhdr, chunks.begin(), chunks.end());
    return writeFile(path, std::span(bytes));
}

Result<ByteImage> readPng(const std::filesystem::path& path)
{
    const Result<std::vector<std::uint8_t>> bytes = readFile(path, kMostBytes);
    if (!bytes) return bytes.error();
    const auto refuse = [&](std::string why) {
        return Error{Error::Kind::badInput, fmt::format("{} is not a readable PNG file: {}", path.string(), why)};
    };
    PngImage png;
    if (!png_image_begin_read_from_memory(&png.value, bytes->data(), bytes->size())) return refuse(png.value.message);
    const std::uint64_t pixels = std::uint64_t{png.value.width} * png.value.height;
    if (png.value.width > kMostSide || png.value.height > kMostSide || pixels > kMostPixels) {
        return refuse(fmt::format("it says {} x {} pixels; up to {} a side and {} in all are read", png.value.width,
                                  png.value.height, kMostSide, kMostPixels));
    }
    png.value.format = PNG_FORMAT_RGB;
    ByteImage image{static_cast<int>(png.value.width), static_cast<int>(png.value.height), {}};
    image.rgb.resize(pixels * 3);
    const png_color black{0, 0, 0};
    if (!png_image_finish_read(&png.value, &black, image.rgb.data(), 0, nullptr)) return refuse(png.value.message);
    return image;
}

} // namespace lightloom
