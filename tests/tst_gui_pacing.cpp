// SPDX-License-Identifier: Apache-2.0
// Claim: while a bake runs and nothing moves, polishing pictures leave most of the time to it; news is coarse first
// where a full picture is dear; a fast machine notices none of it; and when the bake is done the picture sharpens.
#include "widgets/frame_pacer.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/main_window.h"
#include "widgets/viewport.h"
#include <QApplication>
#include <QSignalSpy>
#include <QtTest>

using namespace lightloom;

namespace {
const QString kScene = QStringLiteral(LIGHTLOOM_SOURCE_DIR "/sample_scenes/two_rooms.glb");
} // namespace

class PacingTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void withoutABakeNothingWaits()
    {
        FramePacer pacer;
        pacer.drew(1.0f, false, 900.0, 950.0);
        QCOMPARE(pacer.pauseMs(), 1);
        QVERIFY(!pacer.showsNewsCoarse());
    }

    void polishingTakesASmallShare()
    {
        FramePacer pacer;
        pacer.setBusy(true);
        for (const double ms : {3.0, 40.0, 200.0, 500.0}) {
            pacer.drew(1.0f, false, ms, ms);
            const double share = ms / (ms + pacer.pauseMs());
            QVERIFY2(share <= 0.17, qPrintable(QString("%1 ms: %2").arg(ms).arg(share)));
        }
    }

    void onlyDearOrUnknownPicturesAreCoarseFirst()
    {
        FramePacer pacer;
        pacer.setBusy(true);
        QVERIFY(pacer.showsNewsCoarse()); // nothing is known
        pacer.drew(0.5f, true, 1.0, 1.0);
        QVERIFY(!pacer.showsNewsCoarse()); // 4 ms at full resolution
        pacer.drew(0.5f, true, 30.0, 30.0);
        QVERIFY(pacer.showsNewsCoarse()); // 120 ms
        QVERIFY(pacer.sharpenMs() >= 500);
        pacer.forget();
        QVERIFY(pacer.showsNewsCoarse());
        pacer.setBusy(false);
        QCOMPARE(pacer.sharpenMs(), 1);
    }

    void coarseScaleKeepsToAFrame()
    {
        FramePacer pacer; // a machine that takes 1 s for a full picture, and one that takes 4 ms
        for (int i = 0; i < 30; ++i) {
            pacer.drew(pacer.coarseScale(), true, 1000.0 * double(pacer.coarseScale() * pacer.coarseScale()), 0.0);
        }
        QCOMPARE(pacer.coarseScale(), FramePacer::kCoarsest);
        for (int i = 0; i < 30; ++i) {
            pacer.drew(pacer.coarseScale(), true, 4.0 * double(pacer.coarseScale() * pacer.coarseScale()), 0.0);
        }
        QCOMPARE(pacer.coarseScale(), 1.0f);
    }

    /// Driven as a person would: with a bake that runs, pictures are few; after it all eight samples come.
    void theWindowLeavesTimeToTheBake()
    {
        const Result<Done> gl = probeGl();
        QVERIFY2(gl, gl ? "" : gl.error().message.c_str());
        MainWindow window(nullptr);
        window.show();
        QSignalSpy drawn(window.viewport(), &Viewport::frameDrawn), ended(&window, &MainWindow::bakeEnded);
        QElapsedTimer clock;
        clock.start();
        window.openScene(kScene);
        QVERIFY(ended.wait(120'000));
        const double baking = double(clock.elapsed());
        double drawing = 0.0;
        for (const QList<QVariant>& picture : drawn) drawing += picture.first().toDouble();
        // news is drawn at once: a coarse picture each for the scene, its shadow maps and the snapshots; those are
        // 50 ms or so each. The rest is polishing.
        const double news = 10.0 * drawing / double(drawn.count());
        QVERIFY2(drawing <= news + 0.2 * baking,
                 qPrintable(QString("%1 pictures took %2 of %3 ms").arg(drawn.count()).arg(drawing).arg(baking)));
        QTRY_VERIFY_WITH_TIMEOUT(window.viewport()->isSettled(), 60'000);
        QCOMPARE(window.viewport()->scale(), 1.0f);
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    PacingTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_pacing.moc"
