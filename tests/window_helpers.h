// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "widgets/main_window.h"
#include "widgets/viewport.h"
#include <QSignalSpy>
#include <QtTest>
#include <memory>

/// What tests of the window share.
namespace lightloom::test {

inline constexpr int kPatience = 120'000;

inline QString sampleFile(const char* name)
{
    return QStringLiteral(LIGHTLOOM_SOURCE_DIR "/sample_scenes/%1.glb").arg(QString::fromLatin1(name));
}

/// Small enough that a bake takes a second or two.
inline BakeParams smallBake()
{
    BakeParams params;
    params.photonCount = 60'000;
    params.gatherCount = 100;
    params.octreeDepth = 5;
    return params;
}

/// A shown window with a small bake set; without `settings` it remembers nothing.
inline std::unique_ptr<MainWindow> makeWindow(QSettings* settings = nullptr)
{
    auto window = std::make_unique<MainWindow>(settings);
    window->setParams(smallBake());
    if (settings == nullptr) window->resize(1280, 640);
    window->show();
    window->activateWindow(); // shortcuts belong to the active window, and no window manager makes it so here
    if (!QTest::qWaitForWindowActive(window.get())) qWarning("the window did not become active");
    return window;
}

inline bool openAndBake(MainWindow& window, const QString& file = sampleFile("cornell"))
{
    QSignalSpy ended(&window, &MainWindow::bakeEnded);
    window.openScene(file);
    return ended.wait(kPatience) && ended.last().first().toBool();
}

inline bool settle(Viewport& viewport)
{
    return QTest::qWaitFor([&] { return viewport.isSettled(); }, kPatience);
}

} // namespace lightloom::test
