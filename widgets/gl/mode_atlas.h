// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/atlas_draw.h"
#include "widgets/gl/preview_mode.h"
#include "widgets/gl/shader_library.h"
#include <array>

namespace lightloom {

/// Indirect light from an atlas (Vivanloc et al. 2007, section 4.2.3): the bake is rendered into a lightmap when its
/// light is new, and each pixel reads one texel then. Directions are gone there: metals show none of it.
class ModeAtlas final : public PreviewMode {
public:
    /// Error: the shaders do not compile here.
    [[nodiscard]] static Result<std::unique_ptr<ModeAtlas>> make(Gl& gl, const ShaderLibrary& shaders);

    /// Null: nothing is shown from now on. Error: the atlas does not fit this driver's textures; nothing is shown.
    Result<Done> setAtlas(const std::shared_ptr<const AtlasDraw>& atlas);
    /// The bake's light is another; what was rendered is shown until `render` has done it again.
    void lightChanged() { step_ = 0; }
    /// Goes on rendering `bake` into the atlas for about `budgetMs`. True when there is no more to do.
    bool render(PreviewMode& bake, double budgetMs);
    [[nodiscard]] bool isReady() const { return isShown_; } ///< has light to show, maybe of before

    void draw(const ModeFrame& frame) override;

    /// For tests: lux per texel, w 1 where it is known.
    [[nodiscard]] std::vector<glm::vec4> readBack() const;

private:
    explicit ModeAtlas(Gl& gl) : gl_(gl) {}
    void renderBand(PreviewMode& bake, int band);
    bool fillRing(); ///< false: there was nothing more to fill

    /// A picture of the atlas: one that is shown, two to work with in turn.
    struct Picture {
        GlTexture light;
        GlFramebuffer target;
    };
    Gl& gl_;
    GlProgram fillProgram_, drawProgram_;
    std::shared_ptr<const AtlasDraw> atlas_;
    GBuffer texels_; ///< positions and normals of the atlas's texels, in place of what a camera sees
    GlTexture owners_;
    std::array<Picture, 3> pictures_;
    std::size_t shown_ = 0, from_ = 1, to_ = 2; ///< into `pictures_`
    GlVertexArray array_, empty_;
    GlBuffer vertices_;
    int step_ = 0;
    bool isShown_ = false;
};

} // namespace lightloom
