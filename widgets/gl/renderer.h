// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "widgets/gl/disc_pass.h"
#include "widgets/gl/environment_maps.h"
#include "widgets/gl/mark_pass.h"
#include "widgets/gl/mode_atlas.h"
#include "widgets/gl/mode_ivg.h"
#include "widgets/gl/mode_vdl.h"
#include "widgets/gl/overlay_pass.h"
#include "widgets/gl/scene_buffers.h"
#include "widgets/gl/shadow_maps.h"
#include "widgets/gl/vertex_pass.h"
#include <optional>

namespace lightloom {

/// What the viewport shows of the scene.
enum class ViewMode {
    octree,    ///< direct light of the lamps and indirect light of the bake, a light octree
    grid,      ///< the same, an irradiance grid; until there is one, what there is
    lightcuts, ///< the same, voxels; a picture that the processor renders from them lies over it once it is there
    atlas,     ///< the same through a lightmap: each pixel reads one texel; the bake until there is one
    colours,   ///< as octree, with a colour octree: accumulated illuminance without directions
    photonMap, ///< a picture that the processor renders from the photon map; the octree until there is one
    direct,    ///< direct light only
    plain,     ///< form without light: base colour times the cosine towards the camera
    reference  ///< the path-traced picture; the viewport lays it over one of the others
};

/// What is laid over it.
enum class Overlay { none, picture, map };

struct FrameView {
    glm::mat4 view{1.0f}, projection{1.0f};
    glm::vec3 eye{0.0f};
    ViewMode mode = ViewMode::octree;
    bool indirectOnly = false;  ///< octree mode without lamps and glow
    bool willRefine = false;    ///< the picture rests at full size, and `refine` will be called for it
    float exposureEv = 10.0f;   ///< at ISO 100
    int tone = 1;               ///< kToneNone, kToneSoft
    glm::vec3 background{0.2f}; ///< as shown, not linear
    bool showsMade = false;     ///< a picture that the processor made covers the frame
    Overlay overlay = Overlay::none;
    float wipe = 1.0f; ///< part of the width, from the left, that the overlay covers
};

/// Draws a scene with its light. All calls with the context current; keeps no widget and no thread.
class Renderer {
public:
    /// Error: shaders do not compile here.
    [[nodiscard]] static Result<std::unique_ptr<Renderer>> make(Gl& gl);

    /// Null empties the picture. The light of an earlier scene goes. Error: out of what the driver offers.
    Result<Done> setScene(std::shared_ptr<const DrawData> data);
    /// An edit of the scene's lamps; its light stays until other comes.
    Result<Done> setLamps(const DrawData& data);
    /// Light of the bake, an octree (or voxels in the form of one) or a grid: the one that was set last.
    Result<Done> setOctree(const std::shared_ptr<const GpuOctree>& octree);
    Result<Done> setGrid(const std::shared_ptr<const GpuGrid>& grid);
    Result<Done> setColours(const std::shared_ptr<const GpuOctree>& octree); ///< a colour octree
    /// An object that was not in the bake: it gets the lamps' light, throws shadows in it (when `drawShadows` has drawn
    /// them), and gets the bake's light where that knows light in space (a grid). It takes nothing from the bake's
    /// light and is in no mirror. Null: none. Goes with the scene.
    void setGuest(const std::shared_ptr<const DrawData>& data);
    void setGuestPlace(const glm::mat4& place); ///< scene space; no mirroring. The same place again costs nothing
    void setMix(const Mix& mix);
    [[nodiscard]] OverlayPass& overlay() { return *overlay_; }
    [[nodiscard]] MarkPass& marks() { return *marks_; }
    [[nodiscard]] VertexPass& vertices() { return *vertices_; }
    [[nodiscard]] DiscPass& discs() { return *discs_; }

    /// Draws picture number `sample` (0 begins anew) of those that are averaged, at `size` pixels, and shows the mean
    /// stretched over `window` pixels of framebuffer `target`. Samples after the first are taken through pixels shifted
    /// by less than half, so that edges smooth while the picture rests. Error: the driver refuses the buffers.
    Result<Done> draw(const FrameView& frame, int sample, glm::ivec2 size, GLuint target, glm::ivec2 window);
    /// The same in parts, for pictures that are dear: `begin` draws the surfaces, `shade` lights rows of them from
    /// below for about `budgetMs` (waiting for the GPU, to measure; at least a few rows). True: the picture is whole
    /// and in the sum, to be shown with `present`. Another `begin` drops what is not whole. The same bits as `draw`.
    Result<Done> begin(const FrameView& frame, int sample, glm::ivec2 size);
    bool shade(double budgetMs);
    /// Shows again what `draw` has summed up over `samples` pictures, under another exposure or wipe.
    void present(const FrameView& frame, int samples, GLuint target, glm::ivec2 window);
    enum class Refined { part, round, all };
    /// A small part of the work that makes the direct light under the last picture even: one lamp's, at another point
    /// of its surface, with shadow maps of its own. After a round of all lamps `present` shows the mean of all rounds
    /// so far; after some rounds nothing more is gained. `frame` as the pictures were drawn, all with `willRefine`.
    Refined refine(const FrameView& frame);
    [[nodiscard]] bool mayRefine(const FrameView& frame) const; ///< it shows lamps' direct light
    void finish() { gl_.glFinish(); }                           ///< waits for the GPU, to measure
    /// Undrawn shadow maps for about `budgetMs`. True when all are there.
    bool drawShadows(double budgetMs);
    /// Null: none. Goes with the scene.
    Result<Done> setAtlas(const std::shared_ptr<const AtlasDraw>& atlas) { return atlas_->setAtlas(atlas); }
    /// The bake into the atlas, for about `budgetMs`. True when all of its light is there.
    bool renderAtlas(double budgetMs) { return atlas_->render(bake(), budgetMs); }
    [[nodiscard]] std::vector<glm::vec4> readAtlas() const { return atlas_->readBack(); } ///< for tests
    /// Faces of environment maps whose light is not what it was, for about `budgetMs`, once all shadow maps are there.
    /// True when all are as they should be.
    bool drawEnvironments(double budgetMs);
    [[nodiscard]] int environmentCount() const { return environments_->count(); }
    [[nodiscard]] int shadowLayersDrawn() const { return shadows_.layersDrawn(); }

    struct SurfaceSample {
        glm::vec3 position, normal; ///< scene space
        bool isGuest = false;
    };
    /// Surface in the last picture at `at` (0 to 1, from the lower left). Reads one pixel back.
    [[nodiscard]] std::optional<SurfaceSample> surfaceAt(glm::vec2 at) const;

    /// For tests and measurements: lux (x, y, z) and 1 (w) per pixel of the last picture's surfaces, recomputed.
    /// Rows from below. Indirect alone, from what `frame.mode` shows, or direct alone.
    [[nodiscard]] std::vector<glm::vec4> illuminance(const FrameView& frame, bool indirect);
    struct Pixels {
        glm::ivec2 size{0};
        std::vector<glm::vec4> position, normal, light; ///< w of position: 1 where there is a surface
    };
    [[nodiscard]] Pixels readBack() const;
    /// The picture as it is shown after `samples` of them, refined as far as it is, cd/m2; w: as Pixels::position.
    [[nodiscard]] std::vector<glm::vec4> picture(int samples) const;
    /// Mean of log2 luminance (cd/m2) over lit pixels of the last picture; nothing where all is dark.
    [[nodiscard]] std::optional<float> meanLogLuminance() const;

    [[nodiscard]] std::size_t sceneBytes() const { return scene_ ? scene_->bytes() : 0; }

private:
    explicit Renderer(Gl& gl) : gl_(gl), shadows_(gl), empty_(gl) {}
    Result<Done> linkPrograms();
    void scaleEmission();                               ///< so that what glows stays within half floats
    [[nodiscard]] static glm::vec2 shiftOf(int sample); ///< where in a pixel it looks, -0.5 to 0.5
    void drawSurfaces(const GBuffer& buffers, const FrameView& frame, glm::vec2 shift, int without);
    void drawLight(const GBuffer& buffers, const FrameView& frame, bool mirrors);
    [[nodiscard]] PreviewMode& bake();                    ///< that was set last
    [[nodiscard]] PreviewMode* indirectOf(ViewMode mode); ///< null: the mode shows no indirect light
    void drawDirect(const ModeFrame& frame, int lights, float emissionScale, bool ofOne = false);
    void makeRefinement(const FrameView& frame);
    [[nodiscard]] float refinedShare() const; ///< of the refinement that is shown
    void drawGlass(const GBuffer& buffers, const FrameView& frame, glm::vec2 shift);
    void addLightTo(const GBuffer& buffers, const GlFramebuffer& sum, bool first);
    void shadeRows(int rows); ///< of `unlit_`, the next ones

    struct Unlit {
        FrameView frame;
        int sample = 0, row = 0; ///< rows below are lit
    };
    Gl& gl_;
    GlProgram surfaceProgram_, shadowProgram_, directProgram_, plainProgram_, postProgram_, copyProgram_, glassProgram_,
        refinedProgram_;
    std::unique_ptr<ModeVdl> vdl_, colours_;
    std::unique_ptr<ModeIvg> grid_;
    std::optional<OverlayPass> overlay_;
    std::optional<MarkPass> marks_;
    std::optional<VertexPass> vertices_;
    std::optional<DiscPass> discs_;
    std::optional<EnvironmentMaps> environments_;
    ShadowMaps shadows_;
    GlVertexArray empty_;
    std::optional<SceneBuffers> scene_, guest_;
    std::optional<glm::mat4> guestPlace_; ///< that shadows know
    std::optional<GBuffer> buffers_;
    std::unique_ptr<ModeAtlas> atlas_;
    glm::mat4 viewProjection_{1.0f}; ///< of the surfaces drawn last
    float emissionScale_ = 1.0f;
    std::optional<Unlit> unlit_;               ///< a picture between `begin` and its last row
    double rowMs_ = 0.0;                       ///< of the rows that were lit last; 0: not known
    int coarseSamples_ = 0;                    ///< in GBuffer::directSum
    int refinedRounds_ = 0, refinedLight_ = 0; ///< whole ones, and of the next one
};

} // namespace lightloom
