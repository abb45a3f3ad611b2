// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/ivg/grid_gpu.h"
#include "widgets/gl/preview_mode.h"
#include "widgets/gl/shader_library.h"
#include "widgets/gl/texture_upload.h"
#include <map>
#include <memory>
#include <optional>

namespace lightloom {

/// Indirect light from an irradiance grid: for every surface in it, whether it was baked with it or not.
class ModeIvg final : public PreviewMode {
public:
    /// Error: the shader of the default form does not compile here.
    [[nodiscard]] static Result<std::unique_ptr<ModeIvg>> make(Gl& gl, const ShaderLibrary& shaders);

    /// Null: nothing is shown from now on. Error: the grid does not fit this driver's textures, or its form's shader
    /// does not compile here; nothing is shown.
    Result<Done> setGrid(const std::shared_ptr<const GpuGrid>& grid);
    [[nodiscard]] bool hasGrid() const { return textures_.has_value(); }
    void draw(const ModeFrame& frame) override;

private:
    explicit ModeIvg(Gl& gl) : gl_(gl) {}
    /// A program per form and filter, made when it is first asked for.
    Result<const GlProgram*> programFor(const ShaderLibrary& shaders, const GpuGrid& grid);

    Gl& gl_;
    std::map<QByteArray, GlProgram> programs_;     ///< by their defines
    const GlProgram* program_ = nullptr;           ///< of the grid that is shown
    std::optional<GridTextures> textures_, inner_; ///< inner: of the finer grid, if there is one
    std::shared_ptr<const GpuGrid> grid_;
};

} // namespace lightloom
