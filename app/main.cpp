// SPDX-License-Identifier: GPL-3.0-or-later
// The window. Start reading here, then BakeSession::work.
#include "core/params/param_text.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/main_window.h"
#include "widgets/screenshot.h"
#include <QApplication>
#include <QCommandLineParser>
#include <QSettings>
#include <algorithm>
#include <cstdio>
#include <string_view>

namespace {

/// "1280x800", or an invalid size.
QSize parseSize(const QString& text)
{
    const QStringList parts = text.split('x');
    if (parts.size() != 2) return {};
    const QSize size(parts[0].toInt(), parts[1].toInt());
    const bool fits = size.width() >= 320 && size.height() >= 240 && size.width() <= 8192 && size.height() <= 8192;
    return fits ? size : QSize();
}

int usage(const QString& message)
{
    std::fprintf(stderr, "lightloom: %s\n", qPrintable(message));
    return 2;
}

/// The command line, known before there is a window: --help must work without a display.
struct CommandLine {
    QCommandLineParser parser;
    QCommandLineOption picture{"screenshot", "Write the window's picture and exit.", "OUT.png"};
    QCommandLineOption size{"size", "Size of the window, at least 320x240.", "WxH", "1280x800"};
    QCommandLineOption method{"method", "Bake with light-octree, irradiance-grid or voxel-lightcuts.", "NAME",
                              "light-octree"};
    QCommandLineOption wait{"wait", "With --screenshot: wait for the final depth instead of the first one."};

    CommandLine()
    {
        parser.setApplicationDescription("Lighting design with baked indirect light.");
        parser.addHelpOption();
        parser.addVersionOption();
        parser.addPositionalArgument("scene", "glTF scene to open (.glb or .gltf).", "[SCENE]");
        parser.addOptions({picture, size, method, wait});
    }
};

void nameProgram()
{
    QCoreApplication::setApplicationName("lightloom");
    QCoreApplication::setOrganizationName("lightloom");
    QCoreApplication::setApplicationVersion(LIGHTLOOM_VERSION);
}

bool asksForText(int argc, char** argv)
{
    return std::any_of(argv + 1, argv + argc, [](std::string_view word) {
        return word == "--help" || word == "-h" || word == "--help-all" || word == "--version" || word == "-v";
    });
}

/// Qt aborts where it finds no display; say it in words instead.
bool hasDisplay()
{
    return qEnvironmentVariableIsSet("DISPLAY") || qEnvironmentVariableIsSet("WAYLAND_DISPLAY") ||
           qEnvironmentVariableIsSet("QT_QPA_PLATFORM");
}

} // namespace

int main(int argc, char** argv)
{
    nameProgram();
    CommandLine line;
    if (asksForText(argc, argv)) {
        const QCoreApplication text(argc, argv);
        line.parser.process(text); // prints and exits
    }
    if (!hasDisplay()) {
        std::fprintf(stderr, "lightloom: there is no display (DISPLAY is not set); lightloom-cli needs none\n");
        return 1;
    }
    lightloom::setDefaultGlFormat();
    QApplication application(argc, argv);
    const QCommandLineParser& parser = line.parser;
    line.parser.process(application);
    const QStringList scenes = parser.positionalArguments();
    if (scenes.size() > 1) return usage("one scene at a time");
    const QSize wanted = parseSize(parser.value(line.size));
    if (parser.isSet(line.size) && !wanted.isValid()) return usage("--size wants WxH, 320x240 to 8192x8192");
    const bool isPicture = parser.isSet(line.picture);

    QSettings settings; // a picture of the program must not depend on how someone left it
    lightloom::MainWindow window(isPicture ? nullptr : &settings);
    if (parser.isSet(line.size) || isPicture) window.resize(wanted);
    if (parser.isSet(line.method)) {
        const auto method = lightloom::methodNamed(parser.value(line.method).toStdString());
        if (!method || !window.showMethod(*method))
            return usage("--method wants light-octree, irradiance-grid or voxel-lightcuts");
    }
    window.show();
    if (isPicture) {
        return lightloom::takeScreenshot(window, scenes.value(0), parser.value(line.picture), parser.isSet(line.wait));
    }
    if (!scenes.isEmpty()) window.openScene(scenes.first());
    return QApplication::exec();
}
