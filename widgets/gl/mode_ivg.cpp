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
           line("SHARED_TEXELS", grid.sharedTexels) + line("SLOPES", grid.hasSlopes ? 1 : 0) +
           line("NESTED", grid.inside ? 1 : 0);
}

constexpr int kOuterUnit = 3, kInnerUnit = 7; ///< first of three; 6 has the emission

/// Hands a grid to the program in use: the uniform `name`, and its textures to samplers whose names begin so.
void setGridUniforms(const GlProgram& program, const QByteArray& name, int unit, const GpuGrid& grid,
                     const GridTextures& textures)
{
    const auto bind = [&](const char* what, int at, const GlTexture& texture) {
        program.setTexture((name + what).constData(), at, GL_TEXTURE_3D, texture.id());
    };
    bind("Light", unit, textures.light);
    bind("Sight", unit + 1, textures.sight);
    if (textures.places) bind("Places", unit + 2, textures.places);
    const auto set = [&](const char* what, const auto& value) { program.set((name + what).constData(), value); };
    set(".slabs", grid.slabs);
    set(".cells", grid.lattice.cells);
    set(".lowest", grid.lattice.lowest);
    set(".cellSize", grid.lattice.cellSize);
    set(".scale", grid.scale);
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
    inner_.reset();
    grid_ = grid;
    if (!grid) return Done{};
    const Result<const GlProgram*> program = programFor(ShaderLibrary(), *grid);
    if (!program) return program.error();
    program_ = *program;
    Result<GridTextures> uploaded = uploadGrid(gl_, *grid);
    if (!uploaded) return uploaded.error();
    if (grid->inside) {
        Result<GridTextures> finer = uploadGrid(gl_, *grid->inside);
        if (!finer) return finer.error();
        inner_ = std::move(*finer);
    }
    textures_ = std::move(*uploaded);
    return Done{};
}

void ModeIvg::draw(const ModeFrame& frame)
{
    if (!textures_) return;
    program_->use();
    frame.buffers.bind(*program_);
    program_->setTexture("gEmission", 6, GL_TEXTURE_2D, frame.buffers.emission.id());
    setGridUniforms(*program_, "outer", kOuterUnit, *grid_, *textures_);
    if (inner_) {
        setGridUniforms(*program_, "inner", kInnerUnit, *grid_->inside, *inner_);
        program_->set("boxLow", grid_->box.low);
        program_->set("boxHigh", grid_->box.high);
        program_->set("fade", grid_->fade);
        program_->set("once", 1);
    }
    program_->set("offset", grid_->show.offset);
    program_->set("mirrors", frame.mirrors ? 1 : 0);
    program_->set("showIlluminance", frame.showIlluminance ? 1 : 0);
    drawFullscreen(gl_);
}

} // namespace lightloom
