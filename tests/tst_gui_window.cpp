// SPDX-License-Identifier: Apache-2.0
// Claim: the window does its job when driven as a person would: it opens a scene, bakes by itself, refines in front of
// the user, orbits, dims a lamp without shooting photons, pauses, cancels, and closes at any time.
#include "core/base/units.h"
#include "core/compare/field_noise.h"
#include "core/octree/light_octree.h"
#include "gui_fixture.h"
#include "widgets/bake_bridge.h"
#include "widgets/bake_panel.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/message_bar.h"
#include "widgets/param_panel.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QApplication>
#include <QCheckBox>
#include <QDir>
#include <QDoubleSpinBox>
#include <QLabel>
#include <QMenu>
#include <QMouseEvent>
#include <QRegularExpression>
#include <QSignalSpy>
#include <QSlider>
#include <QToolButton>
#include <QtTest>
#include <functional>
#include <memory>

using namespace lightloom;
using namespace lightloom::test;

namespace {

const QString kCornell = sampleFile("cornell");

/// Mean colour of a small patch around a point given in fractions of the picture, as linear-ish 0 to 255.
struct Rgb {
    double r = 0, g = 0, b = 0;
    [[nodiscard]] double sum() const { return r + g + b; }
};
Rgb patch(const QImage& image, double x, double y)
{
    Rgb mean;
    const int size = 5;
    for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) {
            const QColor c = image.pixelColor(int(x * image.width()) + i - 2, int(y * image.height()) + j - 2);
            mean.r += c.red() / double(size * size);
            mean.g += c.green() / double(size * size);
            mean.b += c.blue() / double(size * size);
        }
    }
    return mean;
}

/// Pictures stay in the temporary folder, to be looked at when a check fails.
void keep(const QImage& image, const char* name) { image.save(QDir::temp().filePath(name)); }

double difference(const QImage& a, const QImage& b)
{
    if (a.size() != b.size()) return -1.0;
    double sum = 0.0;
    for (int y = 0; y < a.height(); y += 4) {
        for (int x = 0; x < a.width(); x += 4) sum += std::abs(qGray(a.pixel(x, y)) - qGray(b.pixel(x, y)));
    }
    return sum / (double(a.width() / 4) * (a.height() / 4));
}

} // namespace

class WindowTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void initTestCase()
    {
        const Result<Done> gl = probeGl();
        QVERIFY2(gl, gl ? "" : gl.error().message.c_str());
    }

    void picturesShowLightAndColourBleeding()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        Viewport& viewport = *window->viewport();
        QVERIFY(settle(viewport));
        QCOMPARE(window->snapshots().count(), 3); // a rough picture, depths 4 and 5
        const QImage lit = viewport.grabFramebuffer();
        keep(lit, "window-lit.png");
        // the box fills the picture's height; its width is about as much, in the middle
        const double half = 0.5 * lit.height() / lit.width();
        const auto at = [&](double x, double y) { return patch(lit, 0.5 + (x - 0.5) * 2.0 * half, y); };
        const Rgb lamp = at(0.5, 0.15), red = at(0.07, 0.45), green = at(0.93, 0.45), back = at(0.6, 0.35);
        QVERIFY2(lamp.sum() > 700.0, qPrintable(QString("lamp %1").arg(lamp.sum())));
        QVERIFY2(red.r > 2.0 * red.g && red.r > 60.0, qPrintable(QString("%1 %2 %3").arg(red.r).arg(red.g).arg(red.b)));
        QVERIFY2(green.g > 1.3 * green.r && green.g > 60.0,
                 qPrintable(QString("%1 %2 %3").arg(green.r).arg(green.g).arg(green.b)));
        QVERIFY(back.sum() > 240.0);
        const Rgb outside = patch(lit, 0.02, 0.5); // beside the box there is nothing
        QVERIFY2(std::abs(outside.r - outside.b) < 2.0 && outside.sum() < 150.0,
                 qPrintable(QString("background %1 %2 %3").arg(outside.r).arg(outside.g).arg(outside.b)));

        // indirect light alone: the tall block's left side sees the red wall, the short one's right side the green one
        viewport.setIndirectOnly(true);
        viewport.setExposure(1.0f);
        QVERIFY(settle(viewport));
        const QImage indirect = viewport.grabFramebuffer();
        keep(indirect, "window-indirect.png");
        const auto in = [&](double x, double y) { return patch(indirect, 0.5 + (x - 0.5) * 2.0 * half, y); };
        const Rgb nearRed = in(0.289, 0.66), nearGreen = in(0.753, 0.8), noLamp = in(0.5, 0.15);
        QVERIFY2(nearRed.r > 1.8 * nearRed.g, qPrintable(QString("%1 %2").arg(nearRed.r).arg(nearRed.g)));
        QVERIFY2(nearGreen.g > 1.2 * nearGreen.r, qPrintable(QString("%1 %2").arg(nearGreen.r).arg(nearGreen.g)));
        QVERIFY2(noLamp.sum() < 0.5 * lamp.sum(), "the lamp glows in indirect light");
        viewport.setIndirectOnly(false);

        // plain mode knows no shadows: the unlit front of the short block is as bright as its base colour
        viewport.setMode(ViewMode::plain);
        QVERIFY(settle(viewport));
        const QImage plain = viewport.grabFramebuffer();
        const Rgb front = patch(plain, 0.5 + (0.6 - 0.5) * 2.0 * half, 0.85);
        QVERIFY2(front.sum() > 300.0, qPrintable(QString::number(front.sum())));
    }

    void orbitingMovesThePictureCoarseThenFine()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        Viewport& viewport = *window->viewport();
        QVERIFY(settle(viewport));
        const QImage before = viewport.grabFramebuffer();
        QSignalSpy drawn(&viewport, &Viewport::frameDrawn);
        const glm::vec3 pivot = viewport.camera().pivot();
        drag(viewport, viewport.rect().center(), viewport.rect().center() + QPoint(60, 10));
        QVERIFY(glm::length(viewport.camera().pivot() - pivot) <= 1e-4f);
        QVERIFY(drawn.wait(5000));
        QCOMPARE(drawn.first().at(1).toBool(), false);
        QVERIFY(settle(viewport));
        QVERIFY(viewport.scale() == 1.0f);
        QVERIFY(difference(before, viewport.grabFramebuffer()) > 2.0);
        QTest::keyClick(&viewport, Qt::Key_F);
        QVERIFY(glm::length(viewport.camera().pivot() - window->scene()->bounds.centre()) <= 1e-3f);
    }

    void editingAParameterBakesAnew()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        auto* depth = window->findChild<QDoubleSpinBox*>("octree.depth");
        auto* reset = window->findChild<QToolButton*>("octree.depth.reset");
        QVERIFY(depth != nullptr && reset != nullptr);
        QVERIFY(depth->toolTip().contains("Range 1 to 10") && !depth->suffix().isEmpty());
        const QString depths = window->findChild<QLabel*>("depths")->text();
        QVERIFY2(depths.contains(QRegularExpression("Depth 5: [\\d.]+ m?s, [\\d.]+ CPU-s, [\\d,]+ entries")),
                 qPrintable(depths));
        QVERIFY(depth->font().bold()); // 5 is not the default
        QSignalSpy ended(window.get(), &MainWindow::bakeEnded);
        depth->setValue(4);
        QVERIFY(ended.wait(kPatience));
        QCOMPARE(window->snapshots().count(), 1); // depth 4 was there: nothing rough had to come before
        QCOMPARE(window->snapshots().shown()->snapshot.level, 4);
        QVERIFY(window->snapshots().shown()->snapshot.isFinal);
        reset->click();
        QCOMPARE(depth->value(), double(BakeParams{}.octreeDepth));
        QVERIFY(!depth->font().bold());
        // a first depth beyond the last is said in the message line, not baked
        window->findChild<QDoubleSpinBox*>("octree.first-depth")->setValue(9);
        QTRY_VERIFY_WITH_TIMEOUT(window->messages().text().contains("octree.first-depth=9"), 5000);
    }

    void dimmingShootsNothing()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        Viewport& viewport = *window->viewport();
        QVERIFY(settle(viewport));
        const QImage full = viewport.grabFramebuffer();
        const int shadows = viewport.shadowLayersDrawn();
        const auto before = window->snapshots().shown()->snapshot;
        QSignalSpy ended(window.get(), &MainWindow::bakeEnded);
        auto* slider = window->findChildren<QSlider*>(QRegularExpression("^gain\\..*")).value(0);
        QVERIFY(slider != nullptr);
        slider->setValue(25);
        QTRY_VERIFY_WITH_TIMEOUT(window->snapshots().shown()->snapshot.field != before.field, 10'000);
        QVERIFY(settle(viewport));
        const QImage dim = viewport.grabFramebuffer();
        QVERIFY(!window->isBaking());
        QCOMPARE(ended.count(), 0);
        QCOMPARE(viewport.shadowLayersDrawn(), shadows);
        QCOMPARE(window->snapshots().shown()->snapshot.serial, before.serial);
        QVERIFY2(difference(full, dim) > 10.0, "the picture did not get darker");
        // a quarter of the light in the field, to rounding
        const Scene& scene = *window->scene();
        const glm::vec3 p(scene.bounds.centre().x, scene.bounds.low.y, scene.bounds.centre().z), up(0, 1, 0);
        const float was = before.field->irradiance(p, up).y;
        const float is = window->snapshots().shown()->snapshot.field->irradiance(p, up).y;
        QVERIFY(was > 0.0f);
        QVERIFY(std::abs(is / was - 0.25f) <= 1e-5f);
        // off, and on again: still no bake, the layer is there
        auto* on = window->findChildren<QCheckBox*>(QRegularExpression("^lamp\\..*")).value(0);
        on->click();
        on->click();
        QVERIFY(!window->isBaking());
    }

    void pauseHoldsAndCancelKeepsThePicture()
    {
        const auto window = makeWindow();
        BakeParams params = smallBake();
        params.octreeDepth = 8;
        params.photonCount = 400'000;
        window->setParams(params);
        QSignalSpy shown(window.get(), &MainWindow::lightShown), ended(window.get(), &MainWindow::bakeEnded);
        window->openScene(kCornell);
        QVERIFY(shown.wait(kPatience));
        QTest::keyClick(window->viewport(), Qt::Key_Space);
        QVERIFY(window->isPaused());
        QTest::qWait(300); // blocks that run may end
        const auto count = shown.count();
        const double fraction = window->bakePanel().fraction();
        QTest::qWait(700);
        QCOMPARE(shown.count(), count);
        QCOMPARE(window->bakePanel().fraction(), fraction);
        QVERIFY(window->isBaking());
        QElapsedTimer clock;
        clock.start();
        QTest::keyClick(window->viewport(), Qt::Key_Escape);
        QVERIFY(ended.wait(kPatience));
        qInfo("cancelled after %lld ms", clock.elapsed());
        QCOMPARE(ended.first().first().toBool(), false);
        QVERIFY(!window->isPaused());
        QVERIFY(window->snapshots().shown() != nullptr && window->snapshots().shown()->gpu);
        QCOMPARE(window->bakePanel().stageText(), QString("Cancelled"));
    }

    void closingDuringABakeIsClean()
    {
        for (const bool isPaused : {false, true}) {
            auto window = makeWindow();
            BakeParams params = smallBake();
            params.octreeDepth = 8;
            params.photonCount = 400'000;
            window->setParams(params);
            QSignalSpy opened(window.get(), &MainWindow::sceneOpened);
            window->openScene(kCornell);
            QVERIFY(opened.wait(kPatience));
            QTest::qWait(150);
            if (isPaused) QTest::keyClick(window->viewport(), Qt::Key_Space);
            QVERIFY(window->isBaking());
            window->close();
            QElapsedTimer clock;
            clock.start();
            window.reset();
            qInfo("closed within %lld ms", clock.elapsed());
            QVERIFY(clock.elapsed() <= 3000);
        }
    }

    void aMissingFileIsSaidInTheMessageLine()
    {
        const auto window = makeWindow();
        QSignalSpy failed(window.get(), &MainWindow::openFailed);
        window->openScene("no/such/scene.glb");
        QVERIFY(failed.wait(kPatience));
        QVERIFY(window->messages().isVisible());
        QVERIFY2(window->messages().text().contains("scene.glb"), qPrintable(window->messages().text()));
        QVERIFY(!window->isBaking() && !window->scene());
        QVERIFY(openAndBake(*window)); // and the window works on
    }

    void theBakeTellsWhereLightWentAndItsOwnNoise()
    {
        const auto window = makeWindow();
        QVERIFY(window->bakePanel().lightText().isEmpty());
        QVERIFY(openAndBake(*window));
        static const QRegularExpression wanted(
            "^Light: ([\\d.,]+) lm emitted, ([\\d.]+) % absorbed, ([\\d.]+) % escaped, ([\\d.]+) % cut off, "
            "nothing missing$");
        const QString light = window->bakePanel().lightText();
        const auto match = wanted.match(light);
        QVERIFY2(match.hasMatch(), qPrintable(light));
        double emitted = 0.0;
        for (const Emitter& e : window->snapshots().shown()->lights->emitters()) emitted += double(luminance(e.flux));
        QVERIFY2(std::abs(QLocale().toDouble(match.captured(1)) / emitted - 1.0) <= 1e-3, qPrintable(light));
        double shares = 0.0;
        for (int i = 2; i <= 4; ++i) shares += match.captured(i).toDouble();
        QVERIFY2(std::abs(shares - 100.0) <= 0.11, qPrintable(light)); // each is rounded
        QVERIFY(match.captured(3).toDouble() > 10.0);                  // the box is open

        // the noise is the one that the command line states for the same bake
        const BakeView& view = *window->snapshots().shown();
        const auto again = bakeOctree(window->scene(), smallBake());
        QVERIFY(again);
        const auto rays = RayScene::build(window->scene());
        const LightSampler lights(*rays);
        Workers workers;
        const auto reach = LightReach::find(**rays, lights, workers, {});
        const auto noise = statedNoise(*again, samplePoints(**rays, lights, *reach, 1000, 1));
        QVERIFY(noise && view.noise && *noise > 0.0);
        QCOMPARE(*view.noise, *noise);
        QCOMPARE(window->bakePanel().noiseText(),
                 QString("Noise: %1 % of the mean, stated by the bake").arg(100.0 * *noise, 0, 'f', 1));
        QVERIFY(view.cpuSeconds > 0.0);
        window->snapshots().findChildren<QToolButton*>().first()->click(); // rough: no statement
        QCOMPARE(window->bakePanel().noiseText(), QString("Noise: not known"));
    }

    void olderSnapshotsCanBeLookedAt()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        const auto buttons = window->snapshots().findChildren<QToolButton*>();
        QCOMPARE(buttons.size(), 3);
        QCOMPARE(window->snapshots().shown()->snapshot.level, 5);
        buttons[1]->click();
        QCOMPARE(window->snapshots().shown()->snapshot.level, 4);
        QVERIFY(!window->snapshots().shown()->snapshot.isRough);
        buttons.first()->click();
        QVERIFY(window->snapshots().shown()->snapshot.isRough);
        QVERIFY(settle(*window->viewport()));
    }

    void everyCommandIsInAMenu()
    {
        const auto window = makeWindow();
        QSet<QAction*> inMenus;
        for (QMenu* menu : window->findChildren<QMenu*>()) {
            for (QAction* action : menu->actions()) inMenus.insert(action);
        }
        int shortcuts = 0;
        for (QAction* action : window->findChildren<QAction*>(QString(), Qt::FindDirectChildrenOnly)) {
            if (action->shortcut().isEmpty()) continue;
            ++shortcuts;
            QVERIFY2(inMenus.contains(action), qPrintable(action->text()));
        }
        QVERIFY(shortcuts >= 12);
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    WindowTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_window.moc"
