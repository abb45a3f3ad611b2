// SPDX-License-Identifier: GPL-3.0-or-later
// A picture of the renderer, at once or in strips.
#include "widgets/gl/renderer.h"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace lightloom {

namespace {

constexpr int kFirstRows = 8; ///< a strip whose cost is not known
constexpr int kLeastRows = 4;
constexpr int kMostGrowth = 2; ///< of a strip over the one before: rows of walls may follow rows of nothing
constexpr double kStripsPerBudget = 3.0;

double millisecondsSince(std::chrono::steady_clock::time_point begin)
{
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

} // namespace

/// The middle first, then the R2 sequence.
glm::vec2 Renderer::shiftOf(int sample)
{
    if (sample == 0) return glm::vec2(0.0f);
    return glm::vec2(std::fmod(0.5f + 0.7548777f * static_cast<float>(sample), 1.0f),
                     std::fmod(0.5f + 0.5698403f * static_cast<float>(sample), 1.0f)) -
           0.5f;
}

Result<Done> Renderer::draw(const FrameView& frame, int sample, glm::ivec2 size, GLuint target, glm::ivec2 window)
{
    const Result<Done> begun = begin(frame, sample, size);
    if (!begun) return begun;
    const int samples = unlit_->sample + 1;
    shade(std::numeric_limits<double>::infinity());
    present(frame, samples, target, window);
    return Done{};
}

Result<Done> Renderer::begin(const FrameView& frame, int sample, glm::ivec2 size)
{
    unlit_.reset();
    size = glm::max(size, glm::ivec2(1));
    if (!buffers_ || buffers_->size != size) {
        buffers_.reset();
        Result<GBuffer> made = GBuffer::make(gl_, size);
        if (!made) return made.error();
        buffers_ = std::move(*made);
        sample = 0;
    }
    refinedRounds_ = refinedLight_ = 0;
    if (sample == 0) coarseSamples_ = 0;
    unlit_ = Unlit{frame, sample, 0};
    drawSurfaces(*buffers_, frame, shiftOf(sample), -1);
    return Done{};
}

bool Renderer::shade(double budgetMs)
{
    if (!unlit_) return true;
    const int height = buffers_->size.y;
    if (!(budgetMs < std::numeric_limits<double>::infinity())) {
        shadeRows(height);
    } else {
        finish(); // the surfaces: their time is none of a strip's
        int rows = kFirstRows;
        const auto began = std::chrono::steady_clock::now();
        for (double spent = 0.0; unlit_->row < height;) {
            if (rowMs_ > 0.0) {
                const double fit = std::min(budgetMs / kStripsPerBudget, budgetMs - spent) / rowMs_;
                rows = static_cast<int>(std::clamp(fit, double(kLeastRows), double(kMostGrowth * rows)));
            }
            rows = std::min(rows, height - unlit_->row);
            if (spent > 0.0 && spent + rowMs_ * rows > budgetMs) return false;
            shadeRows(rows);
            finish();
            const double now = millisecondsSince(began);
            rowMs_ = (now - spent) / rows;
            spent = now;
        }
    }
    addLightTo(*buffers_, buffers_->summing, unlit_->sample == 0);
    coarseSamples_ += unlit_->frame.willRefine && mayRefine(unlit_->frame) ? 1 : 0;
    unlit_.reset();
    return true;
}

void Renderer::shadeRows(int rows)
{
    gl_.glEnable(GL_SCISSOR_TEST);
    gl_.glScissor(0, unlit_->row, buffers_->size.x, rows);
    gl_.glViewport(0, 0, buffers_->size.x, buffers_->size.y);
    gl_.glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    drawLight(*buffers_, unlit_->frame, true);
    drawGlass(*buffers_, unlit_->frame, shiftOf(unlit_->sample));
    gl_.glDisable(GL_SCISSOR_TEST);
    unlit_->row += rows;
}

} // namespace lightloom
