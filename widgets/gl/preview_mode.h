// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/gbuffer.h"

namespace lightloom {

/// What a frame hands to whoever adds light to it.
struct ModeFrame {
    const GBuffer& buffers;
    glm::vec3 eye;                  ///< scene space
    bool showIlluminance;           ///< lux on the surface instead of radiance towards the eye
    bool mirrors;                   ///< environment maps are added: metals that have one show nothing else
    glm::mat4 viewProjection{1.0f}; ///< that the buffers were drawn with
};

/// One way to show indirect light. The lighting framebuffer is bound, blending adds, and an empty vertex array is
/// bound. One object per method; the context is current in all calls.
class PreviewMode {
public:
    virtual ~PreviewMode() = default;
    /// Adds indirect light for every pixel that has a surface; draws nothing while there is no bake.
    virtual void draw(const ModeFrame& frame) = 0;
};

} // namespace lightloom
