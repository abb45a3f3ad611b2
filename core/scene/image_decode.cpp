// SPDX-License-Identifier: Apache-2.0
#include "core/scene/image_decode.h"
#include <algorithm>
#include <fmt/format.h>

namespace lightloom {
namespace {

bool startsWith(std::span<const std::uint8_t> file, std::initializer_list<std::uint8_t> magic)
{
    return file.size() >= magic.size() && std::equal(magic.begin(), magic.end(), file.begin());
}
bool isPng(std::span<const std::uint8_t> file)
{
    return startsWith(file, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'});
}
bool isJpeg(std::span<const std::uint8_t> file) { return startsWith(file, {0xFF, 0xD8, 0xFF}); }

} // namespace

Result<ImageSize> imageSize(std::span<const std::uint8_t> file, const ImageLimits& limits)
{
    if (!isPng(file) && !isJpeg(file)) {
        return Error{Error::Kind::unsupported, "it is neither PNG nor JPEG; save it as one of these"};
    }
    const Result<ImageSize> size = isPng(file) ? detail::pngSize(file) : detail::jpegSize(file);
    if (!size) return size;
    if (size->width < 1 || size->height < 1) return Error{Error::Kind::badInput, "it has no pixels"};
    if (size->width > limits.side || size->height > limits.side || size->pixels() > limits.pixels) {
        return Error{Error::Kind::badInput,
                     fmt::format("it has {} x {} pixels; at most {} in all and {} on a side are read: scale it down",
                                 size->width, size->height, limits.pixels, limits.side)};
    }
    return size;
}

Result<Image> decodeImage(std::span<const std::uint8_t> file, const ImageLimits& limits)
{
    const Result<ImageSize> size = imageSize(file, limits);
    if (!size) return size.error();
    return isPng(file) ? detail::decodePng(file, *size) : detail::decodeJpeg(file, *size);
}

} // namespace lightloom
