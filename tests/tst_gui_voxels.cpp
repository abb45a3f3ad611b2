// SPDX-License-Identifier: Apache-2.0
// Claim: key 3 shows voxel radiosity: the voxel field at once, then, while the view rests, a picture by lightcuts in
// blocks of pixels that get smaller; another view, another mix or another lookup begin anew at once; what is measured
// is what is shown; the panel is about voxels. A click looks into a voxel. Cut sizes and the voxels themselves are
// shown in false colour, with legends.
#include "core/base/image.h"
#include "core/base/units.h"
#include "core/compare/false_colour.h"
#include "core/voxel/voxel_cuts.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/legend_strip.h"
#include "widgets/param_panel.h"
#include "widgets/pick_card.h"
#include "widgets/pick_desk.h"
#include "widgets/picture_desk.h"
#include "widgets/picture_worker.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "widgets/voxel_panel.h"
#include "window_helpers.h"
#include <QApplication>
#include <QSlider>
#include <QSpinBox>

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
        QVERIFY(desk.isDone());
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

    /// Edges have several camera rays a pixel while light is in blocks of two pixels, and never fewer afterwards.
    void edgesAreSmoothBeforeEachPixelHasItsLight()
    {
        const BakeView& view = *window_->snapshots().shown();
        ViewJob job{window_->scene()->cameras.front(), 96, 64};
        job.indirect = ViewJob::Indirect::field;
        job.samples = 16;
        VoxelShow show = voxelShow(params());
        show.lookup = VoxelLookup::lightcuts;
        PictureWorker worker;
        std::vector<MadePicture> pictures;
        connect(&worker, &PictureWorker::shown, this, [&](const MadePicture& p) { pictures.push_back(p); });
        std::vector<double> parts;
        connect(&worker, &PictureWorker::workedOn, this, [&](std::uint64_t, double part) { parts.push_back(part); });
        worker.ask({nullptr, std::dynamic_pointer_cast<const VoxelField>(view.snapshot.field), show, view.rays,
                    view.lights, job});
        const auto isWhole = [&] {
            return !pictures.empty() && pictures.back().block == 1 && pictures.back().view->isWhole;
        };
        QVERIFY(QTest::qWaitFor(isWhole, kPatience));
        int smooth = 0;
        for (std::size_t i = 1; i < pictures.size(); ++i) {
            const MadePicture &before = pictures[i - 1], &now = pictures[i];
            QVERIFY(now.block <= before.block && before.block <= 2 * now.block);
            if (now.block < before.block) QVERIFY(before.view->isWhole);
            QVERIFY(now.view->samples >= 4);
            smooth += now.block == 2 && now.view->samples == 8 ? 1 : 0;
        }
        QCOMPARE(pictures.front().block, 8);
        QCOMPARE(smooth, 1);
        for (const double part : parts) QVERIFY(part > 0.0 && part <= 1.0);
        QVERIFY(std::ranges::is_sorted(parts));
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
        QVERIFY(!window_->pictureDesk()->isDone());
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
        const auto isFull = [&] {
            return desk.field() && std::abs(desk.field()->irradiance(p, glm::vec3(0, 1, 0)).y / full - 1.0f) <= 1e-3f;
        };
        QVERIFY(QTest::qWaitFor(isFull, kPatience)); // the next test begins with it
    }

    void voxelsAreMarked_data()
    {
        QTest::addColumn<QString>("command");
        QTest::addColumn<QString>("legend");
        QTest::newRow("radiosity") << "Voxels by radiosity"
                                   << "lm/m";
        QTest::newRow("area") << "Voxels by area"
                              << "of a face";
        QTest::newRow("normal") << "Voxels by normal"
                                << "green +y";
    }
    /// Discs lie on the surface that is seen, in the colour of the entry there.
    void voxelsAreMarked()
    {
        QFETCH(QString, command);
        QFETCH(QString, legend);
        useLookup(VoxelLookup::field);
        actionNamed(*window_, command)->trigger();
        const auto discs = [&] { return window_->snapshots().shown()->discs; };
        QVERIFY(QTest::qWaitFor([&] { return window_->legend().caption().contains(legend) && discs(); }, kPatience));
        const auto* field = dynamic_cast<const VoxelField*>(window_->snapshots().shown()->snapshot.field.get());
        QCOMPARE(discs()->discs.size(), field->surface().leaves->entries.size());
        QVERIFY(settle(*viewport_));
        const QImage shown = viewport_->grabFramebuffer();
        int seen = 0, off = 0;
        for (std::size_t e = 0; e < discs()->discs.size(); e += 7) {
            const VoxelDiscs::Disc& disc = discs()->discs[e];
            QVERIFY(std::abs(disc.radius * disc.radius * kPi / field->surface().leaves->entries[e].area - 1.0f) <
                    1e-3f);
            const auto at = viewport_->placeIn(disc.centre);
            if (!at || !viewport_->rect().adjusted(9, 9, -9, -9).contains(at->toPoint())) continue;
            const auto surface = viewport_->surfaceAt(*at);
            const bool isThere = surface && glm::length(surface->position - disc.centre) < 0.3f * discs()->cellSize &&
                                 glm::dot(surface->normal, disc.normal) > 0.95f &&
                                 disc.radius > 0.5f * discs()->cellSize;
            if (!isThere) continue; // hidden, or beside other entries
            ++seen;
            const QRgb pixel = shown.pixel(at->toPoint());
            const int apart = std::max({std::abs(qRed(pixel) - disc.colour.x), std::abs(qGreen(pixel) - disc.colour.y),
                                        std::abs(qBlue(pixel) - disc.colour.z)});
            off += apart > 40 ? 1 : 0; // they are a little clear, and below white
        }
        qInfo("%d of %d discs have another colour", off, seen);
        QVERIFY(seen > 100 && off <= seen / 10); // at edges discs of nearer surface reach over them
        QVERIFY(window_->snapshots().shown()->snapshot.field.get() == field); // pictures of it go on
        actionNamed(*window_, "No voxels")->trigger();
        QVERIFY(QTest::qWaitFor([&] { return !discs(); }, kPatience));
        QVERIFY(!window_->legend().caption().contains(legend));
    }

    /// The spin box draws a direction's lines over the picture; none takes them away.
    void linesOfADirectionAreDrawn()
    {
        useLookup(VoxelLookup::field);
        auto* panel = window_->findChild<VoxelPanel*>();
        auto* number = window_->findChild<QSpinBox*>("voxel.lines");
        QVERIFY(panel && panel->isVisible() && number->maximum() == params().voxelDirections - 1);
        QVERIFY(settle(*viewport_));
        const QImage before = viewport_->grabFramebuffer();
        number->setValue(3);
        QVERIFY(QTest::qWaitFor([&] { return panel->aboutText().contains("pairs"); }, kPatience));
        QVERIFY(settle(*viewport_));
        const double apart = meanDifference(viewport_->grabFramebuffer(), before);
        const QString about = panel->aboutText();
        qInfo("%.2f of 255 apart; %s", apart, qPrintable(about));
        QVERIFY(apart > 1.0);
        number->setValue(4);
        QVERIFY(QTest::qWaitFor([&] { return panel->aboutText() != about; }, kPatience));
        number->setValue(-1);
        QVERIFY(panel->aboutText().isEmpty() && settle(*viewport_));
        QVERIFY(meanDifference(viewport_->grabFramebuffer(), before) < 0.5);
    }

    /// A click tells of the voxel what the field and the cut there say.
    void aClickLooksIntoAVoxel()
    {
        useLookup(VoxelLookup::lightcuts);
        QVERIFY(QTest::qWaitFor([&] { return viewport_->hasMadePicture(); }, kPatience));
        window_->viewport()->useCamera(window_->scene()->cameras.front());
        PickDesk& desk = *window_->pickDesk();
        const QPoint floor(viewport_->width() / 3, viewport_->height() * 9 / 10);
        QTest::mouseClick(viewport_, Qt::LeftButton, Qt::AltModifier, floor);
        const auto hasCut = [&] { return desk.picked() && desk.picked()->voxel && desk.picked()->voxel->cut; };
        QVERIFY(QTest::qWaitFor(hasCut, kPatience));
        const LeafPick& leaf = *desk.picked()->leaf;
        const PickedVoxel& voxel = *desk.picked()->voxel;
        const auto cuts = std::dynamic_pointer_cast<const VoxelCuts>(desk.picked()->field);
        QVERIFY(cuts && leaf.answers >= 0);
        QCOMPARE(voxel.cells, params().voxelSize);
        QCOMPARE(voxel.entries.size(), leaf.entries.size());
        const Lightcut cut = cuts->cutAt(leaf.point, leaf.normal);
        QVERIFY(voxel.cut->nodes == cut.nodes && voxel.cut->illuminance == cut.illuminance);
        QVERIFY(cut.largestBound <= voxel.asked.threshold * luminance(cut.illuminance) * 1.001f);
        // the arrows of the entry that answers bring the cut's light
        const PickedEntry& entry = leaf.entries[std::size_t(leaf.answers)];
        glm::vec3 sum(0.0f);
        for (const Vdl& vdl : entry.lights) sum += vdl.colour * glm::max(0.0f, glm::dot(leaf.normal, vdl.toLight));
        QVERIFY(entry.lights.size() > 1 && entry.lights.size() <= 8);
        QVERIFY(glm::length(sum / cut.illuminance - 1.0f) <= 0.02f);
        const PickedVoxel::Entry& light = voxel.entries[std::size_t(leaf.answers)];
        QVERIFY(luminance(light.indirect) > 0.0f && luminance(light.direct) > 0.0f);
        QVERIFY(luminance(light.radiosity) < luminance(light.direct + light.indirect));
        QVERIFY(glm::length(entry.lux - light.indirect) <= 1e-4f * glm::length(entry.lux));
        const QString text = desk.card().lines().join('\n');
        // what the cut is off by, against all voxels one by one
        const double every = double(luminance(voxel.everyLight)), mine = double(luminance(cut.illuminance));
        QVERIFY(every > 0.0 && std::abs(mine / every - 1.0) <= 3.0 * double(voxel.asked.threshold));
        QCOMPARE(voxel.everyLight, cuts->everyLightAt(leaf.point, leaf.normal));
        const QString off = QLocale().toString(100.0 * std::abs(mine / every - 1.0), 'f', 1);
        QVERIFY2(text.contains("the cut is off by " + off + " %") && text.contains("Usual are 6.0 to 14.0 %"),
                 qPrintable(text));
        for (const char* part : {"Voxel", "lightcut of", "shadow rays", "by the field", "Entry 1", "lm/m"})
            QVERIFY2(text.contains(part), qPrintable(text));
        QCOMPARE(desk.card().labels().size(), entry.lights.size());
        useLookup(VoxelLookup::samples);
        QVERIFY(QTest::qWaitFor([&] { return desk.card().lines().join(' ').contains("at random"); }, kPatience));
        useLookup(VoxelLookup::field);
        QVERIFY(QTest::qWaitFor([&] { return !desk.card().lines().join(' ').contains("at random"); }, kPatience));
        QVERIFY(desk.card().lines()[0].contains("Voxel") && desk.card().labels().empty());
        actionNamed(*window_, "Pick a cell")->trigger();
        QVERIFY(!desk.picked());
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
