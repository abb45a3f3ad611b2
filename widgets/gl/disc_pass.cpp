// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/disc_pass.h"
#include "widgets/gl/over_picture.h"
#include "widgets/gl/renderer.h"
#include <cstddef>

namespace lightloom {

Result<DiscPass> DiscPass::make(Gl& gl, const ShaderLibrary& shaders)
{
    Result<GlProgram> program = shaders.link(gl, "discs.vert", "pass_discs.frag");
    if (!program) return program.error();
    return DiscPass(gl, std::move(*program));
}

DiscPass::DiscPass(Gl& gl, GlProgram program) : gl_(&gl), program_(std::move(program)), array_(gl), buffer_(gl)
{
    using Disc = VoxelDiscs::Disc;
    static_assert(offsetof(Disc, radius) == offsetof(Disc, centre) + sizeof(glm::vec3));
    gl_->glBindVertexArray(array_.id());
    gl_->glBindBuffer(GL_ARRAY_BUFFER, buffer_.id());
    const auto at = [](std::size_t offset) { return reinterpret_cast<const void*>(offset); };
    gl_->glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, sizeof(Disc), at(offsetof(Disc, centre)));
    gl_->glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(Disc), at(offsetof(Disc, normal)));
    gl_->glVertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(Disc), at(offsetof(Disc, colour)));
    for (GLuint i = 0; i < 3; ++i) {
        gl_->glEnableVertexAttribArray(i);
        gl_->glVertexAttribDivisor(i, 1); // by disc
    }
    gl_->glBindVertexArray(0);
}

void DiscPass::setDiscs(std::shared_ptr<const VoxelDiscs> discs)
{
    if (discs == discs_) return;
    discs_ = std::move(discs);
    if (!discs_) return;
    gl_->glBindBuffer(GL_ARRAY_BUFFER, buffer_.id());
    gl_->glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(discs_->discs.size() * sizeof(VoxelDiscs::Disc)),
                      discs_->discs.data(), GL_STATIC_DRAW);
}

void DiscPass::draw(const FrameView& frame, const GBuffer& buffers, glm::ivec2 window)
{
    if (!discs_ || discs_->discs.empty()) return;
    gl_->glBindVertexArray(array_.id());
    const OverPicture over(*gl_, program_, frame, buffers, window);
    program_.set("cellSize", discs_->cellSize);
    program_.set("viewProjection", frame.projection * frame.view);
    gl_->glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(discs_->discs.size()));
}

} // namespace lightloom
