// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/gbuffer.h"

namespace lightloom {

Result<GBuffer> GBuffer::make(Gl& gl, glm::ivec2 size)
{
    GBuffer b;
    b.size = size;
    const auto colour = [&](GLenum format) { return makeTexture2D(gl, format, size, GL_RGBA, GL_FLOAT, nullptr); };
    b.position = colour(GL_RGBA32F); // half floats end at 2048 for whole numbers: positions need all bits
    b.normal = colour(GL_RGBA16F);
    b.base = colour(GL_RGBA16F);
    b.emission = colour(GL_RGBA16F);
    b.light = colour(GL_RGBA32F);
    b.directSum = colour(GL_RGBA32F);
    b.refinedSum = colour(GL_RGBA32F);
    b.sum = colour(GL_RGBA32F);
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    b.depth = makeTexture2D(gl, GL_DEPTH_COMPONENT32F, size, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
    const GLuint surfaces[] = {b.position.id(), b.normal.id(), b.base.id(), b.emission.id()};
    const GLuint light = b.light.id(), sum = b.sum.id(), direct = b.directSum.id(), refined = b.refinedSum.id();
    const auto attach = [&](GlFramebuffer& to, std::span<const GLuint> colours, GLuint depth) -> Result<Done> {
        Result<GlFramebuffer> made = makeFramebuffer(gl, colours, depth);
        if (!made) return made.error();
        to = std::move(*made);
        return Done{};
    };
    if (const Result<Done> made = attach(b.surfaces, surfaces, b.depth.id()); !made) return made.error();
    if (const Result<Done> made = attach(b.lighting, {&light, 1}, 0); !made) return made.error();
    if (const Result<Done> made = attach(b.summing, {&sum, 1}, 0); !made) return made.error();
    if (const Result<Done> made = attach(b.directSumming, {&direct, 1}, 0); !made) return made.error();
    if (const Result<Done> made = attach(b.refining, {&refined, 1}, 0); !made) return made.error();
    return b;
}

void GBuffer::bind(const GlProgram& mode) const
{
    mode.setTexture("gPosition", 0, GL_TEXTURE_2D, position.id());
    mode.setTexture("gNormal", 1, GL_TEXTURE_2D, normal.id());
    mode.setTexture("gBase", 2, GL_TEXTURE_2D, base.id());
}

} // namespace lightloom
