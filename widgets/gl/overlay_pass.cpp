// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/overlay_pass.h"
#include "shaders/common.h"
#include "widgets/gl/renderer.h"
#include <cmath>

namespace lightloom {

Result<OverlayPass> OverlayPass::make(Gl& gl, const ShaderLibrary& shaders)
{
    Result<GlProgram> picture = shaders.link(gl, "fullscreen.vert", "pass_reference.frag");
    if (!picture) return picture.error();
    Result<GlProgram> map = shaders.link(gl, "fullscreen.vert", "pass_heatmap.frag");
    if (!map) return map.error();
    return OverlayPass(gl, std::move(*picture), std::move(*map));
}

namespace {

GlTexture upload(Gl& gl, const FloatImage& radiance)
{
    if (radiance.pixels.empty()) return {};
    return makeTexture2D(gl, GL_RGB32F, {radiance.width, radiance.height}, GL_RGB, GL_FLOAT, radiance.pixels.data());
}

} // namespace

void OverlayPass::setPicture(const FloatImage& radiance) { picture_ = upload(*gl_, radiance); }
void OverlayPass::setMade(const FloatImage& radiance) { made_ = upload(*gl_, radiance); }

void OverlayPass::setMap(const ScalarImage& map, float top, bool isSigned)
{
    map_.reset();
    if (map.values.empty()) return;
    map_ = makeTexture2D(*gl_, GL_R32F, {map.width, map.height}, GL_RED, GL_FLOAT, map.values.data());
    top_ = top;
    isSigned_ = isSigned;
}

void OverlayPass::draw(const FrameView& frame, const GBuffer& buffers, int samples, glm::ivec2 window) const
{
    if (frame.showsMade && made_) drawPicture(made_, frame, buffers, samples);
    const bool isMap = frame.overlay == Overlay::map;
    const GlTexture& texture = isMap ? map_ : picture_;
    if (frame.overlay == Overlay::none || !texture) return;
    gl_->glEnable(GL_SCISSOR_TEST);
    gl_->glScissor(0, 0, static_cast<int>(std::lround(frame.wipe * static_cast<float>(window.x))), window.y);
    if (isMap) {
        mapProgram_.use();
        mapProgram_.setTexture("numbers", 0, GL_TEXTURE_2D, texture.id());
        mapProgram_.set("top", top_);
        mapProgram_.set("isSigned", isSigned_ ? 1 : 0);
        drawFullscreen(*gl_);
    } else {
        drawPicture(texture, frame, buffers, samples);
    }
    gl_->glDisable(GL_SCISSOR_TEST);
}

void OverlayPass::drawPicture(const GlTexture& picture, const FrameView& frame, const GBuffer& buffers,
                              int samples) const
{
    pictureProgram_.use();
    pictureProgram_.setTexture("picture", 0, GL_TEXTURE_2D, picture.id());
    pictureProgram_.setTexture("covered", 1, GL_TEXTURE_2D, buffers.sum.id());
    pictureProgram_.set("samples", static_cast<float>(samples));
    pictureProgram_.set("scale", shader::exposureScale(frame.exposureEv));
    pictureProgram_.set("tone", frame.tone);
    pictureProgram_.set("background", frame.background);
    drawFullscreen(*gl_);
}

} // namespace lightloom
