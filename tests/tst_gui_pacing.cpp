// SPDX-License-Identifier: Apache-2.0
// Claim: while a bake runs and nothing moves, polishing pictures leave most of the time to it; news is coarse first
// where a full picture is dear; a fast machine notices none of it; and when the bake is done the picture sharpens,
// while events are answered.
#include "widgets/frame_pacer.h"
#include "widgets/gl/gl_probe.h"
#include "window_helpers.h"
#include <QApplication>
#include <algorithm>

using namespace lightloom;
using namespace lightloom::test;

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

    /// A full picture is drawn in strips where it is dear: none of its eight holds up the events for long.
    void eventsAreAnsweredWhileThePictureSharpens()
    {
        const auto window = makeWindow();
        window->resize(1280, 800);
        QVERIFY(openAndBake(*window, kScene));
        Viewport& viewport = *window->viewport();
        QVERIFY(settle(viewport));
        QElapsedTimer beat, whole;
        std::vector<double> pauses;
        QTimer timer;
        connect(&timer, &QTimer::timeout, &timer, [&] {
            pauses.push_back(static_cast<double>(beat.nsecsElapsed()) * 1e-6);
            beat.start();
        });
        QSignalSpy drawn(&viewport, &Viewport::frameDrawn);
        timer.start(1);
        beat.start(), whole.start();
        drag(viewport, viewport.rect().center(), viewport.rect().center() + QPoint(20, 3));
        QVERIFY(settle(viewport));
        const double longest = std::ranges::max(pauses), picture = viewport.frameMs();
        qInfo("settled after %lld ms, %zu turns, longest pause %.0f ms, %d pictures, the last took %.0f ms",
              whole.elapsed(), pauses.size(), longest, int(drawn.count()), picture);
        QVERIFY(drawn.count() >= 9);
        // a strip, a coarse picture, or a whole one shown, with the window around it
        QVERIFY2(longest <= std::max(150.0, 0.4 * picture), qPrintable(QString::number(longest)));
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
