// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/mode_atlas.h"
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <fmt/format.h>

namespace lightloom {

namespace {

constexpr int kBands = 16; ///< steps that the bake takes; then one per ring of dilation
constexpr int kFinished = -1;

} // namespace

Result<std::unique_ptr<ModeAtlas>> ModeAtlas::make(Gl& gl, const ShaderLibrary& shaders)
{
    auto mode = std::unique_ptr<ModeAtlas>(new ModeAtlas(gl));
    Result<GlProgram> fill = shaders.link(gl, "fullscreen.vert", "pass_atlas.frag");
    if (!fill) return fill.error();
    Result<GlProgram> draw = shaders.link(gl, "atlas.vert", "mode_atlas.frag");
    if (!draw) return draw.error();
    mode->fillProgram_ = std::move(*fill);
    mode->drawProgram_ = std::move(*draw);
    mode->empty_ = GlVertexArray(gl);
    return mode;
}

Result<Done> ModeAtlas::setAtlas(const std::shared_ptr<const AtlasDraw>& atlas)
{
    atlas_.reset();
    isShown_ = false;
    step_ = 0;
    texels_ = GBuffer();
    owners_.reset();
    pictures_ = {};
    if (!atlas) return Done{};
    GLint most = 0;
    gl_.glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    if (atlas->size > most) {
        return Error{
            Error::Kind::unsupported,
            fmt::format("an atlas of {} texels is wider than this graphics driver takes ({})", atlas->size, most)};
    }
    const glm::ivec2 size(atlas->size);
    texels_.size = size;
    texels_.position = makeTexture2D(gl_, GL_RGBA32F, size, GL_RGBA, GL_FLOAT, atlas->positions.data());
    texels_.normal = makeTexture2D(gl_, GL_RGBA32F, size, GL_RGBA, GL_FLOAT, atlas->normals.data());
    const glm::vec4 white(1.0f, 1.0f, 1.0f, 0.0f);
    texels_.base = makeTexture2D(gl_, GL_RGBA32F, glm::ivec2(1), GL_RGBA, GL_FLOAT, &white); // not read for lux
    owners_ = makeTexture2D(gl_, GL_R32I, size, GL_RED_INTEGER, GL_INT, atlas->owners.data());
    for (Picture& picture : pictures_) {
        picture.light = makeTexture2D(gl_, GL_RGBA32F, size, GL_RGBA, GL_FLOAT, nullptr);
        gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        gl_.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        const GLuint id = picture.light.id();
        Result<GlFramebuffer> target = makeFramebuffer(gl_, {&id, 1}, 0);
        if (!target) return target.error();
        picture.target = std::move(*target);
    }
    array_ = GlVertexArray(gl_);
    vertices_ = GlBuffer(gl_);
    gl_.glBindVertexArray(array_.id());
    gl_.glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
    gl_.glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(atlas->vertices.size() * sizeof(AtlasVertex)),
                     atlas->vertices.data(), GL_STATIC_DRAW);
    gl_.glEnableVertexAttribArray(0);
    gl_.glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(AtlasVertex), nullptr);
    gl_.glEnableVertexAttribArray(1);
    gl_.glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(AtlasVertex),
                              reinterpret_cast<const void*>(offsetof(AtlasVertex, uv)));
    gl_.glBindVertexArray(0);
    atlas_ = atlas;
    return Done{};
}

/// Part of the rows, from the bake.
void ModeAtlas::renderBand(PreviewMode& bake, int band)
{
    const int low = atlas_->size * band / kBands, high = atlas_->size * (band + 1) / kBands;
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, pictures_[from_].target.id());
    gl_.glEnable(GL_SCISSOR_TEST);
    gl_.glScissor(0, low, atlas_->size, high - low);
    gl_.glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    gl_.glClear(GL_COLOR_BUFFER_BIT);
    bake.draw({texels_, glm::vec3(0.0f), true, false});
    gl_.glDisable(GL_SCISSOR_TEST);
}

bool ModeAtlas::fillRing()
{
    gl_.glBindFramebuffer(GL_READ_FRAMEBUFFER, pictures_[from_].target.id());
    gl_.glBindFramebuffer(GL_DRAW_FRAMEBUFFER, pictures_[to_].target.id());
    gl_.glBlitFramebuffer(0, 0, atlas_->size, atlas_->size, 0, 0, atlas_->size, atlas_->size, GL_COLOR_BUFFER_BIT,
                          GL_NEAREST);
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, pictures_[to_].target.id());
    fillProgram_.use();
    fillProgram_.setTexture("light", 0, GL_TEXTURE_2D, pictures_[from_].light.id());
    fillProgram_.setTexture("owners", 1, GL_TEXTURE_2D, owners_.id());
    fillProgram_.set("size", atlas_->size);
    GLuint query = 0, any = 0;
    gl_.glGenQueries(1, &query);
    gl_.glBeginQuery(GL_ANY_SAMPLES_PASSED, query);
    drawFullscreen(gl_);
    gl_.glEndQuery(GL_ANY_SAMPLES_PASSED);
    gl_.glGetQueryObjectuiv(query, GL_QUERY_RESULT, &any);
    gl_.glDeleteQueries(1, &query);
    std::swap(from_, to_);
    return any != 0;
}

bool ModeAtlas::render(PreviewMode& bake, double budgetMs)
{
    using Clock = std::chrono::steady_clock;
    if (!atlas_ || step_ == kFinished) return true;
    const auto began = Clock::now();
    gl_.glViewport(0, 0, atlas_->size, atlas_->size);
    gl_.glDisable(GL_DEPTH_TEST);
    gl_.glDisable(GL_BLEND);
    gl_.glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl_.glBindVertexArray(empty_.id());
    while (step_ != kFinished) {
        if (step_ < kBands) {
            renderBand(bake, step_++);
            gl_.glFinish(); // or the budget would count how fast commands are taken
        } else if (!fillRing()) {
            step_ = kFinished;
            std::swap(shown_, from_);
            isShown_ = true;
        }
        if (std::chrono::duration<double, std::milli>(Clock::now() - began).count() >= budgetMs) break;
    }
    return step_ == kFinished;
}

void ModeAtlas::draw(const ModeFrame& frame)
{
    if (!isShown_) return;
    gl_.glEnable(GL_CULL_FACE);
    gl_.glCullFace(GL_BACK);
    gl_.glFrontFace(GL_CCW);
    gl_.glBindVertexArray(array_.id());
    drawProgram_.use();
    frame.buffers.bind(drawProgram_);
    drawProgram_.setTexture("gEmission", 3, GL_TEXTURE_2D, frame.buffers.emission.id());
    drawProgram_.setTexture("lightmap", 4, GL_TEXTURE_2D, pictures_[shown_].light.id());
    drawProgram_.set("mirrors", frame.mirrors ? 1 : 0);
    drawProgram_.set("viewProjection", frame.viewProjection);
    drawProgram_.set("eye", frame.eye);
    drawProgram_.set("showIlluminance", frame.showIlluminance ? 1 : 0);
    gl_.glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(atlas_->vertices.size()));
    gl_.glDisable(GL_CULL_FACE);
    gl_.glBindVertexArray(empty_.id());
}

std::vector<glm::vec4> ModeAtlas::readBack() const
{
    if (!isShown_) return {};
    std::vector<glm::vec4> out(static_cast<std::size_t>(atlas_->size) * static_cast<std::size_t>(atlas_->size));
    gl_.glBindTexture(GL_TEXTURE_2D, pictures_[shown_].light.id());
    gl_.glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_FLOAT, out.data());
    return out;
}

} // namespace lightloom
