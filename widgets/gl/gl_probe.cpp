// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/gl/gl_probe.h"
#include "widgets/gl/gl_objects.h"
#include <QGuiApplication>
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLVersionFunctionsFactory>
#include <QSurfaceFormat>

namespace lightloom {

void setDefaultGlFormat()
{
    QSurfaceFormat format;
    format.setRenderableType(QSurfaceFormat::OpenGL);
    format.setVersion(3, 3);
    format.setProfile(QSurfaceFormat::CoreProfile);
    format.setDepthBufferSize(24);
    QSurfaceFormat::setDefaultFormat(format);
}

Result<Done> probeGl()
{
    const QString platform = QGuiApplication::platformName();
    for (const char* without : {"offscreen", "minimal", "vnc", "linuxfb"}) {
        if (platform == without) {
            return Error{Error::Kind::unsupported,
                         "the display (" + platform.toStdString() + ") has no OpenGL; start on a desktop to see light"};
        }
    }
    QOpenGLContext context;
    QOffscreenSurface surface;
    surface.create();
    if (!context.create() || !context.makeCurrent(&surface)) {
        return Error{Error::Kind::unsupported, "OpenGL does not start; install or repair the graphics driver"};
    }
    const auto version = context.format().version();
    const bool fine = version >= qMakePair(3, 3) &&
                      QOpenGLVersionFunctionsFactory::get<QOpenGLFunctions_3_3_Core>(&context) != nullptr;
    context.doneCurrent();
    if (fine) return Done{};
    return Error{Error::Kind::unsupported, "OpenGL 3.3 is needed and " + std::to_string(version.first) + "." +
                                               std::to_string(version.second) +
                                               " was found; a newer graphics driver may help"};
}

} // namespace lightloom
