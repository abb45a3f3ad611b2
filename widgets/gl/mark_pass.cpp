// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/mark_pass.h"
#include "widgets/gl/over_picture.h"
#include "widgets/gl/renderer.h"
#include <cstddef>

namespace lightloom {

namespace {

constexpr float kNearest = 1e-4f; ///< clip-space w that a line is cut at

const void* offset(std::size_t bytes) { return reinterpret_cast<const void*>(bytes); }

} // namespace

Result<MarkPass> MarkPass::make(Gl& gl, const ShaderLibrary& shaders)
{
    Result<GlProgram> program = shaders.link(gl, "marks.vert", "pass_marks.frag");
    if (!program) return program.error();
    return MarkPass(gl, std::move(*program));
}

MarkPass::MarkPass(Gl& gl, GlProgram program) : gl_(&gl), program_(std::move(program)), array_(gl), buffer_(gl)
{
    gl_->glBindVertexArray(array_.id());
    gl_->glBindBuffer(GL_ARRAY_BUFFER, buffer_.id());
    const auto attribute = [&](GLuint location, GLint parts, std::size_t at) {
        gl_->glEnableVertexAttribArray(location);
        gl_->glVertexAttribPointer(location, parts, GL_FLOAT, GL_FALSE, sizeof(Vertex), offset(at));
    };
    attribute(0, 4, offsetof(Vertex, clip));
    attribute(1, 3, offsetof(Vertex, world));
    attribute(2, 4, offsetof(Vertex, colour));
    gl_->glBindVertexArray(0);
}

void MarkPass::addQuad(const Mark& mark, const glm::mat4& viewProjection, glm::vec2 window)
{
    glm::vec3 ends[2] = {mark.a, mark.b};
    glm::vec4 clip[2] = {viewProjection * glm::vec4(mark.a, 1.0f), viewProjection * glm::vec4(mark.b, 1.0f)};
    if (clip[0].w < kNearest && clip[1].w < kNearest) return;
    for (int i = 0; i < 2; ++i) { // the part behind the eye would come out on the other side
        if (clip[i].w >= kNearest) continue;
        const float t = (kNearest - clip[i].w) / (clip[1 - i].w - clip[i].w);
        clip[i] = glm::mix(clip[i], clip[1 - i], t);
        ends[i] = glm::mix(ends[i], ends[1 - i], t);
    }
    const auto pixel = [&](int i) { return glm::vec2(clip[i].x, clip[i].y) / clip[i].w * 0.5f * window; };
    glm::vec2 along = pixel(1) - pixel(0);
    const float length = glm::length(along);
    along = length > 1e-3f ? along / length : glm::vec2(1.0f, 0.0f);
    const glm::vec2 half = 0.5f * mark.width * along, side(-half.y, half.x);
    const auto corner = [&](int end, float across) {
        const glm::vec2 shift = (side * across + half * (end == 0 ? -1.0f : 1.0f)) * 2.0f / window;
        glm::vec4 at = clip[end];
        at.x += shift.x * at.w, at.y += shift.y * at.w;
        return Vertex{at, ends[end], mark.colour};
    };
    const Vertex quad[4] = {corner(0, -1.0f), corner(1, -1.0f), corner(0, 1.0f), corner(1, 1.0f)};
    for (const int i : {0, 1, 2, 2, 1, 3}) vertices_.push_back(quad[i]);
}

void MarkPass::draw(const FrameView& frame, const GBuffer& buffers, glm::ivec2 window)
{
    if (marks_.empty()) return;
    vertices_.clear();
    const glm::mat4 viewProjection = frame.projection * frame.view;
    for (const Mark& mark : marks_) addQuad(mark, viewProjection, glm::vec2(window));
    if (vertices_.empty()) return;
    gl_->glBindVertexArray(array_.id());
    gl_->glBindBuffer(GL_ARRAY_BUFFER, buffer_.id());
    gl_->glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices_.size() * sizeof(Vertex)), vertices_.data(),
                      GL_STREAM_DRAW);
    const OverPicture over(*gl_, program_, frame, buffers, window);
    gl_->glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices_.size()));
}

} // namespace lightloom
