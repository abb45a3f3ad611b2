// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/gbuffer.h"
#include "widgets/gl/shader_library.h"
#include "widgets/grid_vertices.h"

namespace lightloom {

struct FrameView;

/// Draws a grid's vertices as dots over the finished picture; what surfaces hide of them is faint. The context is
/// current in all calls.
class VertexPass {
public:
    [[nodiscard]] static Result<VertexPass> make(Gl& gl, const ShaderLibrary& shaders);

    void setVertices(std::shared_ptr<const GridVertices> vertices); ///< null: none
    /// Into the bound target of `window` pixels; `buffers` hold the surfaces of the same view.
    void draw(const FrameView& frame, const GBuffer& buffers, glm::ivec2 window);

private:
    VertexPass(Gl& gl, GlProgram program);

    Gl* gl_;
    GlProgram program_;
    GlVertexArray array_;
    GlBuffer buffer_;
    std::shared_ptr<const GridVertices> vertices_;
};

} // namespace lightloom
