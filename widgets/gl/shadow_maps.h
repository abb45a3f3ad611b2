// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/field/solver.h"
#include "widgets/gl/scene_buffers.h"
#include <optional>

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
    /// An object that throws shadows too, in `box` (scene space). Layers that see that place, or the one before, are
    /// drawn anew in slices like the others; until then they show what they did. Null: there is none any more. It must
    /// live until another one is set.
    void setGuest(const SceneBuffers* guest, const Bounds& box);
    /// Draws undrawn layers for about `budgetMs`, at least one. True when none is left.
    bool draw(const SceneBuffers& scene, const GlProgram& shadow, double budgetMs);
    [[nodiscard]] bool isComplete() const { return undrawn_ == 0; }
    [[nodiscard]] bool lacksScene() const; ///< some layer was never drawn: more than a guest is missing
    /// Gain per light group; groups without one count 1.
    void setMix(const Mix& mix);
    /// Hands lights and maps to mode_direct.frag, which is in use: units `unit` and `unit` + 1.
    void bind(const GlProgram& direct, int unit) const;
    [[nodiscard]] int lightCount() const { return static_cast<int>(lights_.size()); }
    /// One light alone with maps of its own, beside those of all: at point number `round` of its surface, and with its
    /// maps turned, so that the steps of their texels lie elsewhere each time. False: it is dimmed to nothing.
    bool drawOne(const SceneBuffers& scene, const GlProgram& shadow, int light, int round);
    void bindOne(const GlProgram& direct, int unit) const;         ///< as `bind`, of the light drawn last; count 1
    [[nodiscard]] int refineRounds() const;                        ///< after which lamps and steps of texels are even
    [[nodiscard]] int layersDrawn() const { return layersDrawn_; } ///< kept ones, ever; tests read it

private:
    struct Layer {
        bool inCube = true;
        int index = 0; ///< in its texture array
        glm::mat4 viewProjection{1.0f};
        glm::vec4 lamp{0.0f}; ///< as shadow.frag wants it
        glm::vec2 range{0.0f, 1.0f};
        bool isDrawn = false;
        bool isOld = false; ///< not drawn since a guest moved
    };
    /// std140 of mode_direct.frag.
    struct SampleLight {
        glm::vec4 position, travel, colour, shadow, texel;
    };
    /// What a light needs of the maps.
    struct Maps {
        SampleLight sample;
        std::vector<Layer> layers;
        std::optional<glm::mat4> matrix; ///< of its flat layer
    };
    /// `first`: its first layer, of cubes or of flat ones; `matrix`: number of its matrix; `turn`: of its maps.
    [[nodiscard]] Maps mapsOf(const PreviewLight& light, int first, int matrix, const glm::mat3& turn) const;
    void addCube(const PreviewLight& light, float reach, int first, const glm::mat3& turn, Maps& out) const;
    void addSpot(const PreviewLight& light, float reach, int index, int matrix, const glm::mat3& turn, Maps& out) const;
    void addSun(const PreviewLight& light, int index, int matrix, const glm::mat3& turn, Maps& out) const;
    void plan(const DrawData& data);
    Result<Done> allocate();
    void drawLayer(const SceneBuffers& scene, const GlProgram& shadow, const Layer& layer);
    void fill(const GlBuffer& block, const std::vector<SampleLight>& lights, const std::vector<glm::mat4>& matrices);
    void bindMaps(const GlProgram& direct, int unit, const glm::mat3& turn, const GlBuffer& block) const;

    Gl& gl_;
    GlTexture flat_, cube_;
    GlFramebuffer target_;
    GlBuffer block_, blockOfOne_;
    Mix mix_;
    Bounds bounds_;
    glm::mat3 turnOfOne_{1.0f};
    std::vector<PreviewLight> lights_;
    std::vector<SampleLight> samples_; ///< at gain 1
    std::vector<glm::mat4> matrices_;  ///< of flat layers
    std::vector<Layer> layers_;
    std::size_t undrawn_ = 0, next_ = 0; ///< next: to be looked at when layers are drawn
    const SceneBuffers* guest_ = nullptr;
    Bounds guestBox_;
    int cubeLayers_ = 0, cubeSide_ = 1, flatSide_ = 1, layersDrawn_ = 0;
};

} // namespace lightloom
