// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/sampling.h"
#include <cstddef>

namespace lightloom {

/// Directions around eight normals, density cos / pi each, drawn at once: the same bits as
/// `Frame(normal).toWorld(sampleCosineHemisphere(u.x, u.y))` one by one.
class CosineDraws {
public:
    static constexpr std::size_t kCount = 8;

    /// `normal` unit, `u` uniform in the unit square. What was never set draws around +z.
    void ask(std::size_t lane, glm::vec3 normal, glm::vec2 u)
    {
        nx_[lane] = normal.x, ny_[lane] = normal.y, nz_[lane] = normal.z;
        u1_[lane] = u.x, u2_[lane] = u.y;
    }
    void draw();
    [[nodiscard]] glm::vec3 drawn(std::size_t lane) const { return {x_[lane], y_[lane], z_[lane]}; }

private:
    alignas(32) float nx_[kCount] = {}, ny_[kCount] = {}, nz_[kCount] = {1, 1, 1, 1, 1, 1, 1, 1};
    alignas(32) float u1_[kCount] = {}, u2_[kCount] = {};
    alignas(32) float x_[kCount] = {}, y_[kCount] = {}, z_[kCount] = {};
};

} // namespace lightloom
