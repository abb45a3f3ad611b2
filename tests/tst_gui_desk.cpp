// SPDX-License-Identifier: Apache-2.0
// Claim: the window is a desk that one can work at: it starts with the sample scenes as pictures, takes edits of lamps
// and parameters back, remembers where everything was, stays readable in both themes, and fits a small screen.
#include "widgets/gl/gl_probe.h"
#include "widgets/message_bar.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "widgets/start_page.h"
#include "widgets/theme.h"
#include "window_helpers.h"
#include <QApplication>
#include <QCheckBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QDropEvent>
#include <QMenu>
#include <QMimeData>
#include <QRegularExpression>
#include <QSettings>
#include <QSlider>
#include <QTemporaryDir>
#include <QToolButton>
#include <cmath>

using namespace lightloom;
using namespace lightloom::test;

namespace {

QDockWidget* dock(MainWindow& window, const char* name) { return window.findChild<QDockWidget*>(QString(name)); }

/// WCAG 2.1, relative luminance and contrast.
double contrast(const QColor& a, const QColor& b)
{
    const auto light = [](const QColor& c) {
        const auto linear = [](double v) { return v <= 0.03928 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); };
        return 0.2126 * linear(c.redF()) + 0.7152 * linear(c.greenF()) + 0.0722 * linear(c.blueF());
    };
    const double x = light(a), y = light(b);
    return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

bool dropFile(MainWindow& window, const QString& file)
{
    QMimeData mime;
    mime.setUrls({QUrl::fromLocalFile(file)});
    const QPoint at(200, 200);
    QDragEnterEvent enter(at, Qt::CopyAction, &mime, Qt::LeftButton, {});
    QApplication::sendEvent(&window, &enter);
    if (!enter.isAccepted()) return false;
    QDropEvent drop(at, Qt::CopyAction, &mime, Qt::LeftButton, {});
    QApplication::sendEvent(&window, &drop);
    return drop.isAccepted();
}

} // namespace

class DeskTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void initTestCase()
    {
        const Result<Done> gl = probeGl();
        QVERIFY2(gl, gl ? "" : gl.error().message.c_str());
    }

    void startsWithPicturesOfTheSampleScenes()
    {
        const auto window = makeWindow();
        QVERIFY(!dock(*window, "sceneDock")->isVisible() && !dock(*window, "bakeDock")->isVisible());
        const auto samples = window->findChildren<QToolButton*>(QRegularExpression("^sample\\..*"));
        QCOMPARE(samples.size(), sampleSceneFiles().size());
        QVERIFY(samples.size() >= 5);
        for (const QToolButton* sample : samples) {
            QVERIFY2(!sample->icon().isNull() && sample->icon().pixmap(200, 200).width() >= 150,
                     qPrintable(sample->objectName()));
        }
        QVERIFY(!actionNamed(*window, "Bake again")->isEnabled() && !actionNamed(*window, "Read again")->isEnabled());
        QSignalSpy ended(window.get(), &MainWindow::bakeEnded);
        window->findChild<QToolButton*>("sample.cornell")->click();
        QVERIFY(ended.wait(kPatience));
        QVERIFY(window->scene() && dock(*window, "sceneDock")->isVisible() && dock(*window, "bakeDock")->isVisible());
    }

    void dropsOfScenesOpenOthersDoNot()
    {
        const auto window = makeWindow();
        QVERIFY(!dropFile(*window, QStringLiteral(LIGHTLOOM_SOURCE_DIR "/README.md")));
        QSignalSpy ended(window.get(), &MainWindow::bakeEnded);
        QVERIFY(dropFile(*window, sampleFile("cornell")));
        QVERIFY(ended.wait(kPatience));
        QVERIFY(window->scene());
    }

    void editsAreTakenBack()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        QAction *undo = actionNamed(*window, "Undo"), *redo = actionNamed(*window, "Redo");
        QVERIFY(undo != nullptr && redo != nullptr);
        QVERIFY(!undo->isEnabled());
        auto* gain = window->findChildren<QSlider*>(QRegularExpression("^gain\\..*")).value(0);
        auto* on = window->findChildren<QCheckBox*>(QRegularExpression("^lamp\\..*")).value(0);
        auto* depth = window->findChild<QDoubleSpinBox*>("octree.depth");
        for (int percent = 99; percent >= 40; --percent) gain->setValue(percent); // one drag
        on->click();
        QSignalSpy ended(window.get(), &MainWindow::bakeEnded);
        depth->setValue(4);
        QVERIFY(ended.wait(kPatience));
        QCOMPARE(window->snapshots().shown()->snapshot.level, 4);

        QVERIFY2(undo->text().contains("Octree depth"), qPrintable(undo->text()));
        window->viewport()->setFocus();
        QTest::keyClick(window->viewport(), Qt::Key_Z, Qt::ControlModifier);
        QCOMPARE(depth->value(), 5.0);
        QVERIFY(ended.wait(kPatience)); // the bake follows
        QCOMPARE(window->snapshots().shown()->snapshot.level, 5);
        QVERIFY(!on->isChecked());
        undo->trigger();
        QVERIFY(on->isChecked());
        QCOMPARE(gain->value(), 40);
        undo->trigger();
        QCOMPARE(gain->value(), 100);
        QVERIFY(window->sceneDock().mix().front() == glm::vec3(1.0f));
        QVERIFY(!undo->isEnabled());
        redo->trigger();
        QCOMPARE(gain->value(), 40);
        QVERIFY(redo->isEnabled());
        QVERIFY(openAndBake(*window)); // another scene's lamps are not these
        QVERIFY(!undo->isEnabled() && !redo->isEnabled());
    }

    void aTypedNumberIsTakenBackFromItsField()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        auto* photons = window->findChild<QDoubleSpinBox*>("photons");
        photons->setFocus();
        photons->selectAll();
        QTest::keyClicks(photons, "5000");
        QTest::keyClick(photons, Qt::Key_Return);
        QCOMPARE(photons->value(), 5000.0);
        QTest::keyClick(photons, Qt::Key_Z, Qt::ControlModifier);
        QCOMPARE(photons->value(), double(smallBake().photonCount));
    }

    void placesAreRemembered()
    {
        const QTemporaryDir folder;
        const QString file = folder.filePath("lightloom.conf");
        QSize size;
        {
            QSettings settings(file, QSettings::IniFormat);
            const auto window = makeWindow(&settings);
            window->resize(1010, 707);
            QVERIFY(openAndBake(*window));
            QVERIFY(openAndBake(*window, sampleFile("two_rooms")));
            dock(*window, "sceneDock")->close();
            window->addDockWidget(Qt::LeftDockWidgetArea, dock(*window, "bakeDock"));
            actionNamed(*window, "Light theme")->trigger();
            actionNamed(*window, "No tone curve")->trigger();
            size = window->size();
            window->close();
        }
        QSettings settings(file, QSettings::IniFormat);
        QCOMPARE(settings.value("folder").toString(), QFileInfo(sampleFile("cornell")).absolutePath());
        {
            const auto started = makeWindow(&settings); // looked at and closed: nothing is forgotten
            QCOMPARE(started->size(), size);
            started->close();
        }
        const auto window = makeWindow(&settings);
        QCOMPARE(window->size(), size);
        QVERIFY(actionNamed(*window, "Light theme")->isChecked());
        QVERIFY(QApplication::palette().color(QPalette::Window).lightness() > 128);
        const QStringList recent = settings.value("recent").toStringList();
        QCOMPARE(recent.size(), 2);
        QVERIFY(recent.first().endsWith("two_rooms.glb"));
        QAction* again = actionNamed(*window, "two_rooms.glb"); // File > Open recent
        QVERIFY(again != nullptr);
        QSignalSpy ended(window.get(), &MainWindow::bakeEnded);
        again->trigger();
        QVERIFY(ended.wait(kPatience));
        QVERIFY(!dock(*window, "sceneDock")->isVisible());
        QVERIFY(dock(*window, "bakeDock")->isVisible());
        QCOMPARE(window->dockWidgetArea(dock(*window, "bakeDock")), Qt::LeftDockWidgetArea);
        QVERIFY(actionNamed(*window, "No tone curve")->isChecked());
        applyTheme(Theme::dark);
    }

    void readingAgainKeepsTheCamera()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        Viewport& viewport = *window->viewport();
        QTest::keyClick(&viewport, Qt::Key_F);
        const glm::vec3 eye = viewport.camera().eye();
        QSignalSpy ended(window.get(), &MainWindow::bakeEnded);
        actionNamed(*window, "Read again")->trigger();
        QVERIFY(ended.wait(kPatience));
        QVERIFY(viewport.camera().eye() == eye);
        QVERIFY(openAndBake(*window, sampleFile("two_rooms"))); // another scene has its own
        QVERIFY(viewport.camera().eye() != eye);
    }

    void tabSwapsTheLastTwoViews()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        Viewport& viewport = *window->viewport();
        viewport.setFocus();
        QTest::keyClick(&viewport, Qt::Key_6);
        QVERIFY(viewport.mode() == ViewMode::plain);
        QTest::keyClick(&viewport, Qt::Key_5);
        QTest::keyClick(&viewport, Qt::Key_Tab);
        QVERIFY(viewport.mode() == ViewMode::plain);
        QTest::keyClick(&viewport, Qt::Key_Tab);
        QVERIFY(viewport.mode() == ViewMode::direct);
    }

    void textsHaveContrast_data()
    {
        QTest::addColumn<int>("theme");
        QTest::addRow("dark") << int(Theme::dark);
        QTest::addRow("light") << int(Theme::light);
    }
    void textsHaveContrast()
    {
        QFETCH(int, theme);
        applyTheme(Theme(theme));
        const QPalette p = QApplication::palette();
        using Role = QPalette::ColorRole;
        const std::pair<Role, Role> pairs[] = {{Role::WindowText, Role::Window},
                                               {Role::WindowText, Role::AlternateBase},
                                               {Role::Text, Role::Base},
                                               {Role::Text, Role::AlternateBase},
                                               {Role::ButtonText, Role::Button},
                                               {Role::PlaceholderText, Role::Window},
                                               {Role::PlaceholderText, Role::Base},
                                               {Role::PlaceholderText, Role::AlternateBase},
                                               {Role::HighlightedText, Role::Highlight},
                                               {Role::ToolTipText, Role::ToolTipBase},
                                               {Role::Link, Role::Window}};
        for (const auto& [text, ground] : pairs) {
            const double ratio = contrast(p.color(text), p.color(ground));
            QVERIFY2(ratio >= 4.5, qPrintable(QString("%1 on %2: %3").arg(text).arg(ground).arg(ratio)));
        }
        QVERIFY(contrast(Qt::white, p.color(Role::Highlight)) >= 4.5); // checked buttons
        applyTheme(Theme::dark);
    }

    /// 1280x720 at 200 %: all that is left is 640x360, less a title bar.
    void aSmallScreenIsEnough()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        window->resize(640, 330);
        QCoreApplication::processEvents();
        QVERIFY2(window->width() <= 640 && window->height() <= 330,
                 qPrintable(QString("%1 x %2").arg(window->width()).arg(window->height())));
        QVERIFY(window->viewport()->width() >= 160 && window->viewport()->height() >= 120);
        // lamp rows keep inside their dock
        for (const QSlider* gain : window->findChildren<QSlider*>(QRegularExpression("^gain\\..*"))) {
            const QWidget* row = gain->parentWidget();
            QVERIFY(row->width() <= dock(*window, "sceneDock")->width());
            QVERIFY(gain->width() >= 40);
        }
        // a lamp that is edited in numbers takes no more room than there is
        window->sceneDock().findChildren<QToolButton*>(QRegularExpression("^edit\\..*")).first()->click();
        QCoreApplication::processEvents();
        QVERIFY2(window->height() <= 330, qPrintable(QString::number(window->height())));
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    DeskTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_desk.moc"
