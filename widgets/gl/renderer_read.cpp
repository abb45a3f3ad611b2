// SPDX-License-Identifier: GPL-3.0-or-later
// What the renderer reads back: the surface under the cursor, buffers for tests, the metering of the exposure.
#include "core/base/units.h"
#include "widgets/gl/renderer.h"
#include <cmath>

namespace lightloom {

namespace {

std::vector<glm::vec4> readColour(Gl& gl, GLuint framebuffer, GLenum attachment, glm::ivec2 size)
{
    std::vector<glm::vec4> pixels(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y));
    gl.glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    gl.glReadBuffer(attachment);
    gl.glPixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.glReadPixels(0, 0, size.x, size.y, GL_RGBA, GL_FLOAT, pixels.data());
    return pixels;
}

} // namespace

std::optional<Renderer::SurfaceSample> Renderer::surfaceAt(glm::vec2 at) const
{
    if (!buffers_ || !(at.x >= 0.0f && at.x < 1.0f && at.y >= 0.0f && at.y < 1.0f)) return std::nullopt;
    const glm::ivec2 pixel(at * glm::vec2(buffers_->size));
    glm::vec4 position(0.0f), normal(0.0f), emission(0.0f);
    gl_.glBindFramebuffer(GL_READ_FRAMEBUFFER, buffers_->surfaces.id());
    gl_.glReadBuffer(GL_COLOR_ATTACHMENT0);
    gl_.glReadPixels(pixel.x, pixel.y, 1, 1, GL_RGBA, GL_FLOAT, &position);
    gl_.glReadBuffer(GL_COLOR_ATTACHMENT1);
    gl_.glReadPixels(pixel.x, pixel.y, 1, 1, GL_RGBA, GL_FLOAT, &normal);
    gl_.glReadBuffer(GL_COLOR_ATTACHMENT3);
    gl_.glReadPixels(pixel.x, pixel.y, 1, 1, GL_RGBA, GL_FLOAT, &emission);
    if (position.w < 0.5f) return std::nullopt;
    const glm::vec3 n(normal.x, normal.y, normal.z);
    if (!(glm::length(n) > 0.5f)) return std::nullopt;
    return SurfaceSample{{position.x, position.y, position.z}, glm::normalize(n), emission.w < -0.5f};
}

Renderer::Pixels Renderer::readBack() const
{
    Pixels out;
    if (!buffers_) return out;
    out.size = buffers_->size;
    out.position = readColour(gl_, buffers_->surfaces.id(), GL_COLOR_ATTACHMENT0, out.size);
    out.normal = readColour(gl_, buffers_->surfaces.id(), GL_COLOR_ATTACHMENT1, out.size);
    out.light = readColour(gl_, buffers_->lighting.id(), GL_COLOR_ATTACHMENT0, out.size);
    return out;
}

std::vector<glm::vec4> Renderer::picture(int samples) const
{
    if (!buffers_) return {};
    const auto n = static_cast<float>(samples);
    std::vector<glm::vec4> out = readColour(gl_, buffers_->summing.id(), GL_COLOR_ATTACHMENT0, buffers_->size);
    const auto added = readColour(gl_, buffers_->lighting.id(), GL_COLOR_ATTACHMENT0, buffers_->size);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const float met = glm::max(out[i].w, 1e-6f), share = refinedShare();
        const glm::vec4 more = share > 0.0f ? share * added[i] : glm::vec4(0.0f);
        out[i] = glm::vec4(out[i].x / met + more.x, out[i].y / met + more.y, out[i].z / met + more.z, out[i].w / n);
    }
    return out;
}

std::vector<glm::vec4> Renderer::illuminance(const FrameView& frame, bool indirect)
{
    if (!buffers_) return {};
    gl_.glBindFramebuffer(GL_FRAMEBUFFER, buffers_->lighting.id());
    gl_.glViewport(0, 0, buffers_->size.x, buffers_->size.y);
    gl_.glDisable(GL_DEPTH_TEST);
    gl_.glDisable(GL_BLEND);
    gl_.glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    gl_.glClear(GL_COLOR_BUFFER_BIT);
    gl_.glBindVertexArray(empty_.id());
    PreviewMode* mode = indirectOf(frame.mode);
    if (indirect && mode != nullptr) {
        mode->draw({*buffers_, frame.eye, true, false, viewProjection_});
    } else if (!indirect) {
        drawDirect({*buffers_, frame.eye, true, false}, shadows_.lightCount(), 0.0f);
    }
    return readColour(gl_, buffers_->lighting.id(), GL_COLOR_ATTACHMENT0, buffers_->size);
}

std::optional<float> Renderer::meanLogLuminance() const
{
    if (!buffers_) return std::nullopt;
    double sum = 0.0;
    int lit = 0;
    for (const glm::vec4& light : readColour(gl_, buffers_->lighting.id(), GL_COLOR_ATTACHMENT0, buffers_->size)) {
        const float l = luminance({light.x, light.y, light.z});
        if (!(l > 0.0f)) continue; // nothing there, or nothing lit
        sum += std::log2(l);
        ++lit;
    }
    if (lit == 0) return std::nullopt;
    return static_cast<float>(sum / lit);
}

} // namespace lightloom
