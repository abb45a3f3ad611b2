// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/base/result.h"
#include "widgets/gl/gl_objects.h"
#include <QByteArray>
#include <QString>
#include <functional>
#include <optional>

namespace lightloom {

/// GLSL texts by name, with `#include "name"` resolved, and programs made of them. A program's first line that is no
/// comment must be `#version 330 core`; `SHARED` is defined empty after it.
class ShaderLibrary {
public:
    /// Text of a file, or nothing.
    using Loader = std::function<std::optional<QByteArray>(const QString& name)>;
    /// Without a loader: the program's own resources, `:/shaders/`.
    explicit ShaderLibrary(Loader loader = {});

    /// `name` with every include put in, each file once, `#line` kept (second number: order of first appearance).
    /// Errors: a file that is missing or includes itself in the end; the message names both ends.
    [[nodiscard]] Result<QByteArray> expand(const QString& name) const;

    /// Compiles and links. `defines` stands after the version line ("#define GLOSSY 1\n"). Attribute locations are in
    /// the shaders. Errors: what `expand` says, or the driver's log.
    [[nodiscard]] Result<GlProgram> link(Gl& gl, const QString& vertex, const QString& fragment,
                                         const QByteArray& defines = {}) const;

private:
    Loader loader_;
};

} // namespace lightloom
