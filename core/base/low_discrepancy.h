// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/rng.h"
#include <glm/glm.hpp>

namespace lightloom {

/// `i` with its bits mirrored around the binary point, in [0,1) (van der Corput's sequence in base 2).
[[nodiscard]] constexpr float radicalInverse2(std::uint32_t i)
{
    i = (i << 16) | (i >> 16);
    i = ((i & 0x00FF00FFu) << 8) | ((i & 0xFF00FF00u) >> 8);
    i = ((i & 0x0F0F0F0Fu) << 4) | ((i & 0xF0F0F0F0u) >> 4);
    i = ((i & 0x33333333u) << 2) | ((i & 0xCCCCCCCCu) >> 2);
    i = ((i & 0x55555555u) << 1) | ((i & 0xAAAAAAAAu) >> 1);
    return static_cast<float>(i >> 8) * 0x1p-24f;
}

/// `count` points spread evenly over the unit square (Hammersley's set), shifted as a whole by random numbers modulo 1:
/// each point alone is uniform, so that averages over them are unbiased.
class ShiftedPoints {
public:
    ShiftedPoints(int count, Rng& rng) : count_(count), shift_(rng.uniform(), rng.uniform()) {}
    [[nodiscard]] glm::vec2 operator[](int i) const
    {
        const glm::vec2 p((static_cast<float>(i) + 0.5f) / static_cast<float>(count_),
                          radicalInverse2(static_cast<std::uint32_t>(i)));
        return {inside(p.x + shift_.x), inside(p.y + shift_.y)};
    }

private:
    static float inside(float v) { return v >= 1.0f ? v - 1.0f : v; }
    int count_;
    glm::vec2 shift_;
};

} // namespace lightloom
