// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/gbuffer.h"
#include "widgets/gl/shader_library.h"
#include <vector>

namespace lightloom {

struct FrameView;

/// A line of some pixels' width in the scene; where its ends coincide, a square dot.
struct Mark {
    glm::vec3 a{0.0f}, b{0.0f}; ///< scene space
    glm::vec4 colour{1.0f};     ///< as shown, not linear
    float width = 2.0f;         ///< pixels of the window
};

/// Draws marks over the finished picture; what surfaces hide of them is faint. The context is current in all calls.
class MarkPass {
public:
    [[nodiscard]] static Result<MarkPass> make(Gl& gl, const ShaderLibrary& shaders);

    void setMarks(std::vector<Mark> marks) { marks_ = std::move(marks); }
    /// Into the bound target of `window` pixels; `buffers` hold the surfaces of the same view.
    void draw(const FrameView& frame, const GBuffer& buffers, glm::ivec2 window);

private:
    struct Vertex {
        glm::vec4 clip;
        glm::vec3 world;
        glm::vec4 colour;
    };
    MarkPass(Gl& gl, GlProgram program);
    void addQuad(const Mark& mark, const glm::mat4& viewProjection, glm::vec2 window);

    Gl* gl_;
    GlProgram program_;
    GlVertexArray array_;
    GlBuffer buffer_;
    std::vector<Mark> marks_;
    std::vector<Vertex> vertices_; ///< of the frame that is drawn; kept for its memory
};

} // namespace lightloom
