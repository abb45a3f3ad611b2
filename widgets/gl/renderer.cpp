// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/renderer.h"
#include "core/base/units.h"
#include "shaders/common.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightloom {

namespace {

constexpr int kGuestMark = -1;         ///< in place of an environment map's number
constexpr float kMostHalf = 60'000.0f; ///< emission is scaled to stay below the end of half floats

} // namespace

Result<std::unique_ptr<Renderer>> Renderer::make(Gl& gl)
{
    auto renderer = std::unique_ptr<Renderer>(new Renderer(gl));
    if (const Result<Done> linked = renderer->linkPrograms(); !linked) return linked.error();
    return renderer;
}

Result<Done> Renderer::linkPrograms()
{
    const ShaderLibrary shaders;
    const struct {
        GlProgram& program;
        const char *vertex, *fragment;
    } wanted[] = {{surfaceProgram_, "scene.vert", "scene.frag"},
                  {shadowProgram_, "shadow.vert", "shadow.frag"},
                  {directProgram_, "fullscreen.vert", "mode_direct.frag"},
                  {plainProgram_, "fullscreen.vert", "mode_plain.frag"},
                  {postProgram_, "fullscreen.vert", "pass_post.frag"},
                  {copyProgram_, "fullscreen.vert", "pass_copy.frag"},
                  {refinedProgram_, "fullscreen.vert", "pass_refined.frag"},
                  {glassProgram_, "scene.vert", "glass.frag"}};
    for (const auto& each : wanted) {
        Result<GlProgram> linked = shaders.link(gl_, each.vertex, each.fragment);
        if (!linked) return linked.error();
        each.program = std::move(*linked);
    }
    for (std::unique_ptr<ModeVdl>* mode : {&vdl_, &colours_}) {
        Result<std::unique_ptr<ModeVdl>> made = ModeVdl::make(gl_, shaders);
        if (!made) return made.error();
        *mode = std::move(*made);
    }
    Result<std::unique_ptr<ModeIvg>> grid = ModeIvg::make(gl_, shaders);
    if (!grid) return grid.error();
    grid_ = std::move(*grid);
    Result<std::unique_ptr<ModeAtlas>> atlas = ModeAtlas::make(gl_, shaders);
    if (!atlas) return atlas.error();
    atlas_ = std::move(*atlas);
    Result<OverlayPass> overlay = OverlayPass::make(gl_, shaders);
    if (!overlay) return overlay.error();
    overlay_.emplace(std::move(*overlay));
    Result<MarkPass> marks = MarkPass::make(gl_, shaders);
    if (!marks) return marks.error();
    marks_.emplace(std::move(*marks));
    Result<VertexPass> vertices = VertexPass::make(gl_, shaders);
    if (!vertices) return vertices.error();
    vertices_.emplace(std::move(*vertices));
    Result<DiscPass> discs = DiscPass::make(gl_, shaders);
    if (!discs) return discs.error();
    discs_.emplace(std::move(*discs));
    Result<EnvironmentMaps> environments = EnvironmentMaps::make(gl_, shaders);
    if (!environments) return environments.error();
    environments_.emplace(std::move(*environments));
    return Done{};
}

Result<Done> Renderer::setScene(std::shared_ptr<const DrawData> data)
{
    setGuest(nullptr);
    scene_.reset();
    unlit_.reset();
    (void)vdl_->setOctree(nullptr); // dropping cannot fail
    (void)grid_->setGrid(nullptr);
    vertices_->setVertices(nullptr);
    discs_->setDiscs(nullptr);
    (void)atlas_->setAtlas(nullptr);
    (void)colours_->setOctree(nullptr);
    if (!data) return Done{};
    scene_.emplace(gl_, data);
    scaleEmission();
    environments_->setScene(*data);
    return shadows_.setScene(*data);
}

void Renderer::scaleEmission()
{
    float brightest = 0.0f;
    for (const auto* buffers : {&scene_, &guest_}) {
        if (!*buffers) continue;
        for (const Material& m : (*buffers)->data().scene->materials)
            brightest = std::max(brightest, maxChannel(m.emission));
    }
    emissionScale_ = brightest > kMostHalf ? brightest / kMostHalf : 1.0f;
}

void Renderer::setGuest(const std::shared_ptr<const DrawData>& data)
{
    shadows_.setGuest(nullptr, {});
    guest_.reset();
    guestPlace_.reset();
    if (data) guest_.emplace(gl_, data);
    scaleEmission();
}

void Renderer::setGuestPlace(const glm::mat4& place)
{
    if (!guest_ || guestPlace_ == place) return;
    guestPlace_ = place;
    guest_->setPlace(place);
    const Bounds& own = guest_->data().scene->bounds;
    Bounds box{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())};
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 part(i & 1, i >> 1 & 1, i >> 2);
        const glm::vec3 corner(place * glm::vec4(glm::mix(own.low, own.high, part), 1.0f));
        box = {glm::min(box.low, corner), glm::max(box.high, corner)};
    }
    shadows_.setGuest(&*guest_, box);
}

Result<Done> Renderer::setLamps(const DrawData& data)
{
    environments_->forget();
    return shadows_.setLamps(data);
}

Result<Done> Renderer::setOctree(const std::shared_ptr<const GpuOctree>& octree)
{
    environments_->forget();
    atlas_->lightChanged();
    (void)grid_->setGrid(nullptr);
    return vdl_->setOctree(octree);
}
Result<Done> Renderer::setGrid(const std::shared_ptr<const GpuGrid>& grid)
{
    environments_->forget();
    atlas_->lightChanged();
    (void)vdl_->setOctree(nullptr);
    return grid_->setGrid(grid);
}
Result<Done> Renderer::setColours(const std::shared_ptr<const GpuOctree>& octree)
{
    return colours_->setOctree(octree);
}
void Renderer::setMix(const Mix& mix)
{
    environments_->forget();
    shadows_.setMix(mix);
}

bool Renderer::drawShadows(double budgetMs)
{
    if (!scene_ || shadows_.isComplete()) return true;
    if (shadows_.lacksScene()) environments_->forget(); // lit with what shadows there were; guests are in no mirror
    return shadows_.draw(*scene_, shadowProgram_, budgetMs);
}

bool Renderer::drawEnvironments(double budgetMs)
{
    if (!scene_ || environments_->isComplete()) return true;
    if (!shadows_.isComplete()) return false;
    return environments_->draw(budgetMs, [this](const GBuffer& buffers, const glm::mat4& view,
                                                const glm::mat4& projection, glm::vec3 eye, int without) {
        FrameView frame;
        frame.view = view;
        frame.projection = projection;
        frame.eye = eye;
        drawSurfaces(buffers, frame, glm::vec2(0.0f), without);
        drawLight(buffers, frame, false);
    });
}

/// `without`: an instance that is left out, or -1.
void Renderer::drawSurfaces(const GBuffer& buffers, const FrameView& frame, glm::vec2 shift, int without)
{
    const glm::ivec2 size = buffers.size;
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, buffers.surfaces.id());
    gl_.glViewport(0, 0, size.x, size.y);
    gl_.glDisable(GL_BLEND);
    gl_.glDisable(GL_SCISSOR_TEST);
    gl_.glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl_.glEnable(GL_DEPTH_TEST);
    gl_.glDepthFunc(GL_LESS);
    gl_.glDepthMask(GL_TRUE);
    gl_.glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    gl_.glClearDepth(1.0);
    gl_.glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (!scene_) return;
    glm::mat4 shifted(1.0f);
    shifted[3] = glm::vec4(2.0f * shift / glm::vec2(size), 0.0f, 1.0f);
    surfaceProgram_.use();
    viewProjection_ = shifted * frame.projection * frame.view;
    surfaceProgram_.set("viewProjection", viewProjection_);
    scene_->draw(surfaceProgram_, true, emissionScale_, environments_->ofInstances(), without);
    if (!guest_ || without >= 0) return; // environment maps stay as they are when it moves
    guest_->draw(surfaceProgram_, true, emissionScale_,
                 std::vector<int>(guest_->data().scene->instances.size(), kGuestMark));
}

/// Takes from the light behind glass what the glass takes. Before the background there is nothing to take.
void Renderer::drawGlass(const GBuffer& buffers, const FrameView& frame, glm::vec2 shift)
{
    const bool isGuestClear = guest_ && guest_->hasGlass();
    if (!scene_ || !(scene_->hasGlass() || isGuestClear)) return;
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, buffers.lighting.id());
    gl_.glDisable(GL_DEPTH_TEST); // the shader compares with the surfaces itself: this framebuffer has no depth
    gl_.glEnable(GL_BLEND);
    gl_.glBlendEquation(GL_FUNC_ADD);
    gl_.glBlendFuncSeparate(GL_ZERO, GL_SRC_COLOR, GL_ZERO, GL_ONE);
    glm::mat4 shifted(1.0f);
    shifted[3] = glm::vec4(2.0f * shift / glm::vec2(buffers.size), 0.0f, 1.0f);
    glassProgram_.use();
    glassProgram_.set("viewProjection", shifted * frame.projection * frame.view);
    glassProgram_.set("eye", frame.eye);
    glassProgram_.set("nearer", 1e-5f * scene_->data().scene->bounds.diagonal());
    glassProgram_.setTexture("gPosition", 4, GL_TEXTURE_2D, buffers.position.id());
    scene_->drawGlass(glassProgram_);
    if (isGuestClear) guest_->drawGlass(glassProgram_);
    gl_.glDisable(GL_BLEND);
}

void Renderer::drawDirect(const ModeFrame& frame, int lights, float emissionScale, bool ofOne)
{
    directProgram_.use();
    frame.buffers.bind(directProgram_);
    directProgram_.setTexture("gEmission", 3, GL_TEXTURE_2D, frame.buffers.emission.id());
    if (ofOne) {
        shadows_.bindOne(directProgram_, 4);
    } else {
        shadows_.bind(directProgram_, 4);
    }
    directProgram_.set("lightCount", lights);
    directProgram_.set("emissionScale", emissionScale);
    directProgram_.set("eye", frame.eye);
    directProgram_.set("showIlluminance", frame.showIlluminance ? 1 : 0);
    directProgram_.set("mirrors", frame.mirrors ? 1 : 0);
    drawFullscreen(gl_);
}

/// `mirrors`: with environment maps, in modes that show a bake.
void Renderer::drawLight(const GBuffer& buffers, const FrameView& frame, bool mirrors)
{
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, buffers.lighting.id());
    gl_.glDisable(GL_DEPTH_TEST);
    gl_.glDisable(GL_BLEND);
    gl_.glClear(GL_COLOR_BUFFER_BIT);
    if (!scene_) return;
    gl_.glBindVertexArray(empty_.id());
    if (frame.mode == ViewMode::plain) {
        plainProgram_.use();
        buffers.bind(plainProgram_);
        plainProgram_.set("eye", frame.eye);
        drawFullscreen(gl_);
        return;
    }
    PreviewMode* indirect = indirectOf(frame.mode);
    const ModeFrame light{buffers, frame.eye, false, mirrors && indirect != nullptr, viewProjection_};
    const bool lamps = frame.mode == ViewMode::direct || !frame.indirectOnly;
    if (lamps) drawDirect(light, shadows_.lightCount(), emissionScale_); // else the buffer is black already
    if (frame.willRefine && mayRefine(frame)) {
        addLightTo(buffers, buffers.directSumming, coarseSamples_ == 0);
        gl_.glBindFramebuffer(GL_FRAMEBUFFER, buffers.lighting.id());
    }
    if (indirect == nullptr) return;
    gl_.glEnable(GL_BLEND);
    gl_.glBlendEquation(GL_FUNC_ADD);
    gl_.glBlendFuncSeparate(GL_ONE, GL_ONE, GL_ZERO, GL_ONE);
    indirect->draw(light);
    if (light.mirrors) environments_->add(buffers, frame.eye);
    gl_.glDisable(GL_BLEND);
}

bool Renderer::mayRefine(const FrameView& frame) const
{
    if (!scene_ || frame.mode == ViewMode::plain || shadows_.lightCount() == 0) return false;
    return frame.mode == ViewMode::direct || !frame.indirectOnly;
}

Renderer::Refined Renderer::refine(const FrameView& frame)
{
    const int rounds = shadows_.refineRounds();
    if (!buffers_ || coarseSamples_ == 0 || refinedRounds_ >= rounds || !mayRefine(frame)) return Refined::all;
    if (refinedLight_ == 0) drawSurfaces(*buffers_, frame, shiftOf(refinedRounds_), -1);
    const bool isLit = shadows_.drawOne(*scene_, shadowProgram_, refinedLight_, refinedRounds_);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, buffers_->refining.id());
    gl_.glViewport(0, 0, buffers_->size.x, buffers_->size.y);
    gl_.glDisable(GL_DEPTH_TEST);
    gl_.glBindVertexArray(empty_.id());
    if (refinedLight_ == 0 && refinedRounds_ == 0) {
        gl_.glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
        gl_.glClear(GL_COLOR_BUFFER_BIT);
    }
    // the first lamp brings glow and counts the round
    const bool isFirst = refinedLight_ == 0;
    if (isLit || isFirst) {
        gl_.glEnable(GL_BLEND);
        gl_.glBlendEquation(GL_FUNC_ADD);
        gl_.glBlendFuncSeparate(GL_ONE, GL_ONE, isFirst ? GL_ONE : GL_ZERO, GL_ONE);
        const ModeFrame light{*buffers_, frame.eye, false, indirectOf(frame.mode) != nullptr, viewProjection_};
        drawDirect(light, isLit ? 1 : 0, isFirst ? emissionScale_ : 0.0f, true);
        gl_.glDisable(GL_BLEND);
    }
    if (++refinedLight_ < shadows_.lightCount()) return Refined::part;
    refinedLight_ = 0;
    ++refinedRounds_;
    makeRefinement(frame);
    return refinedRounds_ == rounds ? Refined::all : Refined::round;
}

/// What is to be added to the picture, into the buffer of a single one's light.
void Renderer::makeRefinement(const FrameView& frame)
{
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, buffers_->lighting.id());
    gl_.glViewport(0, 0, buffers_->size.x, buffers_->size.y);
    gl_.glDisable(GL_DEPTH_TEST);
    gl_.glBindVertexArray(empty_.id());
    refinedProgram_.use();
    refinedProgram_.setTexture("fine", 0, GL_TEXTURE_2D, buffers_->refinedSum.id());
    refinedProgram_.setTexture("coarse", 1, GL_TEXTURE_2D, buffers_->directSum.id());
    drawFullscreen(gl_);
    drawGlass(*buffers_, frame, glm::vec2(0.0f));
}

float Renderer::refinedShare() const
{
    if (refinedRounds_ == 0) return 0.0f;
    if (refinedRounds_ == shadows_.refineRounds()) return 1.0f;
    const auto rounds = static_cast<float>(refinedRounds_); // every picture counts alike
    return rounds / (rounds + static_cast<float>(coarseSamples_));
}

PreviewMode& Renderer::bake()
{
    if (grid_->hasGrid()) return *grid_;
    return *vdl_;
}

PreviewMode* Renderer::indirectOf(ViewMode mode)
{
    switch (mode) {
    case ViewMode::octree:
    case ViewMode::grid:
    case ViewMode::lightcuts:
    case ViewMode::photonMap:
        return &bake();
    case ViewMode::atlas:
        if (!atlas_->isReady()) return &bake();
        return atlas_.get();
    case ViewMode::colours:
        return colours_.get();
    case ViewMode::direct:
    case ViewMode::plain:
    case ViewMode::reference:
        break;
    }
    return nullptr;
}

void Renderer::addLightTo(const GBuffer& buffers, const GlFramebuffer& sum, bool first)
{
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, sum.id());
    if (first) {
        gl_.glDisable(GL_BLEND);
    } else {
        gl_.glEnable(GL_BLEND);
        gl_.glBlendEquation(GL_FUNC_ADD);
        gl_.glBlendFunc(GL_ONE, GL_ONE);
    }
    gl_.glBindVertexArray(empty_.id());
    copyProgram_.use();
    copyProgram_.setTexture("picture", 0, GL_TEXTURE_2D, buffers.light.id());
    copyProgram_.setTexture("gPosition", 1, GL_TEXTURE_2D, buffers.position.id());
    drawFullscreen(gl_);
    gl_.glDisable(GL_BLEND);
}

void Renderer::present(const FrameView& frame, int samples, GLuint target, glm::ivec2 window)
{
    if (!buffers_) return;
    const bool plain = frame.mode == ViewMode::plain;
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, target);
    gl_.glViewport(0, 0, window.x, window.y);
    gl_.glDisable(GL_DEPTH_TEST);
    gl_.glDisable(GL_BLEND);
    gl_.glBindVertexArray(empty_.id());
    postProgram_.use();
    postProgram_.setTexture("picture", 0, GL_TEXTURE_2D, buffers_->sum.id());
    postProgram_.set("samples", static_cast<float>(samples));
    postProgram_.set("scale", plain ? 1.0f : shader::exposureScale(frame.exposureEv));
    postProgram_.set("tone", plain ? shader::kToneNone : frame.tone);
    postProgram_.set("background", frame.background);
    postProgram_.set("refined", refinedShare());
    postProgram_.setTexture("refinement", 1, GL_TEXTURE_2D, buffers_->light.id());
    drawFullscreen(gl_);
    overlay_->draw(frame, *buffers_, samples, window);
    discs_->draw(frame, *buffers_, window);
    vertices_->draw(frame, *buffers_, window);
    marks_->draw(frame, *buffers_, window);
    gl_.glBindVertexArray(0);
    gl_.glUseProgram(0);
    gl_.glActiveTexture(GL_TEXTURE0);
}

} // namespace lightloom
