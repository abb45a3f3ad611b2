// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/mode_vdl.h"
#include <cmath>

namespace lightloom {

Result<std::unique_ptr<ModeVdl>> ModeVdl::make(Gl& gl, const ShaderLibrary& shaders)
{
    Result<GlProgram> program = shaders.link(gl, "fullscreen.vert", "mode_vdl.frag");
    if (!program) return program.error();
    return std::unique_ptr<ModeVdl>(new ModeVdl(gl, std::move(*program)));
}

Result<Done> ModeVdl::setOctree(const std::shared_ptr<const GpuOctree>& octree)
{
    textures_.reset();
    octree_ = octree;
    if (!octree) return Done{};
    Result<OctreeTextures> uploaded = uploadOctree(gl_, *octree);
    if (!uploaded) return uploaded.error();
    textures_ = std::move(*uploaded);
    return Done{};
}

void ModeVdl::draw(const ModeFrame& frame)
{
    if (!textures_) return;
    program_.use();
    frame.buffers.bind(program_);
    program_.setTexture("bricks", 3, GL_TEXTURE_3D, textures_->bricks.id());
    program_.setTexture("vdls", 4, GL_TEXTURE_2D, textures_->vdls.id());
    program_.setTexture("normals", 5, GL_TEXTURE_2D, textures_->normals.id());
    program_.set("depth", octree_->depth);
    program_.set("deepest", octree_->deepest);
    program_.set("classEnds", std::span<const int>(octree_->classEnds));
    program_.set("hasDirections", !octree_->hasDirections ? 0 : octree_->isFirstFlat ? 2 : 1);
    program_.set("vdlWidth", octree_->vdlWidth);
    program_.set("normalWidth", octree_->normalWidth);
    program_.set("lowest", octree_->lowest);
    program_.set("cellSize", std::ldexp(octree_->rootSize, -octree_->depth));
    program_.set("colourScale", octree_->colourScale);
    program_.set("eye", frame.eye);
    program_.setTexture("gEmission", 6, GL_TEXTURE_2D, frame.buffers.emission.id());
    program_.set("mirrors", frame.mirrors ? 1 : 0);
    program_.set("showIlluminance", frame.showIlluminance ? 1 : 0);
    drawFullscreen(gl_);
}

} // namespace lightloom
