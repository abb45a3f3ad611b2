// SPDX-License-Identifier: Apache-2.0
// Claim: the window measures what a bake's parameters cost and bring: the rows of its sweep are those of core, a click
// on one bakes with its parameters (and can be taken back), tables and plots are saved, and a sweep stops at once.
#include "core/compare/sweep_plot.h"
#include "core/compare/sweep_table.h"
#include "core/photonmap/photon_products.h"
#include "widgets/bake_panel.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/param_panel.h"
#include "widgets/snapshot_bar.h"
#include "widgets/sweep_panel.h"
#include "widgets/trade_plot.h"
#include "window_helpers.h"
#include <QApplication>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QFile>
#include <QFileDialog>
#include <QLineEdit>
#include <QPushButton>
#include <QSpinBox>
#include <QTableWidget>

using namespace lightloom;
using namespace lightloom::test;

namespace {

BakeParams baseParams()
{
    BakeParams params = smallBake();
    params.octreeFirstDepth = params.octreeDepth = 4;
    return params;
}

/// A window on a scene, its Measure dock in front.
struct Room {
    explicit Room(const QString& file) : window(makeWindow())
    {
        window->setParams(baseParams());
        isBaked = openAndBake(*window, file);
        window->findChild<QDockWidget*>("measureDock")->raise();
        find<QSpinBox>("sweep.points")->setValue(200);
        find<QDoubleSpinBox>("sweep.noise")->setValue(10.0);
    }
    template<class T>
    T* find(const char* name) const
    {
        return window->findChild<T*>(QString(name));
    }
    void vary(int axis, const char* param, const char* values)
    {
        auto* box = find<QComboBox>(axis == 0 ? "sweep.param0" : "sweep.param1");
        box->setCurrentIndex(box->findData(QString(param)));
        auto* edit = find<QLineEdit>(axis == 0 ? "sweep.values0" : "sweep.values1");
        edit->selectAll();
        QTest::keyClicks(edit, values);
    }
    void press(const char* button) const { QTest::mouseClick(find<QPushButton>(button), Qt::LeftButton); }
    bool measure()
    {
        QSignalSpy ended(&panel(), &SweepPanel::ended);
        press("sweep.run");
        return ended.wait(kPatience);
    }
    SweepPanel& panel() const { return window->sweepPanel(); }

    std::unique_ptr<MainWindow> window;
    bool isBaked = false;
};

/// The same sweep by calls of core alone.
std::vector<SweepRow> coreRows(const std::shared_ptr<const Scene>& scene)
{
    SweepPlan plan{scene, Method::lightOctree, Isa::automatic, baseParams(), {}, {}};
    plan.axes.push_back(*parseSweepAxis("gather.count=50,100", plan.method));
    plan.axes.push_back(*parseSweepAxis("photons=20000,40000", plan.method));
    Workers workers(2);
    BakeProducts products;
    BakeControl control(workers, {});
    const auto at = sceneProducts({scene, plan.base, {}}, products, control);
    const ReferenceJob job{kJudgeSeed, 1'048'576, 0.1f, plan.base.pathDepth, plan.base.directSamples};
    const auto judge = traceJudge(*at, probeRows(*at, 200, kJudgeSeed), job, ReferenceStore(), workers, {});
    std::vector<SweepRow> rows;
    const auto done = runSweep(plan, *judge, {}, products, control, [&](SweepRow row) { rows.push_back(row); });
    return done ? rows : std::vector<SweepRow>();
}

} // namespace

class SweepTest : public QObject {
    Q_OBJECT
    OwnScene scene_{"cornell"};

private Q_SLOTS:
    void initTestCase()
    {
        const Result<Done> gl = probeGl();
        QVERIFY2(gl, gl ? "" : gl.error().message.c_str());
    }

    void rowsAreThoseOfCoreAndAClickTakesOne()
    {
        Room room(scene_.file());
        QVERIFY(room.isBaked);
        room.vary(0, "gather.count", "50,100");
        QVERIFY2(room.panel().stateText().startsWith("2 bakes"), qPrintable(room.panel().stateText()));
        room.vary(1, "photons", "20000,40000");
        QVERIFY2(room.panel().stateText().startsWith("4 bakes"), qPrintable(room.panel().stateText()));
        QVERIFY(room.measure());
        const std::vector<SweepRow>& rows = room.panel().rows();
        QCOMPARE(rows.size(), std::size_t(4));
        std::vector<SweepRow> expected = coreRows(room.window->scene());
        QCOMPARE(expected.size(), rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) { // shown in the order of the values
            QCOMPARE(rows[i].params.gatherCount, i < 2 ? 50 : 100);
            QCOMPARE(rows[i].params.photonCount, i % 2 == 0 ? 20'000 : 40'000);
            const auto same = std::ranges::find(expected, rows[i].params, &SweepRow::params);
            QVERIFY(same != expected.end());
            QCOMPARE(rows[i].error.relRmse, same->error.relRmse);
            QCOMPARE(rows[i].error.bias, same->error.bias);
            QCOMPARE(rows[i].split.noise, same->split.noise);
            QVERIFY(rows[i].error.relRmse > 0.0 && rows[i].cpuSeconds() > 0.0);
        }
        auto* table = room.window->findChild<QTableWidget*>();
        QCOMPARE(table->rowCount(), 4);
        QCOMPARE(table->item(2, 1)->text(), QString("100"));
        QCOMPARE(table->item(2, 4)->text(), QString("%1 %").arg(100.0 * rows[2].error.relRmse, 0, 'f', 1));
        const std::vector<bool> isFront = sweepFront(rows);
        for (int r = 0; r < 4; ++r) QCOMPARE(table->item(r, 0)->text() == "*", bool(isFront[std::size_t(r)]));

        TradePlot& plot = room.panel().plot();
        for (std::size_t i = 0; i < 4; ++i)
            QVERIFY(plot.placeOf(i) && plot.rect().contains(plot.placeOf(i)->toPoint()));
        // dearer is further right, wronger is higher
        QCOMPARE(plot.placeOf(0)->x() < plot.placeOf(3)->x(), rows[0].cpuSeconds() < rows[3].cpuSeconds());
        QCOMPARE(plot.placeOf(0)->y() < plot.placeOf(3)->y(), rows[0].error.relRmse > rows[3].error.relRmse);
        QSignalSpy ended(room.window.get(), &MainWindow::bakeEnded);
        QTest::mouseClick(&plot, Qt::LeftButton, {}, plot.placeOf(3)->toPoint());
        const auto* params = room.window->findChild<ParamPanel*>();
        QVERIFY(params->params() == rows[3].params);
        QVERIFY(ended.wait(kPatience) && ended.first().first().toBool());
        QCOMPARE(table->currentRow(), 3);
        actionNamed(*room.window, "Undo")->trigger();
        QVERIFY(params->params() == baseParams());
        QVERIFY(ended.wait(kPatience));
        QTest::mouseClick(&plot, Qt::LeftButton, {}, QPoint(2, 2)); // beside all points: nothing
        QVERIFY(params->params() == baseParams());
        table->setFocus();
        table->setCurrentCell(1, 0);
        QTest::keyClick(table, Qt::Key_Return);
        QVERIFY(params->params() == rows[1].params);
        QVERIFY(ended.wait(kPatience));

        const QString file = scene_.path("rows.csv");
        for (auto* button : room.window->findChildren<QPushButton*>()) {
            if (button->text().startsWith("Save table")) button->click();
        }
        auto* dialog = room.window->findChild<QFileDialog*>();
        QVERIFY(dialog != nullptr);
        dialog->selectFile(file);
        QMetaObject::invokeMethod(dialog, "accept");
        QTRY_VERIFY(QFile::exists(file));
        QFile saved(file);
        QVERIFY(saved.open(QIODevice::ReadOnly));
        const auto read = parseSweep(saved.readAll().toStdString(), Method::lightOctree);
        QVERIFY2(read, read ? "" : read.error().message.c_str());
        QCOMPARE(read->rows.size(), rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) {
            QVERIFY(read->rows[i].params == rows[i].params && read->rows[i].key == rows[i].key);
            QCOMPARE(read->rows[i].error.relRmse, rows[i].error.relRmse);
        }
    }

    void aGridsSweepVariesWhatAGridReads() // and each method keeps its own rows
    {
        Room room(scene_.file());
        QVERIFY(room.isBaked);
        const auto* param = room.find<QComboBox>("sweep.param0");
        QVERIFY(param->findData("gather.count") >= 0 && param->findData("grid.size") < 0);
        QSignalSpy ended(room.window.get(), &MainWindow::bakeEnded);
        QTest::keyClick(room.window->viewport(), Qt::Key_2);
        QVERIFY(ended.wait(kPatience));
        QCOMPARE(room.panel().method(), Method::irradianceGrid);
        QVERIFY(param->findData("gather.count") < 0);
        QCOMPARE(param->currentData().toString(), QString("grid.size"));
        QVERIFY2(room.panel().stateText().startsWith("3 bakes"), qPrintable(room.panel().stateText()));
        room.vary(0, "grid.size", "8,12");
        room.vary(1, "photons", "20000,40000");
        QVERIFY(room.measure());
        const std::vector<SweepRow> rows = room.panel().rows();
        QCOMPARE(rows.size(), std::size_t(4));
        for (std::size_t i = 0; i < rows.size(); ++i) {
            QCOMPARE(rows[i].params.gridSize, i < 2 ? 8 : 12);
            QCOMPARE(rows[i].params.photonCount, i % 2 == 0 ? 20'000 : 40'000);
            QVERIFY(rows[i].error.relRmse > 0.0 && rows[i].error.relRmse < 0.5 && rows[i].cpuSeconds() > 0.0);
            for (std::size_t j = 0; j < i; ++j) QVERIFY(rows[i].error.relRmse != rows[j].error.relRmse);
        }
        ended.clear();
        QTest::mouseClick(&room.panel().plot(), Qt::LeftButton, {}, room.panel().plot().placeOf(3)->toPoint());
        QVERIFY(ended.wait(kPatience) && ended.first().first().toBool());
        const auto grid =
            std::dynamic_pointer_cast<const IrradianceGrid>(room.window->snapshots().shown()->snapshot.field);
        QVERIFY(grid);
        const glm::ivec3 cells = grid->geometry().lattice.cells;
        QCOMPARE(std::max({cells.x, cells.y, cells.z}), 12);
        const QString name = shortName(*room.window->snapshots().shown());
        QCOMPARE(name, QString("N 12, 40k"));
        ended.clear();
        QTest::keyClick(room.window->viewport(), Qt::Key_1);
        QVERIFY(ended.wait(kPatience));
        QVERIFY(room.panel().rows().empty());
        QVERIFY(param->findData("grid.size") < 0);
        ended.clear();
        QTest::keyClick(room.window->viewport(), Qt::Key_2);
        QVERIFY(ended.wait(kPatience));
        QCOMPARE(room.panel().rows().size(), std::size_t(4));
        QCOMPARE(room.find<QLineEdit>("sweep.values0")->text(), QString("8,12"));
    }

    void whatCannotBeBakedIsSaidBefore()
    {
        Room room(scene_.file());
        const auto* run = room.find<QPushButton>("sweep.run");
        QVERIFY(run->isEnabled());
        room.vary(0, "octree.depth", "4,99");
        QVERIFY(!run->isEnabled());
        QVERIFY2(room.panel().stateText().contains("99"), qPrintable(room.panel().stateText()));
        room.vary(0, "octree.depth", "4,5");
        QVERIFY(run->isEnabled());
    }

    void itWaitsForABakeStopsAndCloses()
    {
        Room room(scene_.file());
        room.vary(0, "photons", "200000,400000,800000,1600000");
        BakeParams params = baseParams();
        params.octreeDepth = 8; // long enough to be waited for, also with few photons a leaf
        params.gatherCount = 40;
        params.photonCount = 400'000;
        room.window->setParams(params);
        QVERIFY(room.window->isBaking());
        QSignalSpy ended(&room.panel(), &SweepPanel::ended);
        room.press("sweep.run");
        QCOMPARE(room.panel().stateText(), QString("Waits for the bake"));
        QTest::qWait(500);
        QVERIFY(room.window->isBaking() && room.panel().rows().empty());
        room.window->findChild<QSpinBox*>("compare.samples")->setValue(60'000);
        QTest::keyClick(room.window->viewport(), Qt::Key_R);
        actionNamed(*room.window, "Cancel")->trigger();
        QTRY_COMPARE(room.panel().stateText(), QString("Waits for the reference; R stops it"));
        QTest::qWait(500);
        QVERIFY(room.panel().rows().empty());
        QTest::keyClick(room.window->viewport(), Qt::Key_R);
        QTRY_VERIFY_WITH_TIMEOUT(!room.panel().rows().empty(), kPatience); // goes on by itself
        QElapsedTimer clock;
        clock.start();
        room.press("sweep.cancel");
        QVERIFY(ended.wait(kPatience));
        QVERIFY2(clock.elapsed() <= 1500, qPrintable(QString::number(clock.elapsed())));
        QVERIFY2(room.panel().stateText().startsWith("Stopped after "), qPrintable(room.panel().stateText()));
        QVERIFY(!room.panel().rows().empty() && room.panel().rows().size() < 4); // what was done stays

        room.press("sweep.run");
        QTest::qWait(700);
        QVERIFY(room.panel().isRunning());
        room.window->close();
        clock.restart();
        room.window.reset();
        qInfo("closed within %lld ms", clock.elapsed());
        QVERIFY(clock.elapsed() <= 1500);
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    SweepTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_sweep.moc"
