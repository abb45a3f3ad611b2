// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/base/result.h"
#include <QOpenGLFunctions_3_3_Core>
#include <glm/glm.hpp>
#include <span>
#include <utility>

/// Owners of OpenGL objects: move-only, made and destroyed with the context current. GL 3.3 core.
namespace lightloom {

using Gl = QOpenGLFunctions_3_3_Core;

/// One OpenGL name. `Traits` says how it is made and deleted.
template<class Traits>
class GlName {
public:
    GlName() = default;
    explicit GlName(Gl& gl) : gl_(&gl), id_(Traits::make(gl)) {}
    ~GlName() { reset(); }
    GlName(GlName&& other) noexcept : gl_(other.gl_), id_(std::exchange(other.id_, 0)) {}
    GlName& operator=(GlName&& other) noexcept
    {
        if (this == &other) return *this;
        reset();
        gl_ = other.gl_;
        id_ = std::exchange(other.id_, 0);
        return *this;
    }
    [[nodiscard]] GLuint id() const { return id_; }
    explicit operator bool() const { return id_ != 0; }
    void reset()
    {
        if (id_ != 0) Traits::remove(*gl_, std::exchange(id_, 0));
    }

private:
    Gl* gl_ = nullptr;
    GLuint id_ = 0;
};

struct GlTextureTraits {
    static GLuint make(Gl& gl);
    static void remove(Gl& gl, GLuint id);
};
struct GlBufferTraits {
    static GLuint make(Gl& gl);
    static void remove(Gl& gl, GLuint id);
};
struct GlVertexArrayTraits {
    static GLuint make(Gl& gl);
    static void remove(Gl& gl, GLuint id);
};
struct GlFramebufferTraits {
    static GLuint make(Gl& gl);
    static void remove(Gl& gl, GLuint id);
};
using GlTexture = GlName<GlTextureTraits>;
using GlBuffer = GlName<GlBufferTraits>;
using GlVertexArray = GlName<GlVertexArrayTraits>;
using GlFramebuffer = GlName<GlFramebufferTraits>;

/// A linked program with its uniforms by name. Uniforms it does not use are ignored, as OpenGL does.
class GlProgram {
public:
    GlProgram() = default;
    GlProgram(Gl& gl, GLuint linked) : gl_(&gl), id_(linked) {}
    ~GlProgram();
    GlProgram(GlProgram&& other) noexcept : gl_(other.gl_), id_(std::exchange(other.id_, 0)) {}
    GlProgram& operator=(GlProgram&& other) noexcept
    {
        std::swap(gl_, other.gl_);
        std::swap(id_, other.id_);
        return *this;
    }
    [[nodiscard]] GLuint id() const { return id_; }
    void use() const;
    // the program must be in use
    void set(const char* name, int value) const;
    void set(const char* name, float value) const;
    void set(const char* name, std::span<const int> values) const;
    void set(const char* name, glm::ivec3 value) const;
    void set(const char* name, glm::vec2 value) const;
    void set(const char* name, glm::vec3 value) const;
    void set(const char* name, glm::vec4 value) const;
    void set(const char* name, const glm::mat3& value) const;
    void set(const char* name, const glm::mat4& value) const;
    /// Binds `texture` to `unit` and names the unit to the sampler.
    void setTexture(const char* name, int unit, GLenum target, GLuint texture) const;
    void bindBlock(const char* name, GLuint binding) const;

private:
    [[nodiscard]] GLint at(const char* name) const;
    Gl* gl_ = nullptr;
    GLuint id_ = 0;
};

/// A 2D texture for drawing into or reading by texelFetch: nearest, clamped, no mip maps. `pixels` may be null.
[[nodiscard]] GlTexture makeTexture2D(Gl& gl, GLenum internalFormat, glm::ivec2 size, GLenum format, GLenum type,
                                      const void* pixels);

/// Colour textures (and a depth texture, or 0) as a framebuffer. Error: the driver refuses the combination.
[[nodiscard]] Result<GlFramebuffer> makeFramebuffer(Gl& gl, std::span<const GLuint> colours, GLuint depth);

/// Draws one triangle that covers the viewport; needs a bound (may be empty) vertex array and fullscreen.vert.
void drawFullscreen(Gl& gl);

} // namespace lightloom
