// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/over_picture.h"
#include "widgets/gl/renderer.h"

namespace lightloom {

OverPicture::OverPicture(Gl& gl, const GlProgram& program, const FrameView& frame, const GBuffer& buffers,
                         glm::ivec2 window)
    : gl_(gl)
{
    gl_.glEnable(GL_BLEND);
    gl_.glBlendEquation(GL_FUNC_ADD);
    gl_.glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE); // the window stays opaque
    program.use();
    program.setTexture("gPosition", 0, GL_TEXTURE_2D, buffers.position.id());
    program.set("eye", frame.eye);
    program.set("window", glm::vec2(window));
}

OverPicture::~OverPicture()
{
    gl_.glDisable(GL_BLEND);
    gl_.glBindVertexArray(0);
}

} // namespace lightloom
