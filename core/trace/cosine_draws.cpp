// SPDX-License-Identifier: Apache-2.0
#include "core/trace/cosine_draws.h"
#include "core/base/wide_vectors.h"

namespace lightloom {
namespace {

LIGHTLOOM_WIDE_VECTORS void drawAll(const float* __restrict nx, const float* __restrict ny, const float* __restrict nz,
                                    const float* __restrict u1, const float* __restrict u2, float* __restrict x,
                                    float* __restrict y, float* __restrict z, std::size_t groups)
{
    for (std::size_t i = 0; i < groups * kLanes; ++i) { // whole groups: no rest to do one by one
        const glm::vec3 d = Frame(glm::vec3(nx[i], ny[i], nz[i])).toWorld(sampleCosineHemisphere(u1[i], u2[i]));
        x[i] = d.x, y[i] = d.y, z[i] = d.z;
    }
}

} // namespace

void CosineDraws::draw(std::size_t count)
{
    drawAll(nx_, ny_, nz_, u1_, u2_, x_, y_, z_, (count + kLanes - 1) / kLanes);
}

} // namespace lightloom
