// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/scene_buffers.h"

namespace lightloom {

/// Lamps of the direct preview with their shadow maps: one layer for a spot or a sun, six (the faces of a cube) for a
/// point lamp or a patch of a shining surface. Maps hold linear distance. They are drawn once per scene, in slices, so
/// that no frame waits for them; dimming a lamp redraws none.
class ShadowMaps {
public:
    explicit ShadowMaps(Gl& gl);

    /// Allocates layers for the lights of `data` and marks them undrawn. Error: the driver refuses the textures.
    Result<Done> setScene(const DrawData& data);
    /// The same lamps, some of them elsewhere: layers of the others stay drawn. Where they need other layers than
    /// before, all are allocated and drawn anew.
    Result<Done> setLamps(const DrawData& data);
    /// Draws undrawn layers for about `budgetMs`, at least one. True when none is left.
    bool draw(const SceneBuffers& scene, const GlProgram& shadow, double budgetMs);
    [[nodiscard]] bool isComplete() const { return undrawn_ == 0; }
    /// Gain per light group; groups without one count 1.
    void setMix(const Mix& mix);
    /// Hands lights and maps to mode_direct.frag, which is in use: units `unit` and `unit` + 1.
    void bind(const GlProgram& direct, int unit) const;
    [[nodiscard]] int lightCount() const { return static_cast<int>(lights_.size()); }
    [[nodiscard]] int layersDrawn() const { return layersDrawn_; } ///< since the program began; tests read it

private:
    struct Layer {
        bool inCube = true;
        int index = 0; ///< in its texture array
        glm::mat4 viewProjection{1.0f};
        glm::vec4 lamp{0.0f}; ///< as shadow.frag wants it
        glm::vec2 range{0.0f, 1.0f};
        bool isDrawn = false;
    };
    /// std140 of mode_direct.frag.
    struct SampleLight {
        glm::vec4 position, travel, colour, shadow, texel;
    };
    void plan(const DrawData& data);
    void addCube(const PreviewLight& light, float reach, SampleLight& out);
    void addSpot(const PreviewLight& light, float reach, SampleLight& out);
    void addSun(const PreviewLight& light, const Bounds& bounds, SampleLight& out);
    Result<Done> allocate();

    Gl& gl_;
    GlTexture flat_, cube_;
    GlFramebuffer target_;
    GlBuffer block_;
    std::vector<PreviewLight> lights_;
    std::vector<SampleLight> samples_; ///< at gain 1
    std::vector<glm::mat4> matrices_;  ///< of flat layers
    std::vector<Layer> layers_;
    std::size_t undrawn_ = 0;
    int cubeLayers_ = 0, cubeSide_ = 1, flatSide_ = 1, layersDrawn_ = 0;
};

} // namespace lightloom
