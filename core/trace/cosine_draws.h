// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/sampling.h"
#include <algorithm>
#include <cstddef>

namespace lightloom {

/// Directions around many normals, density cos / pi each, drawn eight at once: the same bits as
/// `Frame(normal).toWorld(sampleCosineHemisphere(u.x, u.y))` one by one.
class CosineDraws {
public:
    static constexpr std::size_t kCount = 64; ///< at most
    CosineDraws() { std::fill_n(nz_, kCount, 1.0f); }

    /// `normal` unit, `u` uniform in the unit square. What was never set draws around +z.
    void ask(std::size_t lane, glm::vec3 normal, glm::vec2 u)
    {
        nx_[lane] = normal.x, ny_[lane] = normal.y, nz_[lane] = normal.z;
        u1_[lane] = u.x, u2_[lane] = u.y;
    }
    /// Draws those of the first `count`.
    void draw(std::size_t count = kCount);
    [[nodiscard]] glm::vec3 drawn(std::size_t lane) const { return {x_[lane], y_[lane], z_[lane]}; }
    /// Coordinate 0, 1 or 2 of all that was drawn.
    [[nodiscard]] const float* coordinate(int axis) const { return axis == 0 ? x_ : axis == 1 ? y_ : z_; }

private:
    alignas(32) float nx_[kCount] = {}, ny_[kCount] = {}, nz_[kCount];
    alignas(32) float u1_[kCount] = {}, u2_[kCount] = {};
    alignas(32) float x_[kCount] = {}, y_[kCount] = {}, z_[kCount] = {};
};

} // namespace lightloom
