// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/mode_ivg.h"

namespace lightloom {

namespace {

QByteArray definesFor(const GpuGrid& grid)
{
    const auto line = [](const char* name, int value) {
        return QByteArray("#define ") + name + " " + QByteArray::number(value) + "\n";
    };
    return line("FILTER", static_cast<int>(grid.show.filter)) + line("SIDE_TEXELS", grid.sideTexels) +
           line("SHARED_TEXELS", grid.sharedTexels) + line("SLOPES", grid.hasSlopes ? 1 : 0);
}

} // namespace

Result<std::unique_ptr<ModeIvg>> ModeIvg::make(Gl& gl, const ShaderLibrary& shaders)
{
    auto mode = std::unique_ptr<ModeIvg>(new ModeIvg(gl));
    GpuGrid usual; // what most bakes are shown in
    usual.sharedTexels = 5;
    const Result<const GlProgram*> made = mode->programFor(shaders, usual);
    if (!made) return made.error();
    return mode;
}

Result<const GlProgram*> ModeIvg::programFor(const ShaderLibrary& shaders, const GpuGrid& grid)
{
    const QByteArray defines = definesFor(grid);
    if (const auto known = programs_.find(defines); known != programs_.end()) return &known->second;
    Result<GlProgram> made = shaders.link(gl_, "fullscreen.vert", "mode_ivg.frag", defines);
    if (!made) return made.error();
    return &programs_.emplace(defines, std::move(*made)).first->second;
}

Result<Done> ModeIvg::setGrid(const std::shared_ptr<const GpuGrid>& grid)
{
    textures_.reset();
    grid_ = grid;
    if (!grid) return Done{};
    const Result<const GlProgram*> program = programFor(ShaderLibrary(), *grid);
    if (!program) return program.error();
    program_ = *program;
    Result<GridTextures> uploaded = uploadGrid(gl_, *grid);
    if (!uploaded) return uploaded.error();
    textures_ = std::move(*uploaded);
    return Done{};
}

void ModeIvg::draw(const ModeFrame& frame)
{
    if (!textures_) return;
    program_->use();
    frame.buffers.bind(*program_);
    program_->setTexture("light", 3, GL_TEXTURE_3D, textures_->light.id());
    program_->setTexture("sight", 4, GL_TEXTURE_3D, textures_->sight.id());
    if (textures_->places) program_->setTexture("places", 5, GL_TEXTURE_3D, textures_->places.id());
    program_->setTexture("gEmission", 6, GL_TEXTURE_2D, frame.buffers.emission.id());
    program_->set("slabs", grid_->slabs);
    program_->set("cells", grid_->lattice.cells);
    program_->set("lowest", grid_->lattice.lowest);
    program_->set("cellSize", grid_->lattice.cellSize);
    program_->set("offset", grid_->show.offset);
    program_->set("scale", grid_->scale);
    program_->set("mirrors", frame.mirrors ? 1 : 0);
    program_->set("showIlluminance", frame.showIlluminance ? 1 : 0);
    drawFullscreen(gl_);
}

} // namespace lightloom
