// SPDX-License-Identifier: Apache-2.0
// PNG through libpng. libpng reports errors by longjmp: the functions that jump or are jumped over (`readSize`,
// `readPixels`) hold plain pointers and numbers only, everything with a destructor lives in their callers.
#include "core/scene/image_decode.h"
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <png.h>

namespace lightloom::detail {
namespace {

struct PngInput {
    const std::uint8_t* next = nullptr;
    std::size_t left = 0;
    char message[160] = {};
};

[[noreturn]] void onError(png_structp png, png_const_charp message)
{
    auto* input = static_cast<PngInput*>(png_get_error_ptr(png));
    std::snprintf(input->message, sizeof input->message, "%s", message);
    png_longjmp(png, 1);
}

void onWarning(png_structp, png_const_charp) {}

void onRead(png_structp png, png_bytep out, std::size_t count)
{
    auto* input = static_cast<PngInput*>(png_get_io_ptr(png));
    if (count > input->left) png_error(png, "the file ends too early");
    std::memcpy(out, input->next, count);
    input->next += count;
    input->left -= count;
}

/// Owns libpng's two structures.
class PngReader {
public:
    explicit PngReader(std::span<const std::uint8_t> file)
    {
        input.next = file.data();
        input.left = file.size();
        png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &input, onError, onWarning);
        if (png != nullptr) info = png_create_info_struct(png);
    }
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    [[nodiscard]] bool isReady() const { return png != nullptr && info != nullptr; }
    [[nodiscard]] Error error() const
    {
        return {Error::Kind::badInput, fmt::format("the PNG is damaged ({})", input.message)};
    }

    PngInput input;
    png_structp png = nullptr;
    png_infop info = nullptr;
};

/// Reads up to the first pixel. Text and profile chunks are skipped, so they cannot ask for memory.
bool readSize(png_structp png, png_infop info, PngInput* input)
{
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_read_fn(png, input, onRead);
    png_set_user_limits(png, 1u << 20, 1u << 20); // our own limits are held against the header right after
    png_set_chunk_cache_max(png, 64);
    png_set_chunk_malloc_max(png, 1u << 20);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, 0);
    png_read_info(png, info);
    return true;
}

/// Asks for 8-bit RGBA and decodes into `rows`, `height` pointers to rows of `rowBytes`.
bool readPixels(png_structp png, png_infop info, png_bytepp rows, std::size_t rowBytes)
{
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_scale_16(png);
    png_set_expand(png); // palettes, 1/2/4-bit grey, tRNS
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, 0xFF, PNG_FILLER_AFTER);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    if (png_get_rowbytes(png, info) != rowBytes) png_error(png, "unexpected row size");
    png_read_image(png, rows);
    return true;
}

ImageSize sizeOf(const PngReader& reader)
{
    return {static_cast<int>(png_get_image_width(reader.png, reader.info)),
            static_cast<int>(png_get_image_height(reader.png, reader.info))};
}

Error noMemory() { return {Error::Kind::outOfMemory, "no memory to decode a PNG"}; }

} // namespace

Result<ImageSize> pngSize(std::span<const std::uint8_t> file)
{
    PngReader reader(file);
    if (!reader.isReady()) return noMemory();
    if (!readSize(reader.png, reader.info, &reader.input)) return reader.error();
    return sizeOf(reader);
}

Result<Image> decodePng(std::span<const std::uint8_t> file, ImageSize size)
{
    PngReader reader(file);
    if (!reader.isReady()) return noMemory();
    if (!readSize(reader.png, reader.info, &reader.input)) return reader.error();

    // deflate shrinks to 1/1032 at best: a file shorter than that cannot hold the pixels its header promises
    const auto bitsPerPixel = static_cast<std::uint64_t>(png_get_bit_depth(reader.png, reader.info)) *
                              png_get_channels(reader.png, reader.info);
    if (size.pixels() * bitsPerPixel / 8 > 1040 * static_cast<std::uint64_t>(file.size())) {
        return Error{Error::Kind::badInput, fmt::format("the PNG is damaged ({} bytes cannot hold {} x {} pixels)",
                                                        file.size(), size.width, size.height)};
    }
    Image image;
    image.width = size.width;
    image.height = size.height;
    const std::size_t rowBytes = static_cast<std::size_t>(size.width) * 4;
    image.rgba.resize(rowBytes * static_cast<std::size_t>(size.height));
    std::vector<png_bytep> rows(static_cast<std::size_t>(size.height));
    for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = image.rgba.data() + y * rowBytes;
    if (!readPixels(reader.png, reader.info, rows.data(), rowBytes)) return reader.error();
    return image;
}

} // namespace lightloom::detail
