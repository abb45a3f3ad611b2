// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/vertex_pass.h"
#include "widgets/gl/over_picture.h"
#include "widgets/gl/renderer.h"

namespace lightloom {

namespace {

constexpr float kDotShare = 0.1f;                  ///< of a cell
constexpr float kLeastDot = 2.0f, kMostDot = 9.0f; ///< pixels

} // namespace

Result<VertexPass> VertexPass::make(Gl& gl, const ShaderLibrary& shaders)
{
    Result<GlProgram> program = shaders.link(gl, "vertices.vert", "pass_marks.frag");
    if (!program) return program.error();
    return VertexPass(gl, std::move(*program));
}

VertexPass::VertexPass(Gl& gl, GlProgram program) : gl_(&gl), program_(std::move(program)), array_(gl), buffer_(gl)
{
    gl_->glBindVertexArray(array_.id());
    gl_->glBindBuffer(GL_ARRAY_BUFFER, buffer_.id());
    gl_->glEnableVertexAttribArray(0);
    gl_->glVertexAttribPointer(0, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(glm::u8vec4), nullptr);
    gl_->glBindVertexArray(0);
}

void VertexPass::setVertices(std::shared_ptr<const GridVertices> vertices)
{
    vertices_ = std::move(vertices);
    if (!vertices_) return;
    std::vector<glm::u8vec4> all;
    for (const auto& [lattice, colours] : vertices_->lattices) all.insert(all.end(), colours.begin(), colours.end());
    gl_->glBindBuffer(GL_ARRAY_BUFFER, buffer_.id());
    gl_->glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(all.size() * sizeof(glm::u8vec4)), all.data(),
                      GL_STATIC_DRAW);
}

void VertexPass::draw(const FrameView& frame, const GBuffer& buffers, glm::ivec2 window)
{
    if (!vertices_) return;
    gl_->glBindVertexArray(array_.id());
    gl_->glEnable(GL_PROGRAM_POINT_SIZE);
    const OverPicture over(*gl_, program_, frame, buffers, window);
    program_.set("viewProjection", frame.projection * frame.view);
    // pixels of a metre at a distance of one metre
    const float metre = 0.5f * static_cast<float>(window.y) * frame.projection[1][1];
    GLint first = 0;
    for (const auto& [lattice, colours] : vertices_->lattices) {
        program_.set("first", first); // the shader's numbers go on from one lattice to the next
        program_.set("lowest", lattice.lowest);
        program_.set("cellSize", lattice.cellSize);
        program_.set("vertices", lattice.vertices());
        const float cell = std::min({lattice.cellSize.x, lattice.cellSize.y, lattice.cellSize.z});
        program_.set("size", glm::vec3(kDotShare * cell * metre, kLeastDot, kMostDot));
        const auto count = static_cast<GLsizei>(colours.size());
        gl_->glDrawArrays(GL_POINTS, first, count);
        first += count;
    }
    gl_->glDisable(GL_PROGRAM_POINT_SIZE);
}

} // namespace lightloom
