// SPDX-License-Identifier: Apache-2.0
// Claim: the window holds its picture against the truth as a person would: it traces a reference of what the camera
// sees while no bake runs, shows it pixel by pixel, draws the error in false colour that exposure does not touch, and
// wipes between both. Whatever runs, the window closes at once.
#include "core/base/units.h"
#include "widgets/compare_desk.h"
#include "widgets/compare_panel.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/legend_strip.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "widgets/wipe_handle.h"
#include "window_helpers.h"
#include <QApplication>
#include <QComboBox>
#include <QDir>
#include <QMenu>
#include <QRegularExpression>
#include <QSlider>
#include <QSpinBox>
#include <QToolButton>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// How the pixels of a picture differ from what is expected of them, in steps of 255.
struct PixelCheck {
    int checked = 0, off = 0; ///< off: by more than one step, which rounding may be
    int worst = 0;
    void add(QRgb shown, const std::uint8_t* expected)
    {
        const int d = std::max({std::abs(qRed(shown) - expected[0]), std::abs(qGreen(shown) - expected[1]),
                                std::abs(qBlue(shown) - expected[2])});
        ++checked;
        off += d > 1 ? 1 : 0;
        worst = std::max(worst, d);
    }
    /// Where meshes meet, the rasteriser may leave one of its eight samples of a pixel open.
    [[nodiscard]] bool isFine(int atLeast) const { return checked > atLeast && off <= checked / 10'000; }
    [[nodiscard]] QString text() const
    {
        return QString("%1 of %2 pixels are off, by %3 at worst").arg(off).arg(checked).arg(worst);
    }
};

std::uint8_t byteOf(float linear) { return std::uint8_t(std::lround(255.0f * encodeSrgb(linear))); }

/// Pixels that are covered all over: what lies around them is lit too.
bool isInside(const FloatImage& picture, int x, int y)
{
    if (x < 1 || y < 1 || x + 1 >= picture.width || y + 1 >= picture.height) return false;
    for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
            if (!(luminance(picture.at(x + i, y + j)) > 0.0f)) return false;
        }
    }
    return true;
}

/// A picture of light against what core makes of the same radiance; columns from `left` to `right` only.
PixelCheck lightCheck(const QImage& shown, const FloatImage& radiance, float ev, int left, int right)
{
    const ByteImage expected = onScreen(radiance, ev);
    PixelCheck check;
    for (int y = 0; y < radiance.height; ++y) {
        for (int x = left; x < right; ++x) {
            if (isInside(radiance, x, y))
                check.add(shown.pixel(x, y),
                          expected.rgb.data() + 3 * (std::size_t(y) * std::size_t(radiance.width) + std::size_t(x)));
        }
    }
    return check;
}

PixelCheck heatCheck(const QImage& shown, const ViewError& error)
{
    PixelCheck check;
    for (int y = 0; y < error.map.height; ++y) {
        for (int x = 0; x < error.map.width; ++x) {
            const float value = error.map.values[std::size_t(y) * std::size_t(error.map.width) + std::size_t(x)];
            const glm::vec3 c = errorColour(error.kind, value, error.top);
            const std::uint8_t bytes[] = {byteOf(c.x), byteOf(c.y), byteOf(c.z)};
            check.add(shown.pixel(x, y), bytes);
        }
    }
    return check;
}

constexpr float kEv = 3.0f;

/// A window on a scene of its own folder, baked; a reference takes a few seconds.
struct Room {
    explicit Room(const QString& file) : window(makeWindow())
    {
        window->resize(860, 520);
        window->findChild<QSpinBox*>("compare.samples")->setValue(8);
        isBaked = openAndBake(*window, file);
        viewport().setExposure(kEv);
        viewport().setFocus();
    }
    Viewport& viewport() { return *window->viewport(); }
    CompareDesk& desk() { return *window->compareDesk(); }
    void press(Qt::Key key, Qt::KeyboardModifiers modifiers = {}) { QTest::keyClick(&viewport(), key, modifiers); }
    bool waitForReference()
    {
        return QTest::qWaitFor(
            [&] { return desk().reference() && desk().reference()->view->isWhole && !desk().reference()->isRough; },
            kPatience);
    }
    /// Of the whole reference, by the finished picture of the bake.
    bool waitForErrors(ErrorKind kind)
    {
        return waitForReference() &&
               QTest::qWaitFor([&] { return desk().errors() && desk().errors()->kind == kind && isJudgedWholly(); },
                               kPatience);
    }
    bool isJudgedWholly() // nothing has come for a while
    {
        const auto before = desk().errors();
        QTest::qWait(700);
        return desk().errors() == before;
    }
    QImage grab() { return settle(viewport()) ? viewport().grabFramebuffer() : QImage(); }

    std::unique_ptr<MainWindow> window;
    bool isBaked = false;
};

} // namespace

class CompareTest : public QObject {
    Q_OBJECT
    OwnScene scene_{"cornell"};

private Q_SLOTS:
    void initTestCase()
    {
        const Result<Done> gl = probeGl();
        QVERIFY2(gl, gl ? "" : gl.error().message.c_str());
    }

    void theReferenceGrowsAndIsShownPixelByPixel()
    {
        Room room(scene_.file());
        QVERIFY(room.isBaked);
        QVERIFY(!room.desk().reference());
        std::vector<int> samples;
        connect(&room.desk(), &CompareDesk::referenceShown, &room.desk(), [&] {
            const ReferencePicture& p = *room.desk().reference();
            samples.push_back(p.isRough ? 0 : p.view->samples);
        });
        room.press(Qt::Key_R);
        QVERIFY(room.waitForReference());
        QVERIFY2(samples.size() >= 2 && samples.front() == 0 && samples.back() == 8, "not coarse to fine");
        QVERIFY(std::is_sorted(samples.begin(), samples.end()));
        const ReferencePicture reference = *room.desk().reference();
        QVERIFY(!reference.wasStored && reference.noise > 0.0);
        QVERIFY2(room.window->comparePanel().stateText().startsWith("Done: 8 rays per pixel, noise "),
                 qPrintable(room.window->comparePanel().stateText()));

        const QImage octree = room.grab();
        room.press(Qt::Key_4);
        QVERIFY(room.viewport().mode() == ViewMode::reference && room.window->legend().isVisible());
        const QImage shown = room.grab();
        const FloatImage whole = wholeView(*reference.view);
        QCOMPARE(shown.size(), QSize(whole.width, whole.height));
        PixelCheck check = lightCheck(shown, whole, kEv, 0, whole.width);
        QVERIFY2(check.isFine(20'000), qPrintable(check.text()));
        check = lightCheck(octree, whole, kEv, 0, whole.width); // noise: another picture would be noticed
        QVERIFY2(check.off > check.checked / 2, qPrintable(check.text()));
        room.press(Qt::Key_I);
        check = lightCheck(room.grab(), reference.view->indirect, kEv, 0, whole.width);
        QVERIFY2(check.isFine(20'000), qPrintable(check.text()));
    }

    void theNextTimeItIsThere()
    {
        Room room(scene_.file()); // the same view as before
        room.press(Qt::Key_4);    // asks for it
        QVERIFY(room.waitForReference());
        QVERIFY(room.desk().reference()->wasStored);
        QVERIFY(room.window->comparePanel().stateText().startsWith("Done, from disk"));
        QVERIFY(QDir(scene_.file() + ".lightloom-cache").exists());
    }

    void anotherViewOrOtherLampsBeginAnew()
    {
        Room room(scene_.file());
        room.press(Qt::Key_R);
        QVERIFY(room.waitForReference());
        const auto before = *room.desk().reference();
        drag(room.viewport(), {120, 120}, {160, 130});
        QVERIFY(!room.desk().reference()); // at once: it would be a wrong picture
        QVERIFY(room.waitForReference());
        const auto moved = *room.desk().reference();
        QVERIFY(moved.job.camera.position != before.job.camera.position && !moved.wasStored);

        room.window->findChildren<QSlider*>(QRegularExpression("^gain\\..*")).value(0)->setValue(50);
        QVERIFY(!room.desk().reference());
        QVERIFY(room.waitForReference());
        const FloatImage full = wholeView(*moved.view), half = wholeView(*room.desk().reference()->view);
        double sumFull = 0.0, sumHalf = 0.0;
        for (std::size_t i = 0; i < full.pixels.size(); ++i)
            sumFull += double(full.pixels[i].y), sumHalf += double(half.pixels[i].y);
        QVERIFY2(sumFull > 0.0 && std::abs(sumHalf / sumFull - 0.5) <= 1e-5,
                 qPrintable(QString::number(sumHalf / sumFull)));

        room.press(Qt::Key_R); // off: nothing follows the camera any more
        drag(room.viewport(), {160, 120}, {120, 120});
        QTest::qWait(1000);
        QVERIFY(!room.desk().reference());
        QCOMPARE(room.window->comparePanel().stateText(), QString("Off"));
    }

    void anotherSceneIsAskedForAgain()
    {
        Room room(scene_.file());
        room.press(Qt::Key_R);
        QVERIFY(room.waitForReference());
        const auto before = *room.desk().reference();
        const OwnScene other("two_rooms");
        QVERIFY(openAndBake(*room.window, other.file()));
        QVERIFY(room.waitForReference());
        QVERIFY(room.desk().reference()->job.camera.position != before.job.camera.position);
        QVERIFY(QDir(other.file() + ".lightloom-cache").exists());
    }

    void errorsAreFalseColourOfTheComputedError()
    {
        Room room(scene_.file());
        const struct {
            Qt::Key key;
            ErrorKind kind;
            QString unit;
        } kinds[] = {{Qt::Key_2, ErrorKind::relative, "%"},
                     {Qt::Key_3, ErrorKind::absolute, " lx"},
                     {Qt::Key_4, ErrorKind::difference, "%"}};
        for (const auto& each : kinds) {
            room.press(each.key, Qt::ControlModifier);
            QVERIFY(room.waitForErrors(each.kind));
            // the error, computed here by other calls
            const BakeView& view = *room.window->snapshots().shown();
            ViewJob job = room.desk().reference()->job;
            job.indirect = ViewJob::Indirect::field;
            job.withDirect = false;
            Workers workers(2);
            const View picture = renderView(*view.rays, *view.lights, {}, view.snapshot.field.get(), job, workers, {});
            const FloatImage matt = mattReflectance(*view.rays, job, workers, {});
            const auto expected = viewError(picture, *room.desk().reference()->view, each.kind, matt);
            QVERIFY(expected);
            // what was judged while the bake's picture was still rough is replaced; on a busy machine that takes a
            // while
            const auto isAsExpected = [&] {
                const auto& found = room.desk().errors();
                return found && found->map.values == expected->map.values && found->top == expected->top;
            };
            QVERIFY(QTest::qWaitFor(isAsExpected, kPatience));
            const std::shared_ptr<const ViewError> error = room.desk().errors();
            const QImage shown = room.grab();
            shown.save(QDir::temp().filePath("compare-errors.png"));
            const PixelCheck check = heatCheck(shown, *error);
            QVERIFY2(check.checked > 20'000 && check.off == 0, qPrintable(check.text()));
            QVERIFY(room.window->legend().isVisible());
            const QStringList ticks = room.window->legend().ticks();
            QCOMPARE(ticks.size(), 5);
            for (const QString& tick : ticks) QVERIFY2(tick.endsWith(each.unit), qPrintable(tick));
            QCOMPARE(ticks.first(), each.kind == ErrorKind::difference ? "-" + ticks.last().mid(1) : "0" + each.unit);

            QCOMPARE(room.window->comparePanel().figure(0),
                     QString("%1 %").arg(100.0 * expected->metrics.relRmse, 0, 'f', 2));
            QVERIFY(expected->metrics.relRmse > 0.01);

            room.viewport().setExposure(kEv + 2.0f); // light gets darker, figures do not
            QVERIFY(room.grab() == shown);
            room.viewport().setExposure(kEv);
        }
        // another snapshot has errors of its own
        const QString fine = room.window->comparePanel().figure(0);
        const auto before = room.desk().errors();
        room.window->snapshots().findChildren<QToolButton*>()[1]->click();
        QTRY_VERIFY_WITH_TIMEOUT(room.desk().errors() != before, kPatience);
        QVERIFY(room.waitForErrors(ErrorKind::difference));
        QVERIFY(room.window->comparePanel().figure(0) != fine);
        QVERIFY(room.window->comparePanel().judgedText().startsWith("Light octree, depth 4"));
        QVERIFY(heatCheck(room.grab(), *room.desk().errors()).off == 0);
        room.press(Qt::Key_1, Qt::ControlModifier);
        QVERIFY(!room.window->legend().isVisible() && !room.viewport().showsErrors());
    }

    void theWipePartsReferenceAndBake()
    {
        Room room(scene_.file());
        const QImage octree = room.grab();
        room.press(Qt::Key_C);
        QVERIFY(room.waitForReference());
        auto* handle = room.viewport().findChild<WipeHandle*>();
        QVERIFY(handle != nullptr && handle->isVisible() && handle->hasFocus());
        QCOMPARE(handle->part(), 0.5f);
        const FloatImage whole = wholeView(*room.desk().reference()->view);
        const auto check = [&](const char* when) {
            const QImage shown = room.grab();
            const int edge = int(std::lround(*room.viewport().wipe() * float(shown.width())));
            const PixelCheck left = lightCheck(shown, whole, kEv, 0, edge);
            QVERIFY2(left.isFine(1000), qPrintable(QString("%1: %2").arg(when, left.text())));
            const QRect right(edge, 0, shown.width() - edge, shown.height());
            QVERIFY2(shown.copy(right) == octree.copy(right), when);
            QVERIFY2(shown.copy(right.adjusted(-5, 0, 0, 0)) != octree.copy(right.adjusted(-5, 0, 0, 0)), when);
        };
        check("in the middle");
        const QPoint grip = handle->rect().center();
        drag(*handle, grip, grip + QPoint(room.viewport().width() / 5, 0));
        QVERIFY2(std::abs(handle->part() - 0.7f) <= 0.02f, qPrintable(QString::number(double(handle->part()))));
        check("dragged");
        const float part = handle->part();
        QTest::keyClick(handle, Qt::Key_Left);
        QVERIFY(std::abs(handle->part() - (part - 0.02f)) <= 1e-5f);
        QTest::keyClick(handle, Qt::Key_Right, Qt::ShiftModifier);
        QVERIFY(std::abs(handle->part() - (part - 0.018f)) <= 1e-5f);
        check("moved by keys");
        QTest::keyClick(handle, Qt::Key_Home);
        QCOMPARE(handle->part(), 0.0f);
        QVERIFY(room.grab() == octree);
        QTest::keyClick(handle, Qt::Key_C); // off again, from wherever the focus is
        QVERIFY(!handle->isVisible() && !room.viewport().wipe());
        QVERIFY(room.grab() == octree);
    }

    void aBakeComesFirst()
    {
        Room room(scene_.file());
        QSignalSpy shown(&room.desk(), &CompareDesk::referenceShown);
        BakeParams params = smallBake();
        params.octreeDepth = 8;
        params.photonCount = 400'000;
        room.window->setParams(params);
        QVERIFY(room.window->isBaking());
        room.press(Qt::Key_R);
        QCOMPARE(room.window->comparePanel().stateText(), QString("Waits for the bake"));
        QTest::qWait(600);
        QVERIFY(room.window->isBaking());
        QCOMPARE(shown.count(), 0);
        room.press(Qt::Key_Space); // a paused bake wants nothing
        QVERIFY(shown.wait(kPatience));
        room.press(Qt::Key_Escape);
        QVERIFY(room.waitForReference());
    }

    void closingDuringAReferenceIsClean()
    {
        Room room(scene_.file());
        room.window->findChild<QSpinBox*>("compare.samples")->setValue(60'000);
        QSignalSpy shown(&room.desk(), &CompareDesk::referenceShown);
        room.press(Qt::Key_2, Qt::ControlModifier);
        QVERIFY(shown.wait(kPatience));
        QTest::qWait(500);
        room.window->close();
        QElapsedTimer clock;
        clock.start();
        room.window.reset();
        qInfo("closed within %lld ms", clock.elapsed());
        QVERIFY(clock.elapsed() <= 1500);
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    CompareTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_compare.moc"
