// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "widgets/main_window.h"
#include "widgets/viewport.h"
#include <QAction>
#include <QImage>
#include <QMouseEvent>
#include <QSignalSpy>
#include <QTemporaryDir>
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

/// A scene in a folder of its own, where what is kept beside scenes may go; the user's cache folder is in there too.
class OwnScene {
public:
    explicit OwnScene(const char* name)
        : file_(folder_.filePath(QStringLiteral("%1.glb").arg(QString::fromLatin1(name))))
    {
        qputenv("XDG_CACHE_HOME", path("user").toUtf8());
        if (!QFile::copy(sampleFile(name), file_)) qFatal("%s cannot be copied", name);
    }
    [[nodiscard]] const QString& file() const { return file_; }
    [[nodiscard]] QString path(const char* name) const { return folder_.filePath(QString::fromLatin1(name)); }

private:
    QTemporaryDir folder_;
    QString file_;
};

/// A shown window with a small bake set; without `settings` it remembers nothing.
inline std::unique_ptr<MainWindow> makeWindow(QSettings* settings = nullptr)
{
    auto window = std::make_unique<MainWindow>(settings);
    window->setParams(smallBake());
    if (settings == nullptr) window->resize(1024, 560);
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

/// A command by the beginning of its text; null: there is none.
inline QAction* actionNamed(MainWindow& window, const QString& text)
{
    for (QAction* action : window.findChildren<QAction*>()) {
        if (action->text().remove('&').startsWith(text)) return action;
    }
    return nullptr;
}

/// How far the greys of two pictures of one size are apart in the mean, 0 to 255.
inline double meanDifference(const QImage& a, const QImage& b)
{
    double sum = 0.0;
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) sum += std::abs(qGray(a.pixel(x, y)) - qGray(b.pixel(x, y)));
    }
    return sum / (double(a.width()) * a.height());
}

/// With the left button, in four steps.
inline void drag(QWidget& widget, QPoint from, QPoint to)
{
    const QPointF start = widget.mapToGlobal(QPointF(from)), end = widget.mapToGlobal(QPointF(to));
    QTest::mousePress(&widget, Qt::LeftButton, {}, from);
    for (int i = 1; i <= 4; ++i) { // the widget itself may move meanwhile
        const QPointF at = start + (end - start) * (i / 4.0);
        QMouseEvent move(QEvent::MouseMove, widget.mapFromGlobal(at), at, Qt::LeftButton, Qt::LeftButton, {});
        QCoreApplication::sendEvent(&widget, &move);
    }
    QTest::mouseRelease(&widget, Qt::LeftButton, {}, widget.mapFromGlobal(end).toPoint());
}

} // namespace lightloom::test
