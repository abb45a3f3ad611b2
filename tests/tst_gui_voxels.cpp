// SPDX-License-Identifier: Apache-2.0
// Claim: key 3 shows voxel radiosity: the voxel field at once, then, while the view rests, a picture by lightcuts in
// blocks of pixels that get smaller; another view, another mix or another lookup begin anew at once; what is measured
// is what is shown; the panel is about voxels.
#include "core/base/image.h"
#include "core/compare/false_colour.h"
#include "core/voxel/voxel_cuts.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/legend_strip.h"
#include "widgets/param_panel.h"
#include "widgets/picture_desk.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QApplication>
#include <QSlider>

using namespace lightloom;
using namespace lightloom::test;

class GuiVoxelsTest : public QObject {
    Q_OBJECT

    std::unique_ptr<MainWindow> window_;
    Viewport* viewport_ = nullptr;

    void press(Qt::Key key, Qt::KeyboardModifiers modifiers = {}) const
    {
        viewport_->setFocus();
        QTest::keyClick(viewport_, key, modifiers);
    }
    [[nodiscard]] bool awaitText(const QString& part) const
    {
        return QTest::qWaitFor([&] { return window_->pictureDesk()->stateText().contains(part); }, kPatience);
    }
    [[nodiscard]] const BakeParams& params() const { return window_->findChild<ParamPanel*>()->params(); }
    void useLookup(VoxelLookup lookup) const
    {
        BakeParams changed = params();
        changed.voxelLookup = lookup;
        window_->setParams(changed);
    }

private Q_SLOTS:
    void initTestCase()
    {
        window_ = makeWindow();
        window_->resize(700, 520);
        BakeParams quick = smallBake();
        quick.voxelSize = 32;
        quick.voxelDirections = 128;
        quick.voxelRays = 8;
        quick.voxelThreshold = 0.1f;
        quick.voxelNear = 16;
        window_->setParams(quick);
        QVERIFY(openAndBake(*window_));
        viewport_ = window_->viewport();
        QVERIFY(viewport_);
    }

    void keyThreeBakesVoxels()
    {
        const auto isThere = [&] {
            const BakeView* view = window_->snapshots().shown();
            return view && view->isVoxels() && view->snapshot.isFinal;
        };
        QSignalSpy ended(window_.get(), &MainWindow::bakeEnded);
        press(Qt::Key_3);
        QCOMPARE(viewport_->mode(), ViewMode::lightcuts);
        QVERIFY(QTest::qWaitFor(isThere, kPatience));
        const BakeView& view = *window_->snapshots().shown();
        QVERIFY(view.gpu && !view.gpuGrid && view.problem.isEmpty());
        QCOMPARE(shortName(view), QString("N %1").arg(params().voxelSize));
        QVERIFY(window_->findChild<QWidget*>("voxel.size") && !window_->findChild<QWidget*>("photons"));
    }

    void lightcutsComeInBlocks()
    {
        QVERIFY(QTest::qWaitFor([&] { return viewport_->hasMadePicture(); }, kPatience));
        PictureDesk& desk = *window_->pictureDesk();
        QVERIFY(dynamic_cast<const VoxelCuts*>(desk.field().get()));
        QVERIFY(desk.stateText().contains("Lightcuts"));
        QVERIFY(awaitText("16 of 16"));
        QVERIFY(settle(*viewport_));
        const QImage cuts = viewport_->grabFramebuffer();
        useLookup(VoxelLookup::field);
        QVERIFY(QTest::qWaitFor([&] { return !viewport_->hasMadePicture(); }, kPatience));
        QVERIFY(settle(*viewport_));
        const QImage field = viewport_->grabFramebuffer();
        const double apart = meanDifference(cuts, field);
        qInfo("lightcuts and field: %.2f of 255 apart", apart);
        QVERIFY(apart > 0.1 && apart < 12.0);
        QVERIFY(desk.stateText().contains("Voxel field"));
    }

    void cutSizesAreShownWithTheirLegend()
    {
        useLookup(VoxelLookup::lightcuts);
        QVERIFY(awaitText("16 of 16"));
        const QImage light = settle(*viewport_) ? viewport_->grabFramebuffer() : QImage();
        press(Qt::Key_5, Qt::ControlModifier);
        QAction* cuts = actionNamed(*window_, "Cut sizes");
        QVERIFY(cuts->isChecked() && awaitText("Clusters in a cut"));
        const LegendStrip& legend = window_->legend();
        QVERIFY(legend.isVisible() && legend.caption() == window_->pictureDesk()->stateText());
        const QStringList ticks = legend.ticks();
        QVERIFY2(ticks.first() == "0" && ticks.last().toDouble() > 20.0, qPrintable(ticks.join(' ')));
        const auto field = std::dynamic_pointer_cast<const VoxelCuts>(window_->pictureDesk()->field());
        QVERIFY(field && settle(*viewport_));
        const QImage shown = viewport_->grabFramebuffer();
        int checked = 0, off = 0;
        for (int y = 40; y < shown.height() - 40; y += 24) {
            for (int x = 40; x < shown.width() - 40; x += 24) {
                const auto at = viewport_->surfaceAt({x + 0.5, y + 0.5});
                if (!at) continue;
                const int nodes = field->cutAt(at->position, at->normal).nodes;
                const glm::vec3 wanted = falseColour(float(nodes) / float(ticks.last().toDouble()));
                const double grey = 255.0 * double(encodeSrgb(wanted.y)); // green rises all the way
                ++checked;
                off += std::abs(qGreen(shown.pixel(x, y)) - grey) > 20.0 ? 1 : 0; // where it looks is rounded
            }
        }
        qInfo("%d of %d places have another colour", off, checked);
        QVERIFY(checked > 100 && off <= checked / 20);
        press(Qt::Key_1, Qt::ControlModifier);
        QVERIFY(settle(*viewport_) && meanDifference(viewport_->grabFramebuffer(), light) < 1.0);
        cuts->trigger();
        useLookup(VoxelLookup::field); // has no cuts
        QVERIFY(!cuts->isEnabled() && !cuts->isChecked());
        QVERIFY(actionNamed(*window_, "Light")->isChecked() && legend.ticks().isEmpty());
    }

    void anotherViewBeginsAnewAtOnce()
    {
        useLookup(VoxelLookup::lightcuts);
        QVERIFY(QTest::qWaitFor([&] { return viewport_->hasMadePicture(); }, kPatience));
        drag(*viewport_, {200, 200}, {260, 210});
        QVERIFY(!viewport_->hasMadePicture()); // the field meanwhile
        QVERIFY(QTest::qWaitFor([&] { return viewport_->hasMadePicture(); }, kPatience));
    }

    void dimmedLampsBakeNothing()
    {
        PictureDesk& desk = *window_->pictureDesk();
        const auto before = desk.field();
        QVERIFY(before);
        const std::uint64_t serial = window_->snapshots().shown()->snapshot.serial;
        const glm::vec3 p = window_->scene()->bounds.centre();
        const float full = before->irradiance(p, glm::vec3(0, 1, 0)).y;
        auto* slider = window_->sceneDock().findChild<QSlider*>();
        QVERIFY(slider);
        slider->setValue(50);
        QVERIFY(QTest::qWaitFor([&] { return desk.field() && desk.field() != before; }, kPatience));
        QVERIFY(std::abs(desk.field()->irradiance(p, glm::vec3(0, 1, 0)).y / full - 0.5f) <= 1e-3f);
        QCOMPARE(window_->snapshots().shown()->snapshot.serial, serial);
        slider->setValue(100);
    }

    void samplesAreChosenByCommand()
    {
        actionNamed(*window_, "Sample voxels")->trigger();
        QCOMPARE(params().voxelLookup, VoxelLookup::samples);
        QVERIFY(awaitText("Sample voxels"));
        QVERIFY(QTest::qWaitFor([&] { return viewport_->hasMadePicture(); }, kPatience));
        actionNamed(*window_, "Field")->trigger();
        QVERIFY(QTest::qWaitFor([&] { return !viewport_->hasMadePicture(); }, kPatience));
        press(Qt::Key_1);
        QVERIFY(window_->findChild<QWidget*>("photons"));
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    QApplication::setApplicationName("lightloom");
    GuiVoxelsTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_voxels.moc"
