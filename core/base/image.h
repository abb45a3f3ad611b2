// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace lightloom {

/// Linear Rec.709 picture, row 0 at the top. Meaning and unit of a pixel are the owner's (cd/m2, lux, an error).
struct FloatImage {
    int width = 0, height = 0;
    std::vector<glm::vec3> pixels; ///< width * height

    FloatImage() = default;
    FloatImage(int w, int h)
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), glm::vec3(0.0f))
    {
    }
    [[nodiscard]] glm::vec3& at(int x, int y) { return pixels[index(x, y)]; }
    [[nodiscard]] const glm::vec3& at(int x, int y) const { return pixels[index(x, y)]; }
    [[nodiscard]] bool isSameSize(const FloatImage& o) const { return width == o.width && height == o.height; }

private:
    [[nodiscard]] std::size_t index(int x, int y) const
    {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
};

/// 8-bit sRGB picture, row 0 at the top: what screens and PNG files hold.
struct ByteImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb; ///< width * height * 3
};

/// sRGB transfer curve (IEC 61966-2-1) of one channel; `v` in [0,1].
[[nodiscard]] float encodeSrgb(float v);
[[nodiscard]] float decodeSrgb(float v);
/// What each byte of an sRGB picture means: decodeSrgb(byte / 255).
[[nodiscard]] const std::array<float, 256>& decodedSrgbBytes();

/// Channels below 0 and NaN become 0, above 1 become 1.
[[nodiscard]] ByteImage toBytes(const FloatImage& linear);
[[nodiscard]] FloatImage toLinear(const ByteImage& image);

} // namespace lightloom
