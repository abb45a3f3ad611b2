// SPDX-License-Identifier: Apache-2.0
// Claims about what use showed: at 1280 pixels of width nothing of the toolbar is cut off and the snapshots stand
// beside a legend whole, or the oldest of them in a menu; the form of a lamp is readable under a long list of lamps,
// whose row is in sight; labels of lights do not hide each other; the figure under the cursor follows lamps and bakes
// while the mouse rests, and is of where the cursor is, however it came there.
#include "widgets/bake_panel.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/lamp_desk.h"
#include "widgets/lamp_editor.h"
#include "widgets/legend_strip.h"
#include "widgets/message_bar.h"
#include "widgets/pick_card.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QApplication>
#include <QCursor>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QMenu>
#include <QScopeGuard>
#include <QScrollArea>
#include <QScrollBar>
#include <QSlider>
#include <QToolBar>
#include <QToolButton>
#include <algorithm>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// The label whose text ends so; null: none.
QLabel* labelEnding(MainWindow& window, const QString& end)
{
    for (QLabel* label : window.findChildren<QLabel*>()) {
        if (label->text().endsWith(end)) return label;
    }
    return nullptr;
}

} // namespace

class GuiFitTest : public QObject {
    Q_OBJECT
    std::unique_ptr<MainWindow> window_;

private Q_SLOTS:
    void initTestCase()
    {
        const Result<Done> gl = probeGl();
        QVERIFY2(gl, gl ? "" : gl.error().message.c_str());
        window_ = makeWindow();
        window_->resize(1280, 720);
        QVERIFY(openAndBake(*window_));
    }

    void theToolbarIsWhole()
    {
        auto* bar = window_->findChild<QToolBar*>();
        QVERIFY(bar != nullptr);
        for (const char* mode : {"Octree", "Colour octree", "Photon map", "Atlas", "Reference", "Direct", "Plain"}) {
            for (const char* shown : {"Light", "Error, %", "Error, lux", "Signed error"}) {
                actionNamed(*window_, mode)->trigger();
                actionNamed(*window_, shown)->trigger();
                QCoreApplication::processEvents();
                const int wanted = bar->sizeHint().width();
                QVERIFY2(wanted <= bar->width(),
                         qPrintable(QString("%1, %2: %3 of %4").arg(mode, shown).arg(wanted).arg(bar->width())));
                for (QAction* action : bar->actions()) {
                    QWidget* widget = bar->widgetForAction(action);
                    QVERIFY(widget->isVisible() && bar->rect().contains(widget->geometry()));
                }
            }
        }
        actionNamed(*window_, "Light")->trigger();
        actionNamed(*window_, "Octree")->trigger();
    }

    void whatTheToolbarHidesIsInTheMenus()
    {
        QSet<QAction*> inMenus;
        for (const QMenu* menu : window_->findChildren<QMenu*>()) {
            if (qobject_cast<QToolButton*>(menu->parentWidget()) != nullptr) continue;
            for (QAction* action : menu->actions()) inMenus.insert(action);
        }
        auto* bar = window_->findChild<QToolBar*>();
        for (QAction* action : bar->actions()) {
            const auto* button = qobject_cast<QToolButton*>(bar->widgetForAction(action));
            if (button == nullptr) continue;
            QList<QAction*> all = button->menu() != nullptr ? button->menu()->actions() : QList<QAction*>{action};
            for (QAction* each : all) QVERIFY2(inMenus.contains(each), qPrintable(each->text()));
        }
    }

    void snapshotsAndLegendShareTheirRow()
    {
        actionNamed(*window_, "Error, %")->trigger();
        QTRY_VERIFY_WITH_TIMEOUT(window_->legend().isVisible(), 5000);
        QCoreApplication::processEvents();
        const QScrollBar* scroll = window_->snapshots().horizontalScrollBar();
        QVERIFY2(scroll->maximum() == 0, qPrintable(QString("%1 pixels are out of sight").arg(scroll->maximum())));
        QVERIFY(window_->legend().width() >= 280);
        actionNamed(*window_, "Light")->trigger();
    }

    void legendsCaptionsAreWhole()
    {
        LegendStrip strip;
        HeatmapStyle scale;
        scale.kind = ErrorKind::absolute;
        scale.top = 1.0f;
        scale.unit = LegendUnit::percent;
        const int height = window_->legend().height();
        for (const int width : {strip.sizeHint().width(), 520, 700}) { // beside snapshots of a window of 1280 and less
            strip.resize(width, height);
            for (const char* text :
                 {"Surface in a voxel, of a face of it\nLightcuts: in blocks of 8 pixels",
                  "|Error| of the indirect light, of its mean\nin blocks of 2 pixels so far, next 43 %",
                  "Radiosity of voxels, lm/m²\nLightcuts: in blocks of 2 pixels, next 43 %"}) {
                strip.show(scale, QString::fromUtf8(text));
                const QRect place = strip.captionPlace();
                const QRect words =
                    strip.fontMetrics().boundingRect(place, Qt::AlignVCenter | Qt::TextWordWrap, strip.caption());
                QVERIFY2(place.contains(words), qPrintable(QString("%1 at %2: %3 x %4 of %5 x %6")
                                                               .arg(strip.caption())
                                                               .arg(width)
                                                               .arg(words.width())
                                                               .arg(words.height())
                                                               .arg(place.width())
                                                               .arg(place.height())));
                QVERIFY(strip.barLength() >= 120 && place.right() < width);
            }
        }
    }

    void manySnapshotsNeedNoScrolling() // what there is no room for is in a menu, what is shown never
    {
        SnapshotBar bar;
        BakeView view;
        constexpr int kCount = 9;
        for (int level = 1; level <= kCount; ++level) {
            view.snapshot.level = level;
            bar.add(view);
        }
        const int wide = bar.sizeHint().width();
        bar.show();
        const auto buttons = bar.findChildren<QToolButton*>();
        auto* menu = bar.findChild<QMenu*>();
        QCOMPARE(buttons.size(), kCount);
        for (const int width : {wide, wide / 2, wide / 4}) {
            bar.resize(width, bar.height());
            QCoreApplication::processEvents();
            QVERIFY2(bar.horizontalScrollBar()->maximum() == 0, qPrintable(QString("%1 pixels wide").arg(width)));
            Q_EMIT menu->aboutToShow();
            const auto isSeen = [](const QToolButton* button) { return !button->isHidden(); };
            QCOMPARE(std::ranges::count_if(buttons, isSeen) + menu->actions().size(), kCount);
            QVERIFY(isSeen(buttons.last()) && (width < wide || menu->isEmpty()));
        }
        QVERIFY(!menu->isEmpty());
        menu->actions().first()->trigger();
        QCOMPARE(bar.shown()->snapshot.level, 1);
        QVERIFY(buttons.first()->isChecked() && !buttons.first()->isHidden());
        QVERIFY(bar.horizontalScrollBar()->maximum() == 0);
    }

    void longNamesWidenNothing()
    {
        const QTemporaryDir folder;
        const QString name = folder.filePath(QString("scene_of_a_project_with_many_words").repeated(5) + ".glb");
        QFile file(name);
        QVERIFY(file.open(QIODevice::WriteOnly) && file.write("no scene") == 8);
        file.close();
        QSignalSpy failed(window_.get(), &MainWindow::openFailed);
        window_->openScene(name);
        QVERIFY(failed.wait(kPatience));
        QTest::qWait(50);
        QCOMPARE(window_->width(), 1280);
        QVERIFY(window_->messages().isVisible() && window_->minimumSizeHint().width() <= 1280);
        const QString said = window_->messages().text();
        QVERIFY2(said.contains(QFileInfo(name).fileName()), qPrintable(said));
        window_->messages().clear();
    }

    void panelsAreMovedByHandAndPutBack()
    {
        auto* scene = window_->findChild<QDockWidget*>("sceneDock");
        auto* bake = window_->findChild<QDockWidget*>("bakeDock");
        QCOMPARE(window_->dockWidgetArea(scene), Qt::LeftDockWidgetArea);
        drag(*scene, QPoint(60, 8), scene->mapFromGlobal(bake->mapToGlobal(bake->rect().center())));
        QTRY_COMPARE_WITH_TIMEOUT(window_->dockWidgetArea(scene), Qt::RightDockWidgetArea, 5000);
        QTRY_VERIFY_WITH_TIMEOUT(!scene->isFloating(), 5000);
        bake->setFloating(true);
        window_->findChild<QDockWidget*>("compareDock")->close();
        actionNamed(*window_, "Put all back")->trigger();
        for (const QDockWidget* dock : window_->findChildren<QDockWidget*>()) {
            const bool isScene = dock == scene;
            QVERIFY(!dock->isFloating() && !dock->isHidden());
            QCOMPARE(window_->dockWidgetArea(const_cast<QDockWidget*>(dock)),
                     isScene ? Qt::LeftDockWidgetArea : Qt::RightDockWidgetArea);
        }
        QCOMPARE(window_->tabifiedDockWidgets(bake).size(), 2);
    }

    void figuresOfTheBakeBeforeSaySo()
    {
        QAction start, pause, cancel;
        BakePanel panel(&start, &pause, &cancel);
        WorkCounters counters;
        counters.ledger.emitted = counters.ledger.absorbed = glm::dvec3(10.0);
        panel.begin();
        panel.end("Done", counters);
        const QString light = panel.lightText();
        QVERIFY2(light.startsWith("Light: "), qPrintable(light));
        for (int i = 0; i < 2; ++i) { // one that is overtaken, and the next
            panel.begin();
            QCOMPARE(panel.lightText(), "Bake before: " + light);
        }
        panel.end("Done", counters);
        QCOMPARE(panel.lightText(), light);
    }

    void labelsKeepApart()
    {
        QWidget sheet;
        sheet.resize(400, 300);
        PickCard card(&sheet);
        std::vector<PickCard::Label> labels;
        for (const double y : {100.0, 104.0, 99.0, 112.0, 250.0}) labels.push_back({QPointF(50.0, y), "12.5 lx"});
        card.setLabels(labels);
        const std::vector<QRectF> places = card.labelPlaces();
        QCOMPARE(places.size(), labels.size());
        for (std::size_t i = 0; i < places.size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) QVERIFY(!places[i].intersects(places[j]));
        }
        QCOMPARE(places[4].center().y(), 250.0); // what hides nothing stays
        QCOMPARE(places[2].center().y(), 99.0);
    }

    void theFigureUnderTheCursorFollowsTheLight()
    {
        Viewport& viewport = *window_->viewport();
        QVERIFY(settle(viewport));
        QTest::mouseMove(window_->findChild<QToolBar*>(), QPoint(5, 5)); // off the picture: no figure of another place
        QTRY_VERIFY_WITH_TIMEOUT(labelEnding(*window_, " lx at cursor") == nullptr, 10'000);
        QTest::mouseMove(&viewport, QPoint(viewport.width() / 2, viewport.height() * 9 / 10));
        QLabel* figure = nullptr;
        QTRY_VERIFY_WITH_TIMEOUT((figure = labelEnding(*window_, " lx at cursor")) != nullptr, 10'000);
        const double full = figure->text().split(' ').first().toDouble();
        QVERIFY(full > 0.0);
        window_->sceneDock().findChild<QSlider*>()->setValue(50);
        const auto now = [&] { return figure->text().split(' ').first().toDouble(); };
        QTRY_VERIFY2_WITH_TIMEOUT(std::abs(now() / full - 0.5) < 0.01, qPrintable(figure->text()), 10'000);
        window_->sceneDock().findChild<QSlider*>()->setValue(100);
        QTRY_VERIFY_WITH_TIMEOUT(std::abs(now() / full - 1.0) < 0.01, 10'000);
    }

    /// Not by a move of the mouse: what lay over the viewport goes, or the viewport itself moves under it.
    void theFigureIsOfWhereTheCursorIs()
    {
        Viewport& viewport = *window_->viewport();
        auto* dock = window_->findChild<QDockWidget*>("sceneDock");
        glm::vec3 place(0.0f);
        bool isOn = false;
        const auto watch = connect(&viewport, &Viewport::hovered, this, [&](bool isOnSurface, glm::vec3 p, glm::vec3) {
            isOn = isOnSurface;
            place = p;
        });
        const auto cleanUp = qScopeGuard([&] { disconnect(watch); });
        const auto missed = [&] { // pixels between the cursor and what was looked at
            const auto at = isOn ? viewport.placeIn(place) : std::nullopt;
            return at ? (*at - QPointF(viewport.mapFromGlobal(QCursor::pos()))).manhattanLength() : 1e9;
        };
        QVERIFY(settle(viewport));
        QTest::mouseMove(&viewport, {viewport.width() / 2, viewport.height() * 3 / 4});
        QTRY_VERIFY2_WITH_TIMEOUT(missed() < 3.0, "a move", 10'000);

        dock->setFloating(true);
        dock->setGeometry(QRect(viewport.mapToGlobal(QPoint(20, 20)), QSize(240, 300)));
        QVERIFY(settle(viewport));
        QTest::mouseMove(dock, {200, 200});
        QTRY_VERIFY2_WITH_TIMEOUT(!viewport.underMouse() && !isOn, "a panel lies over it", 10'000);
        dock->hide();
        QTRY_VERIFY2_WITH_TIMEOUT(missed() < 3.0, qPrintable(QString("panel gone: %1").arg(missed())), 10'000);

        dock->setFloating(false);
        dock->show();
        QTest::qWait(50);
        QVERIFY(settle(viewport));
        QTest::mouseMove(&viewport, {viewport.width() / 3, viewport.height() * 3 / 4});
        QTRY_VERIFY2_WITH_TIMEOUT(missed() < 3.0, "a move", 10'000);
        const QPoint before = viewport.mapFromGlobal(QCursor::pos());
        dock->hide();
        QTRY_VERIFY_WITH_TIMEOUT(viewport.mapFromGlobal(QCursor::pos()).x() > before.x() + 50, 10'000);
        QVERIFY(settle(viewport));
        QTRY_VERIFY2_WITH_TIMEOUT(missed() < 3.0, qPrintable(QString("viewport moved: %1").arg(missed())), 10'000);
        dock->show();
        QVERIFY(settle(viewport));
    }

    void aLampsFormIsReadableUnderALongList()
    {
        QSignalSpy opened(window_.get(), &MainWindow::sceneOpened);
        window_->openScene(sampleFile("gallery"));
        QVERIFY(opened.wait(kPatience));
        actionNamed(*window_, "Move lamps")->trigger();
        const int last = static_cast<int>(window_->scene()->groups.size()) - 1;
        QVERIFY(last >= 10);
        window_->lampDesk()->choose(last);
        QCoreApplication::processEvents();
        QTest::qWait(50);
        const SceneDock& dock = window_->sceneDock();
        int seen = 0;
        for (const QDoubleSpinBox* field : dock.editor().findChildren<QDoubleSpinBox*>()) {
            seen += field->isVisible() && field->visibleRegion().boundingRect().height() == field->height() ? 1 : 0;
        }
        QVERIFY2(seen >= 4, qPrintable(QString("%1 fields in sight").arg(seen)));
        const auto buttons = dock.findChildren<QToolButton*>();
        const QToolButton* edit = buttons.last();
        QVERIFY(edit->isChecked());
        QCOMPARE(edit->visibleRegion().boundingRect().height(), edit->height());
    }

    void aClickIntoAGlowingSurfaceChoosesIt()
    {
        Viewport& viewport = *window_->viewport();
        QVERIFY(settle(viewport));
        const Scene& scene = *window_->scene();
        // the middle of the first panel that the camera sees
        for (const Instance& instance : scene.instances) {
            if (instance.group < 0) continue;
            const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
            glm::vec3 middle(0.0f);
            for (const glm::vec3 p : mesh.positions) {
                middle += glm::vec3(instance.toWorld * glm::vec4(p, 1.0f)) / static_cast<float>(mesh.positions.size());
            }
            const auto at = viewport.placeIn(middle);
            if (!at || !QRectF(viewport.rect()).contains(*at)) continue;
            window_->lampDesk()->choose(-1);
            QTest::mouseClick(&viewport, Qt::LeftButton, {}, at->toPoint());
            QCOMPARE(window_->lampDesk()->group(), instance.group);
            return;
        }
        QFAIL("no panel is in the picture");
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    GuiFitTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_fit.moc"
