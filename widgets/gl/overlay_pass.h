// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/base/image.h"
#include "core/compare/image_error.h"
#include "widgets/gl/gbuffer.h"
#include "widgets/gl/shader_library.h"

namespace lightloom {

struct FrameView;

/// Draws over the finished picture what was computed elsewhere for the same view: the photon map's picture all over it,
/// a reference picture or numbers in false colour over it or its left part. The context is current in all calls.
class OverlayPass {
public:
    [[nodiscard]] static Result<OverlayPass> make(Gl& gl, const ShaderLibrary& shaders);

    void setPicture(const FloatImage& radiance); ///< uploads at once; without pixels: none
    void setMade(const FloatImage& radiance);    ///< likewise
    /// In false colour up to `top`, signed numbers from -top; without values: none.
    void setMap(const ScalarImage& map, float top, bool isSigned);

    /// On the left `frame.wipe` of the target of `window` pixels, which is bound. `buffers` holds the frame's own sum
    /// over `samples` pictures. An empty vertex array is bound. Draws nothing where `frame.overlay` has no texture.
    void draw(const FrameView& frame, const GBuffer& buffers, int samples, glm::ivec2 window) const;

private:
    OverlayPass(Gl& gl, GlProgram picture, GlProgram map)
        : gl_(&gl), pictureProgram_(std::move(picture)), mapProgram_(std::move(map))
    {
    }
    void drawPicture(const GlTexture& picture, const FrameView& frame, const GBuffer& buffers, int samples) const;

    Gl* gl_;
    GlProgram pictureProgram_, mapProgram_;
    GlTexture picture_, made_, map_;
    float top_ = 1.0f;
    bool isSigned_ = false;
};

} // namespace lightloom
