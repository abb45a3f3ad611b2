// SPDX-License-Identifier: Apache-2.0
#include "core/base/image.h"
#include <cmath>

namespace lightloom {

float encodeSrgb(float v) { return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f; }

float decodeSrgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

const std::array<float, 256>& decodedSrgbBytes()
{
    static const std::array<float, 256> table = [] {
        std::array<float, 256> t{};
        for (std::size_t i = 0; i < t.size(); ++i) t[i] = decodeSrgb(static_cast<float>(i) / 255.0f);
        return t;
    }();
    return table;
}

ByteImage toBytes(const FloatImage& linear)
{
    ByteImage image{linear.width, linear.height, {}};
    image.rgb.reserve(linear.pixels.size() * 3);
    for (const glm::vec3& p : linear.pixels) {
        for (const float channel : {p.x, p.y, p.z}) {
            const float inside = channel > 0.0f ? std::fmin(channel, 1.0f) : 0.0f; // NaN is not above 0
            image.rgb.push_back(static_cast<std::uint8_t>(std::lround(255.0f * encodeSrgb(inside))));
        }
    }
    return image;
}

FloatImage toLinear(const ByteImage& image)
{
    const std::array<float, 256>& decoded = decodedSrgbBytes();
    FloatImage linear(image.width, image.height);
    for (std::size_t i = 0; i < linear.pixels.size(); ++i) {
        linear.pixels[i] = {decoded[image.rgb[3 * i]], decoded[image.rgb[3 * i + 1]], decoded[image.rgb[3 * i + 2]]};
    }
    return linear;
}

} // namespace lightloom
