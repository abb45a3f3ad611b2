// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/gbuffer.h"
#include "widgets/gl/shader_library.h"
#include "widgets/voxel_discs.h"

namespace lightloom {

struct FrameView;

/// Draws voxels' entries as discs over the finished picture, as far as they face the eye and nothing hides them. The
/// context is current in all calls.
class DiscPass {
public:
    [[nodiscard]] static Result<DiscPass> make(Gl& gl, const ShaderLibrary& shaders);

    void setDiscs(std::shared_ptr<const VoxelDiscs> discs); ///< null: none
    /// Into the bound target of `window` pixels; `buffers` hold the surfaces of the same view.
    void draw(const FrameView& frame, const GBuffer& buffers, glm::ivec2 window);

private:
    DiscPass(Gl& gl, GlProgram program);

    Gl* gl_;
    GlProgram program_;
    GlVertexArray array_;
    GlBuffer buffer_;
    std::shared_ptr<const VoxelDiscs> discs_;
};

} // namespace lightloom
