// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/shader_library.h"
#include <QFile>
#include <QRegularExpression>
#include <QStringList>

namespace lightloom {

namespace {

std::optional<QByteArray> fromResources(const QString& name)
{
    QFile file(":/shaders/" + name);
    if (!file.open(QIODevice::ReadOnly)) return std::nullopt;
    return file.readAll();
}

/// One expansion: which files have been put in, and which are open right now.
class Expander {
public:
    explicit Expander(const ShaderLibrary::Loader& loader) : loader_(loader) {}

    Result<Done> add(const QString& name, const QString& from)
    {
        if (open_.contains(name)) {
            return Error{Error::Kind::badInput,
                         ("shader " + name + " includes itself through " + open_.join(", ")).toStdString()};
        }
        if (seen_.contains(name)) return Done{};
        const std::optional<QByteArray> found = loader_(name);
        if (!found) {
            const QString asker = from.isEmpty() ? QString() : ", included by " + from;
            return Error{Error::Kind::notFound, ("shader file " + name + asker + " does not exist").toStdString()};
        }
        const auto number = static_cast<int>(seen_.size());
        seen_ += name;
        open_ += name;
        Result<Done> outcome = addLines(*found, name, number);
        open_.removeLast();
        return outcome;
    }

    QByteArray text;

private:
    Result<Done> addLines(const QByteArray& source, const QString& name, int number)
    {
        static const QRegularExpression include("^\\s*#\\s*include\\s+\"([^\"]+)\"");
        if (number > 0) text += "#line 1 " + QByteArray::number(number) + "\n";
        int line = 0;
        for (const QByteArray& each : source.split('\n')) {
            ++line;
            const auto match = include.match(QString::fromUtf8(each));
            if (!match.hasMatch()) {
                text += each + "\n";
                continue;
            }
            const Result<Done> added = add(match.captured(1), name);
            if (!added) return added.error();
            text += "#line " + QByteArray::number(line + 1) + " " + QByteArray::number(number) + "\n";
        }
        return Done{};
    }

    const ShaderLibrary::Loader& loader_;
    QStringList seen_, open_;
};

QByteArray withDefines(const QByteArray& source, const QByteArray& defines)
{
    const auto version = source.indexOf("#version");
    const auto end = version < 0 ? -1 : source.indexOf('\n', version);
    const auto line = source.left(end + 1).count('\n') + 1;
    return source.left(end + 1) + "#define SHARED\n" + defines + "#line " + QByteArray::number(line) + " 0\n" +
           source.mid(end + 1);
}

/// Deletes a shader at the end of the block; a linked program keeps what it needs.
struct ShaderGuard {
    Gl& gl;
    GLuint id;
    ~ShaderGuard() { gl.glDeleteShader(id); }
};

QByteArray shaderLog(Gl& gl, GLuint shader)
{
    GLint length = 0;
    gl.glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    QByteArray text(std::max(length, 1), '\0');
    gl.glGetShaderInfoLog(shader, length, nullptr, text.data());
    return text;
}

QByteArray programLog(Gl& gl, GLuint program)
{
    GLint length = 0;
    gl.glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    QByteArray text(std::max(length, 1), '\0');
    gl.glGetProgramInfoLog(program, length, nullptr, text.data());
    return text;
}

Result<Done> compile(Gl& gl, GLuint shader, const QByteArray& source, const QString& name)
{
    const char* text = source.constData();
    gl.glShaderSource(shader, 1, &text, nullptr);
    gl.glCompileShader(shader);
    GLint fine = GL_FALSE;
    gl.glGetShaderiv(shader, GL_COMPILE_STATUS, &fine);
    if (fine == GL_TRUE) return Done{};
    return Error{Error::Kind::unsupported,
                 "shader " + name.toStdString() + " does not compile: " + shaderLog(gl, shader).constData()};
}

} // namespace

ShaderLibrary::ShaderLibrary(Loader loader) : loader_(loader ? std::move(loader) : Loader(fromResources)) {}

Result<QByteArray> ShaderLibrary::expand(const QString& name) const
{
    Expander expander(loader_);
    const Result<Done> added = expander.add(name, {});
    if (!added) return added.error();
    return expander.text;
}

Result<GlProgram> ShaderLibrary::link(Gl& gl, const QString& vertex, const QString& fragment,
                                      const QByteArray& defines) const
{
    const ShaderGuard shaders[] = {{gl, gl.glCreateShader(GL_VERTEX_SHADER)},
                                   {gl, gl.glCreateShader(GL_FRAGMENT_SHADER)}};
    GlProgram program(gl, gl.glCreateProgram());
    for (int i = 0; i < 2; ++i) {
        const QString& name = i == 0 ? vertex : fragment;
        const Result<QByteArray> source = expand(name);
        if (!source) return source.error();
        const Result<Done> compiled = compile(gl, shaders[i].id, withDefines(*source, defines), name);
        if (!compiled) return compiled.error();
        gl.glAttachShader(program.id(), shaders[i].id);
    }
    gl.glLinkProgram(program.id());
    GLint fine = GL_FALSE;
    gl.glGetProgramiv(program.id(), GL_LINK_STATUS, &fine);
    if (fine != GL_TRUE) {
        return Error{Error::Kind::unsupported, "shaders " + vertex.toStdString() + " and " + fragment.toStdString() +
                                                   " do not link: " + programLog(gl, program.id()).constData()};
    }
    for (const GLuint shader : {shaders[0].id, shaders[1].id}) gl.glDetachShader(program.id(), shader);
    return program;
}

} // namespace lightloom
