// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/gl_objects.h"

namespace lightloom {

/// What the camera sees, without light: position, normal and roughness, base colour and metallic, emission. And the
/// buffers that light is gathered in: one picture, and the sum of pictures taken through shifted pixels; of the direct
/// light alone as well, with the lamps' stand-ins and with many more points of them.
struct GBuffer {
    glm::ivec2 size{0};
    GlTexture position, normal, base, emission, depth, light, sum, directSum, refinedSum;
    GlFramebuffer surfaces, lighting, summing, directSumming, refining;

    /// Error: the driver refuses.
    [[nodiscard]] static Result<GBuffer> make(Gl& gl, glm::ivec2 size);
    /// Hands position, normal and base colour to a mode's program, which is in use, on units 0 to 2.
    void bind(const GlProgram& mode) const;
};

} // namespace lightloom
