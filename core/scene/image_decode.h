// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/scene/scene.h"
#include <cstdint>
#include <span>
#include <string>

namespace lightloom {

/// What an image file may cost. Held against its header before memory is taken.
struct ImageLimits {
    int side = 32'768;                             ///< pixels along one side
    std::uint64_t pixels = std::uint64_t{1} << 26; ///< width x height: 8192 x 8192, 256 MiB decoded
};

struct ImageSize {
    int width = 0, height = 0;
    [[nodiscard]] std::uint64_t pixels() const
    {
        return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    }
};

/// Decodes a PNG or JPEG file held in memory to 8-bit RGBA, row 0 at the top. The format is told by the first bytes.
/// Values come out as stored: colour profiles and gamma chunks are ignored, as glTF asks; 16 bits become 8; grey is
/// repeated in three channels; missing alpha is 255. Errors: another format, a damaged or truncated file, more than
/// `limits` allows, CMYK JPEG. Any thread.
[[nodiscard]] Result<Image> decodeImage(std::span<const std::uint8_t> file, const ImageLimits& limits = {});

/// Width and height from the header alone, held against `limits`; decodes nothing.
[[nodiscard]] Result<ImageSize> imageSize(std::span<const std::uint8_t> file, const ImageLimits& limits = {});

namespace detail { // one per file format; `decodeImage` picks
[[nodiscard]] Result<ImageSize> pngSize(std::span<const std::uint8_t> file);
[[nodiscard]] Result<Image> decodePng(std::span<const std::uint8_t> file, ImageSize size);
[[nodiscard]] Result<ImageSize> jpegSize(std::span<const std::uint8_t> file);
[[nodiscard]] Result<Image> decodeJpeg(std::span<const std::uint8_t> file, ImageSize size);
} // namespace detail

} // namespace lightloom
