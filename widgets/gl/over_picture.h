// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/gbuffer.h"

namespace lightloom {

struct FrameView;

/// While it lives `program` is in use and draws over the finished picture, which stays opaque: blended by alpha, and
/// told of the picture's surfaces (gPosition, on unit 0), the eye and the window's pixels. No vertex array is bound
/// afterwards. The context is current throughout.
class OverPicture {
public:
    OverPicture(Gl& gl, const GlProgram& program, const FrameView& frame, const GBuffer& buffers, glm::ivec2 window);
    ~OverPicture();
    OverPicture(const OverPicture&) = delete;
    OverPicture& operator=(const OverPicture&) = delete;

private:
    Gl& gl_;
};

} // namespace lightloom
