// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/screenshot.h"
#include "widgets/main_window.h"
#include "widgets/message_bar.h"
#include "widgets/picture_desk.h"
#include "widgets/viewport.h"
#include <QApplication>
#include <QPixmap>
#include <QTimer>
#include <cstdio>

namespace lightloom {

namespace {

constexpr int kPatienceMs = 15 * 60 * 1000;

int fail(const QString& message)
{
    std::fprintf(stderr, "lightloom: %s\n", qPrintable(message));
    return 1;
}

} // namespace

int takeScreenshot(MainWindow& window, const QString& scene, const QString& file, bool final)
{
    QTimer look; // what it waits for is spread over workers and frames: asking is simpler than being told
    look.setInterval(50);
    bool isLit = scene.isEmpty();
    QObject::connect(&window, &MainWindow::lightShown, &look,
                     [&](bool isFinal) { isLit = isLit || isFinal || !final; });
    QObject::connect(&window, &MainWindow::openFailed, &look, [] { QApplication::exit(1); });
    QObject::connect(&window, &MainWindow::bakeEnded, &look, [&](bool isComplete) {
        if (!isComplete) QApplication::exit(1);
    });
    QObject::connect(&look, &QTimer::timeout, &look, [&] {
        const Viewport* view = window.viewport();
        const bool isDrawn = scene.isEmpty() || view == nullptr || (final ? view->isRefined() : view->isSettled());
        const bool isMade = !final || window.pictureDesk() == nullptr || window.pictureDesk()->isDone();
        const bool isDone = isMade && (!final || !window.isBaking());
        if (isLit && isDrawn && isDone) QApplication::exit(0);
    });
    QTimer::singleShot(kPatienceMs, &look, [] { QApplication::exit(2); });
    if (!scene.isEmpty()) window.openScene(scene);
    look.start();
    const int outcome = QApplication::exec();
    if (outcome == 2) return fail("the picture did not settle within 15 minutes; lower the size or octree.depth");
    if (outcome != 0) return fail(window.messages().text());
    if (!window.grab().save(file, "PNG")) return fail(file + " cannot be written");
    return 0;
}

} // namespace lightloom
