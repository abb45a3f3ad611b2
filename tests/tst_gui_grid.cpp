// SPDX-License-Identifier: Apache-2.0
// Claim: the window bakes, shows and judges irradiance grids as it does octrees. The mode chooses the method; filter
// and form change the picture without a bake and can be undone; dimming needs none either; the atlas, the light under
// the cursor and the snapshots are the grid's; what was edited stays when the method changes, and the rest follows the
// preset.
#include "core/base/units.h"
#include "core/ivg/irradiance_grid.h"
#include "core/octree/light_octree.h"
#include "core/params/param_text.h"
#include "widgets/bake_panel.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/pick_card.h"
#include "widgets/pick_desk.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QApplication>
#include <QComboBox>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QSlider>
#include <QStatusBar>
#include <QToolButton>

using namespace lightloom;
using namespace lightloom::test;

class GuiGridTest : public QObject {
    Q_OBJECT

    std::unique_ptr<MainWindow> window_;
    Viewport* viewport_ = nullptr;

    void press(Qt::Key key, Qt::KeyboardModifiers with = {}) const
    {
        viewport_->setFocus();
        QTest::keyClick(viewport_, key, with);
    }
    [[nodiscard]] QImage picture() const
    {
        [&] { QVERIFY(settle(*viewport_)); }();
        return viewport_->grabFramebuffer();
    }
    /// The picture that does not change any more by itself: a settled one still gets finer.
    [[nodiscard]] QImage refined() const
    {
        [&] { QVERIFY(QTest::qWaitFor([&] { return viewport_->isRefined(); }, kPatience)); }();
        return viewport_->grabFramebuffer();
    }
    /// Presses a key that chooses another method, and waits for its bake.
    [[nodiscard]] bool bakeBy(Qt::Key key) const
    {
        QSignalSpy ended(window_.get(), &MainWindow::bakeEnded);
        press(key);
        return ended.wait(kPatience) && ended.last().first().toBool();
    }
    [[nodiscard]] std::shared_ptr<const IrradianceGrid> grid() const
    {
        const BakeView* view = window_->snapshots().shown();
        return view != nullptr ? std::dynamic_pointer_cast<const IrradianceGrid>(view->snapshot.field) : nullptr;
    }
    /// Does something that changes the way the light is looked at, and waits for it; false: it baked, or nothing came.
    template<class Act>
    [[nodiscard]] bool looksAnew(const Act& act) const
    {
        QSignalSpy ended(window_.get(), &MainWindow::bakeEnded);
        const std::uint64_t before = window_->snapshots().shown()->lookSerial;
        act();
        const bool came = QTest::qWaitFor([&] { return window_->snapshots().shown()->lookSerial > before; }, kPatience);
        return came && settle(*viewport_) && ended.isEmpty() && !window_->isBaking();
    }
    [[nodiscard]] QString cursorText() const
    {
        for (const QLabel* label : window_->findChildren<QLabel*>()) {
            if (label->text().endsWith("lx at cursor")) return label->toolTip();
        }
        return {};
    }

private Q_SLOTS:
    void initTestCase()
    {
        window_ = makeWindow();
        window_->resize(960, 480); // pictures are drawn by the processor here
        BakeParams params = smallBake();
        params.gridSize = 16;
        window_->setParams(params);
        QVERIFY(openAndBake(*window_));
        viewport_ = window_->viewport();
        QVERIFY(viewport_);
    }

    void theModeChoosesTheMethod()
    {
        const QImage octree = picture();
        QVERIFY(bakeBy(Qt::Key_2));
        QCOMPARE(viewport_->mode(), ViewMode::grid);
        QVERIFY(grid());
        QCOMPARE(window_->snapshots().shown()->snapshot.field->method(), std::string_view("irradiance-grid"));
        QVERIFY(window_->snapshots().shown()->noise); // as the bake states it
        const double apart = meanDifference(octree, picture());
        qInfo("octree and grid: %.2f of 255 apart", apart);
        QVERIFY(apart > 0.0 && apart < 12.0); // the same light twice
        QVERIFY(window_->bakePanel().countersText().contains("vertices in the open"));
        QVERIFY(!window_->findChild<QWidget*>("octree.depth"));
        auto* size = window_->findChild<QDoubleSpinBox*>("grid.size");
        QVERIFY(size);
        QCOMPARE(size->value(), 16.0);
        QCOMPARE(window_->findChild<QDoubleSpinBox*>("photons")->value(), 60'000.0);
    }

    void anotherSizeBakesAgain()
    {
        auto* size = window_->findChild<QDoubleSpinBox*>("grid.size");
        QSignalSpy ended(window_.get(), &MainWindow::bakeEnded);
        size->setValue(12.0);
        QVERIFY(ended.wait(kPatience));
        const glm::ivec3 cells = grid()->geometry().lattice.cells;
        QCOMPARE(std::max({cells.x, cells.y, cells.z}), 12);
        const QString text = QString("%1 x %2 x %3 cells").arg(cells.x).arg(cells.y).arg(cells.z);
        bool isSaid = false;
        for (const QLabel* label : window_->statusBar()->findChildren<QLabel*>())
            isSaid = isSaid || label->text().startsWith(text);
        QVERIFY(isSaid);
    }

    void filterAndFormNeedNoBake()
    {
        const QImage trilinear = picture();
        QVERIFY(looksAnew([&] { press(Qt::Key_T); }));
        QCOMPARE(grid()->show().filter, GridFilter::bspline);
        QVERIFY(actionNamed(*window_, "Tricubic")->isChecked());
        QCOMPARE(window_->findChild<QComboBox*>("grid.filter")->currentText(), QString("b-spline"));
        const QImage tricubic = picture();
        QVERIFY(meanDifference(trilinear, tricubic) > 0.02);
        QVERIFY(looksAnew([&] { actionNamed(*window_, "As printed")->trigger(); }));
        QCOMPARE(grid()->show().remap, GridRemap::paper);
        const QImage printed = picture();
        QVERIFY(looksAnew([&] { actionNamed(*window_, "As printed, compressed")->trigger(); }));
        QCOMPARE(window_->snapshots().shown()->gpuGrid->packing, GridPacking::compressed);
        QCOMPARE(window_->snapshots().shown()->gpuGrid->slabCount(), 12);
        QVERIFY(meanDifference(printed, picture()) > 0.0);
        // undo takes back both, one after the other
        QVERIFY(looksAnew([&] { actionNamed(*window_, "Undo")->trigger(); }));
        QCOMPARE(grid()->show().remap, GridRemap::joined);
        QVERIFY(actionNamed(*window_, "Joined")->isChecked());
        QVERIFY(looksAnew([&] { actionNamed(*window_, "Undo")->trigger(); }));
        QCOMPARE(grid()->show().filter, GridFilter::trilinear);
        QCOMPARE(picture(), trilinear);
    }

    void aFinerGridInsideIsShown()
    {
        const QImage plain = picture();
        const std::size_t bytes = window_->snapshots().shown()->textureBytes();
        auto* nest = window_->findChild<QComboBox*>("grid.nest");
        QVERIFY(nest);
        for (const GridNest wanted : {GridNest::automatic, GridNest::off}) {
            QSignalSpy ended(window_.get(), &MainWindow::bakeEnded);
            Q_EMIT nest->activated(int(wanted)); // as a choice by hand
            QVERIFY(ended.wait(kPatience) && ended.last().first().toBool());
            const BakeView* view = window_->snapshots().shown();
            QVERIFY2(view->problem.isEmpty() && view->gpuGrid, qPrintable(view->problem));
            const bool isNested = wanted == GridNest::automatic;
            QCOMPARE(view->gpuGrid->inside != nullptr, isNested);
            QVERIFY(isNested ? view->textureBytes() > bytes : view->textureBytes() == bytes);
            QVERIFY(isNested == (picture() != plain));
        }
    }

    void snapshotsAreNamedByWhatTheyAreOf() // cells, photons, form
    {
        QStringList names;
        const auto read = [&] {
            names.clear();
            for (const QToolButton* button : window_->snapshots().findChildren<QToolButton*>())
                names += button->text().section("  ", 0, 0);
        };
        QSignalSpy ended(window_.get(), &MainWindow::bakeEnded);
        BakeParams params = smallBake();
        params.gridSize = 10;
        params.photonCount = 150'000;
        const auto isHidden = [&](const char* key) { return window_->findChild<QWidget*>(key)->isHidden(); };
        QVERIFY(isHidden("grid.nest.fine") && isHidden("grid.nest.low.x") && !isHidden("grid.nest"));
        QVERIFY(isHidden("grid.shift.reset") && !isHidden("grid.size.reset"));
        params.gridNest = GridNest::automatic;
        window_->setParams(params);
        QVERIFY(!isHidden("grid.nest.fine") && isHidden("grid.nest.fine.reset") && isHidden("grid.nest.low.x"));
        QVERIFY(ended.wait(kPatience) && ended.last().first().toBool());
        read();
        QCOMPARE(names, QStringList({"N 10, 66k", "N 10, 131k", "N 10, 150k", "N 10 + 20, 150k"}));
        // vertices are marked of both grids
        const QImage plain = picture();
        QVERIFY(looksAnew([&] { press(Qt::Key_V); }));
        const auto vertices = window_->snapshots().shown()->vertices;
        QCOMPARE(vertices->lattices.size(), std::size_t{2});
        QCOMPARE(vertices->lattices[1].colours.size(), grid()->inside().grid->geometry().lattice.vertexCount());
        QVERIFY(meanDifference(plain, picture()) > 0.1);
        QVERIFY(looksAnew([&] { actionNamed(*window_, "No vertices")->trigger(); }));
        QCOMPARE(picture(), plain);
        QVERIFY(looksAnew([&] { actionNamed(*window_, "Flux")->trigger(); }));
        read();
        QCOMPARE(names.last(), QString("N 10 + 20, 150k, flux"));
        QVERIFY(looksAnew([&] { actionNamed(*window_, "Undo")->trigger(); }));
        read();
        QCOMPARE(names.last(), QString("N 10 + 20, 150k"));
        ended.clear();
        actionNamed(*window_, "Undo")->trigger();
        QVERIFY(ended.wait(kPatience));
    }

    void dimmingNeedsNoBake()
    {
        const glm::vec3 p = window_->scene()->bounds.centre(), n(0, 1, 0);
        const float full = grid()->irradiance(p, n).y;
        auto* slider = window_->sceneDock().findChild<QSlider*>();
        QVERIFY(slider);
        QVERIFY(looksAnew([&] { slider->setValue(50); }));
        QVERIFY(std::abs(grid()->irradiance(p, n).y / full - 0.5f) <= 1e-3f);
        QVERIFY(looksAnew([&] { slider->setValue(100); }));
    }

    void theCursorTellsTheGridsLight()
    {
        (void)picture();
        const QPoint at(viewport_->width() / 2, viewport_->height() * 3 / 4);
        QTest::mouseMove(viewport_, at - QPoint(3, 0));
        QTest::mouseMove(viewport_, at);
        QTRY_VERIFY_WITH_TIMEOUT(cursorText().contains("indirect"), kPatience);
    }

    /// A click tells what lights a place: its vertices, the light with its noise, and what would fall on other things.
    void aClickTellsOfTheVertices()
    {
        PickDesk& desk = *window_->pickDesk();
        const QImage before = refined();
        QTest::mouseClick(viewport_, Qt::LeftButton, Qt::AltModifier,
                          QPoint(viewport_->width() / 3, viewport_->height() * 9 / 10));
        QVERIFY(QTest::qWaitFor([&] { return desk.picked() && desk.picked()->grid; }, kPatience));
        const PickedGrid& picked = *desk.picked()->grid;
        glm::vec3 lux(0.0f);
        QVERIFY(picked.normal.y > 0.9f && picked.isLit && grid()->lookup(picked.point, picked.normal, lux));
        QCOMPARE(picked.lux, lux);
        QCOMPARE(picked.noise, grid()->noise(picked.point, picked.normal).value_or(-1.0f));
        QVERIFY(!picked.vertices.empty() && picked.vertices.size() <= 8);
        for (const glm::vec3 vertex : picked.vertices) {
            const glm::vec3 way = glm::abs(vertex - picked.point) / picked.lattice.cellSize;
            QVERIFY(glm::max(way.x, glm::max(way.y, way.z)) <= 2.0f);
        }
        // the floor faces up: so does what would lie just above it
        QVERIFY(std::abs(luminance(picked.around[3]) / luminance(lux) - 1.0f) < 0.2f);
        const QString text = desk.card().lines().join('\n');
        for (const char* part : {"Grid of", "lx indirect at the point, noise", "vertices", "+y"})
            QVERIFY2(text.contains(part), qPrintable(text));
        QVERIFY(refined() != before); // marks over it
        actionNamed(*window_, "Pick a cell")->trigger();
        QVERIFY(!desk.picked() && refined() == before);
    }

    void theAtlasIsOfTheGrid()
    {
        const QImage direct = picture();
        press(Qt::Key_3, Qt::AltModifier);
        QCOMPARE(viewport_->mode(), ViewMode::atlas);
        QTRY_VERIFY_WITH_TIMEOUT(viewport_->hasAtlas(), kPatience);
        QVERIFY(grid()); // still
        const double apart = meanDifference(direct, picture());
        qInfo("grid and its atlas: %.4f of 255 apart", apart);
        QVERIFY(apart > 0.0 && apart < 2.0);
        press(Qt::Key_2);
    }

    void goingToAndFroShootsNothing()
    {
        QSignalSpy ended(window_.get(), &MainWindow::bakeEnded);
        QVERIFY(bakeBy(Qt::Key_1));
        QVERIFY(!grid());
        QVERIFY(window_->findChild<QWidget*>("octree.depth"));
        for (const ViewMode mode : {ViewMode::grid, ViewMode::octree}) { // what both have made is kept now
            ended.clear();
            press(Qt::Key_Tab);
            QCOMPARE(viewport_->mode(), mode);
            QVERIFY(ended.wait(kPatience));
            QVERIFY2(window_->bakePanel().countersText().contains("Photons: 0 shot"),
                     qPrintable(window_->bakePanel().countersText()));
            QTRY_COMPARE_WITH_TIMEOUT(grid() != nullptr, mode == ViewMode::grid, kPatience);
        }
    }

    void presetsFollowTheMethod()
    {
        const std::unique_ptr<MainWindow> window = makeWindow(); // without a scene: nothing bakes
        window->setParams(defaultParams(Method::lightOctree));
        const auto number = [&](const char* key) { return window->findChild<QDoubleSpinBox*>(key)->value(); };
        const auto use = [&](const char* mode) { actionNamed(*window, mode)->trigger(); };
        use("Grid");
        QCOMPARE(number("photons"), static_cast<double>(defaultParams(Method::irradianceGrid).photonCount));
        use("Octree");
        QCOMPARE(number("photons"), static_cast<double>(BakeParams{}.photonCount));
        window->findChild<QDoubleSpinBox*>("photons")->setValue(123'456.0);
        use("Grid");
        QCOMPARE(number("photons"), 123'456.0); // edited: stays
        actionNamed(*window, "Undo")->trigger();
        QCOMPARE(number("photons"), static_cast<double>(defaultParams(Method::irradianceGrid).photonCount));
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    QApplication::setApplicationName("lightloom");
    GuiGridTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_grid.moc"
