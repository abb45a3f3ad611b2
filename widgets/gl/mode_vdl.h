// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/bake/gpu_layout.h"
#include "widgets/gl/preview_mode.h"
#include "widgets/gl/shader_library.h"
#include "widgets/gl/texture_upload.h"
#include <memory>
#include <optional>

namespace lightloom {

/// Indirect light from a light octree's virtual directional lights, interpolated over eight leaves per pixel.
class ModeVdl final : public PreviewMode {
public:
    /// Error: the shader does not compile here.
    [[nodiscard]] static Result<std::unique_ptr<ModeVdl>> make(Gl& gl, const ShaderLibrary& shaders);

    /// Null: nothing is shown from now on. Error: the octree does not fit this driver's textures; nothing is shown.
    Result<Done> setOctree(const std::shared_ptr<const GpuOctree>& octree);
    void draw(const ModeFrame& frame) override;

private:
    ModeVdl(Gl& gl, GlProgram program) : gl_(gl), program_(std::move(program)) {}
    Gl& gl_;
    GlProgram program_;
    std::optional<OctreeTextures> textures_;
    std::shared_ptr<const GpuOctree> octree_;
};

} // namespace lightloom
