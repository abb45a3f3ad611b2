// SPDX-License-Identifier: Apache-2.0
#include "core/scene/png_bytes.h"
#include <csetjmp>
#include <fmt/format.h>
#include <png.h>

namespace lightloom {
namespace {

struct Target {
    std::vector<std::uint8_t> bytes;
    std::string error;
};

void onError(png_structp png, png_const_charp message)
{
    static_cast<Target*>(png_get_error_ptr(png))->error = message;
    png_longjmp(png, 1);
}
void onWarning(png_structp, png_const_charp) {}
void onWrite(png_structp png, png_bytep data, png_size_t count)
{
    std::vector<std::uint8_t>& bytes = static_cast<Target*>(png_get_io_ptr(png))->bytes;
    bytes.insert(bytes.end(), data, data + count);
}
void onFlush(png_structp) {}

/// Everything with a destructor lives in the caller: libpng leaves by longjmp. `pixels` is width * height * channels.
bool encode(const Image& image, const std::vector<std::uint8_t>& pixels, std::size_t channels, Target& target)
{
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &target, onError, onWarning);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    if (!info) {
        png_destroy_write_struct(&png, nullptr);
        return false;
    }
    if (setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return false;
    }
    png_set_write_fn(png, &target, onWrite, onFlush);
    png_set_compression_level(png, 9);
    const auto width = static_cast<png_uint_32>(image.width), height = static_cast<png_uint_32>(image.height);
    png_set_IHDR(png, info, width, height, 8, channels == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    for (png_uint_32 y = 0; y < height; ++y) png_write_row(png, pixels.data() + channels * width * y);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return true;
}

} // namespace

Result<std::vector<std::uint8_t>> pngBytes(const Image& image)
{
    const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    if (image.width <= 0 || image.height <= 0 || image.rgba.size() != 4 * count) {
        return Error{Error::Kind::badInput,
                     fmt::format("image \"{}\" of {} x {} pixels holds {} bytes, not {}", image.name, image.width,
                                 image.height, image.rgba.size(), 4 * count)};
    }
    bool isOpaque = true;
    for (std::size_t i = 0; i < count; ++i) isOpaque = isOpaque && image.rgba[4 * i + 3] == 255;
    const std::size_t channels = isOpaque ? 3 : 4;
    std::vector<std::uint8_t> pixels(channels * count);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < channels; ++c) pixels[channels * i + c] = image.rgba[4 * i + c];
    }
    Target target;
    if (!encode(image, pixels, channels, target)) {
        return Error{Error::Kind::io, fmt::format("image \"{}\" cannot be written as PNG: {}", image.name,
                                                  target.error.empty() ? "out of memory" : target.error)};
    }
    return std::move(target.bytes);
}

} // namespace lightloom
