// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/gl_objects.h"
#include <glm/gtc/type_ptr.hpp>
#include <vector>

namespace lightloom {

GLuint GlTextureTraits::make(Gl& gl)
{
    GLuint id = 0;
    gl.glGenTextures(1, &id);
    return id;
}
void GlTextureTraits::remove(Gl& gl, GLuint id) { gl.glDeleteTextures(1, &id); }

GLuint GlBufferTraits::make(Gl& gl)
{
    GLuint id = 0;
    gl.glGenBuffers(1, &id);
    return id;
}
void GlBufferTraits::remove(Gl& gl, GLuint id) { gl.glDeleteBuffers(1, &id); }

GLuint GlVertexArrayTraits::make(Gl& gl)
{
    GLuint id = 0;
    gl.glGenVertexArrays(1, &id);
    return id;
}
void GlVertexArrayTraits::remove(Gl& gl, GLuint id) { gl.glDeleteVertexArrays(1, &id); }

GLuint GlFramebufferTraits::make(Gl& gl)
{
    GLuint id = 0;
    gl.glGenFramebuffers(1, &id);
    return id;
}
void GlFramebufferTraits::remove(Gl& gl, GLuint id) { gl.glDeleteFramebuffers(1, &id); }

GlProgram::~GlProgram()
{
    if (id_ != 0) gl_->glDeleteProgram(id_);
}

void GlProgram::use() const { gl_->glUseProgram(id_); }
GLint GlProgram::at(const char* name) const { return gl_->glGetUniformLocation(id_, name); }
void GlProgram::set(const char* name, int value) const { gl_->glUniform1i(at(name), value); }
void GlProgram::set(const char* name, std::span<const int> values) const
{
    gl_->glUniform1iv(at(name), static_cast<GLsizei>(values.size()), values.data());
}
void GlProgram::set(const char* name, float value) const { gl_->glUniform1f(at(name), value); }
void GlProgram::set(const char* name, glm::vec2 value) const { gl_->glUniform2f(at(name), value.x, value.y); }
void GlProgram::set(const char* name, glm::ivec3 value) const { gl_->glUniform3i(at(name), value.x, value.y, value.z); }
void GlProgram::set(const char* name, glm::vec3 value) const { gl_->glUniform3f(at(name), value.x, value.y, value.z); }
void GlProgram::set(const char* name, glm::vec4 value) const { gl_->glUniform4fv(at(name), 1, glm::value_ptr(value)); }
void GlProgram::set(const char* name, const glm::mat3& value) const
{
    gl_->glUniformMatrix3fv(at(name), 1, GL_FALSE, glm::value_ptr(value));
}
void GlProgram::set(const char* name, const glm::mat4& value) const
{
    gl_->glUniformMatrix4fv(at(name), 1, GL_FALSE, glm::value_ptr(value));
}

void GlProgram::setTexture(const char* name, int unit, GLenum target, GLuint texture) const
{
    gl_->glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    gl_->glBindTexture(target, texture);
    set(name, unit);
}

void GlProgram::bindBlock(const char* name, GLuint binding) const
{
    const GLuint index = gl_->glGetUniformBlockIndex(id_, name);
    if (index != GL_INVALID_INDEX) gl_->glUniformBlockBinding(id_, index, binding);
}

GlTexture makeTexture2D(Gl& gl, GLenum internalFormat, glm::ivec2 size, GLenum format, GLenum type, const void* pixels)
{
    GlTexture texture(gl);
    gl.glActiveTexture(GL_TEXTURE0);
    gl.glBindTexture(GL_TEXTURE_2D, texture.id());
    gl.glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internalFormat), size.x, size.y, 0, format, type, pixels);
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

Result<GlFramebuffer> makeFramebuffer(Gl& gl, std::span<const GLuint> colours, GLuint depth)
{
    GlFramebuffer framebuffer(gl);
    gl.glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    std::vector<GLenum> draws;
    for (const GLuint colour : colours) {
        const GLenum point = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(draws.size());
        gl.glFramebufferTexture2D(GL_FRAMEBUFFER, point, GL_TEXTURE_2D, colour, 0);
        draws.push_back(point);
    }
    if (depth != 0) gl.glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
    if (draws.empty()) {
        gl.glDrawBuffer(GL_NONE);
        gl.glReadBuffer(GL_NONE);
    } else {
        gl.glDrawBuffers(static_cast<GLsizei>(draws.size()), draws.data());
    }
    const GLenum status = gl.glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE) {
        return Error{Error::Kind::unsupported, "OpenGL refuses the picture buffers (status " + std::to_string(status) +
                                                   "); a newer graphics driver may help"};
    }
    return framebuffer;
}

void drawFullscreen(Gl& gl) { gl.glDrawArrays(GL_TRIANGLES, 0, 3); }

} // namespace lightloom
