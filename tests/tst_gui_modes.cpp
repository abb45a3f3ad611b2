// SPDX-License-Identifier: Apache-2.0
// Claim: one bake is looked at in several ways. Octree, colour octree and photon map have keys, commands and a place in
// the toolbar; what is measured and compared is what is shown; the photon map comes by itself, on a thread of its own,
// while the window answers.
#include "widgets/compare_desk.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/picture_desk.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QApplication>
#include <QElapsedTimer>
#include <QMenu>
#include <QSlider>
#include <QToolBar>
#include <QToolButton>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// Longest time between two turns of the event loop.
class Heartbeat {
public:
    Heartbeat()
    {
        timer_.setInterval(5);
        QObject::connect(&timer_, &QTimer::timeout, &timer_,
                         [this] { longest_ = std::max(longest_, clock_.restart()); });
        clock_.start();
        timer_.start();
    }
    [[nodiscard]] qint64 longestMs() const { return longest_; }

private:
    QTimer timer_;
    QElapsedTimer clock_;
    qint64 longest_ = 0;
};

} // namespace

class GuiModesTest : public QObject {
    Q_OBJECT

    std::unique_ptr<MainWindow> window_;
    Viewport* viewport_ = nullptr;

    void press(Qt::Key key, Qt::KeyboardModifiers with = {}) const
    {
        viewport_->setFocus();
        QTest::keyClick(viewport_, key, with);
    }
    static const PhotonMapField* mapOf(const PictureDesk& desk)
    {
        return dynamic_cast<const PhotonMapField*>(desk.field().get());
    }
    [[nodiscard]] QImage picture() const
    {
        [&] { QVERIFY(settle(*viewport_)); }();
        return viewport_->grabFramebuffer();
    }

private Q_SLOTS:
    void initTestCase()
    {
        window_ = makeWindow();
        QVERIFY(openAndBake(*window_));
        viewport_ = window_->viewport();
        QVERIFY(viewport_);
    }

    void keysSwitchModes()
    {
        const struct {
            Qt::Key key;
            Qt::KeyboardModifiers with;
            ViewMode mode;
        } keys[] = {{Qt::Key_1, Qt::AltModifier, ViewMode::colours},
                    {Qt::Key_6, {}, ViewMode::plain},
                    {Qt::Key_5, {}, ViewMode::direct},
                    {Qt::Key_2, Qt::AltModifier, ViewMode::photonMap},
                    {Qt::Key_1, {}, ViewMode::octree}};
        for (const auto& each : keys) {
            press(each.key, each.with);
            QCOMPARE(viewport_->mode(), each.mode);
        }
        press(Qt::Key_Tab); // back to the one before
        QCOMPARE(viewport_->mode(), ViewMode::photonMap);
        press(Qt::Key_Tab);
        QCOMPARE(viewport_->mode(), ViewMode::octree);
    }

    void toolbarNamesTheWayTheBakeIsShown()
    {
        QToolButton* button = nullptr;
        for (QToolButton* each : window_->findChildren<QToolButton*>()) {
            if (each->defaultAction() != nullptr && each->defaultAction()->text() == "&Octree") button = each;
        }
        QVERIFY(button && button->menu());
        QVERIFY(button->menu()->actions().size() >= 3);
        actionNamed(*window_, "Colour octree")->trigger();
        QCOMPARE(button->text(), QString("Colours"));
        QVERIFY(button->isChecked());
        press(Qt::Key_6);
        QVERIFY(!button->isChecked());
        button->click(); // goes back to it
        QCOMPARE(viewport_->mode(), ViewMode::colours);
        press(Qt::Key_1);
        QCOMPARE(button->text(), QString("Octree"));
    }

    void coloursAreShownAndJudged()
    {
        actionNamed(*window_, "Indirect only")->trigger();
        press(Qt::Key_1);
        const QImage lights = picture();
        press(Qt::Key_1, Qt::AltModifier);
        const QImage colours = picture();
        const double apart = meanDifference(lights, colours);
        qInfo("octree and colour octree: %.2f of 255 apart", apart);
        // nearly the same on flat walls, where the receiver's normal is the entry's; blocks and edges differ a little
        QVERIFY(apart > 0.0 && apart < 12.0);
        actionNamed(*window_, "Indirect only")->trigger();
        press(Qt::Key_1);
        QVERIFY(meanDifference(lights, colours) > 0.0);
    }

    void photonMapComesWhileTheWindowAnswers()
    {
        press(Qt::Key_1);
        const QImage octree = picture();
        const Heartbeat heartbeat;
        press(Qt::Key_2, Qt::AltModifier);
        QVERIFY(QTest::qWaitFor([&] { return viewport_->hasMadePicture(); }, kPatience));
        // pictures are drawn by the processor here; nothing else may hold the loop
        qInfo("longest pause %lld ms, a frame takes %.0f ms", heartbeat.longestMs(), viewport_->frameMs());
        QVERIFY(static_cast<double>(heartbeat.longestMs()) <= std::max(1500.0, 8.0 * viewport_->frameMs()));
        PictureDesk& desk = *window_->pictureDesk();
        QVERIFY(desk.field());
        QVERIFY(mapOf(desk)->layers()[0].cache);
        QVERIFY(QTest::qWaitFor([&] { return desk.stateText().contains("16 of 16"); }, kPatience));
        const QImage photons = picture();
        const double apart = meanDifference(octree, photons);
        qInfo("octree and photon map: %.2f of 255 apart", apart);
        QVERIFY(apart > 0.1 && apart < 20.0); // noisier, and its direct light is exact
        QVERIFY(desk.stateText().contains("Photon map"));
    }

    void anotherCameraKeepsTheCache()
    {
        PictureDesk& desk = *window_->pictureDesk();
        const auto cache = mapOf(desk)->layers()[0].cache;
        drag(*viewport_, {200, 200}, {260, 210});
        QVERIFY(!viewport_->hasMadePicture()); // of another view: gone at once
        QVERIFY(QTest::qWaitFor([&] { return viewport_->hasMadePicture(); }, kPatience));
        QCOMPARE(mapOf(desk)->layers()[0].cache, cache);
    }

    void anotherMixKeepsTheCache()
    {
        PictureDesk& desk = *window_->pictureDesk();
        const auto cache = mapOf(desk)->layers()[0].cache;
        const auto before = desk.field();
        const glm::vec3 p =
            window_->scene()->bounds.centre() * glm::vec3(1, 0, 1) + glm::vec3(0, window_->scene()->bounds.low.y, 0);
        const float full = before->irradiance(p, glm::vec3(0, 1, 0)).y;
        auto* slider = window_->sceneDock().findChild<QSlider*>();
        QVERIFY(slider);
        slider->setValue(50);
        QVERIFY(QTest::qWaitFor([&] { return desk.field() && desk.field() != before; }, kPatience));
        QCOMPARE(mapOf(desk)->layers()[0].cache, cache);
        QVERIFY(std::abs(desk.field()->irradiance(p, glm::vec3(0, 1, 0)).y / full - 0.5f) <= 1e-3f);
        slider->setValue(100);
        press(Qt::Key_1);
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    QApplication::setApplicationName("lightloom");
    GuiModesTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_modes.moc"
