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
    Result<GlProgram> errors = shaders.link(gl, "fullscreen.vert", "pass_heatmap.frag");
    if (!errors) return errors.error();
    return OverlayPass(gl, std::move(*picture), std::move(*errors));
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

void OverlayPass::setErrors(const ViewError& error)
{
    errors_.reset();
    if (error.map.values.empty()) return;
    errors_ =
        makeTexture2D(*gl_, GL_R32F, {error.map.width, error.map.height}, GL_RED, GL_FLOAT, error.map.values.data());
    top_ = error.top;
    isSigned_ = error.kind == ErrorKind::difference;
}

void OverlayPass::draw(const FrameView& frame, const GBuffer& buffers, int samples, glm::ivec2 window) const
{
    if (frame.showsMade && made_) drawPicture(made_, frame, buffers, samples);
    const bool isErrors = frame.overlay == Overlay::errors;
    const GlTexture& texture = isErrors ? errors_ : picture_;
    if (frame.overlay == Overlay::none || !texture) return;
    gl_->glEnable(GL_SCISSOR_TEST);
    gl_->glScissor(0, 0, static_cast<int>(std::lround(frame.wipe * static_cast<float>(window.x))), window.y);
    if (isErrors) {
        errorProgram_.use();
        errorProgram_.setTexture("errors", 0, GL_TEXTURE_2D, texture.id());
        errorProgram_.set("top", top_);
        errorProgram_.set("isSigned", isSigned_ ? 1 : 0);
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
