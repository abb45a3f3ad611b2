// SPDX-License-Identifier: Apache-2.0
// Claim: a click shows what the octree keeps at a surface (cell, lights with their lux, gathered photons) as marks over
// the picture and as text, follows snapshots and dimmers, and goes away again.
#include "widgets/gl/gl_probe.h"
#include "widgets/pick_card.h"
#include "widgets/pick_desk.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QApplication>
#include <QSlider>
#include <QToolButton>

using namespace lightloom;
using namespace lightloom::test;

class GuiPickTest : public QObject {
    Q_OBJECT

    std::unique_ptr<MainWindow> window_;
    Viewport* viewport_ = nullptr;
    PickDesk* desk_ = nullptr;

    [[nodiscard]] bool waitForLeaf() const
    {
        return QTest::qWaitFor([&] { return desk_->picked() && desk_->picked()->leaf; }, kPatience);
    }
    [[nodiscard]] QPoint onTheFloor() const { return {viewport_->width() / 3, viewport_->height() * 9 / 10}; }

private Q_SLOTS:
    void initTestCase()
    {
        window_ = makeWindow();
        QVERIFY(openAndBake(*window_));
        viewport_ = window_->viewport();
        QVERIFY(viewport_);
        desk_ = window_->pickDesk();
        QVERIFY(settle(*viewport_));
    }

    void altClickPicks()
    {
        const QImage before = viewport_->grabFramebuffer();
        QTest::mouseClick(viewport_, Qt::LeftButton, Qt::AltModifier, onTheFloor());
        QVERIFY(waitForLeaf());
        const LeafPick& leaf = *desk_->picked()->leaf;
        QVERIFY(leaf.normal.y > 0.9f);
        QCOMPARE(leaf.depth, 5);
        QVERIFY(leaf.answers >= 0);
        QVERIFY(!desk_->picked()->photons.empty());
        QVERIFY(actionNamed(*window_, "Pick a cell")->isChecked());
        QVERIFY(settle(*viewport_));
        QVERIFY(viewport_->grabFramebuffer() != before); // marks over it
        // text: cell, light at the point, entries with lux
        const QStringList& lines = desk_->card().lines();
        QVERIFY(desk_->card().isVisible());
        QVERIFY2(lines.size() >= 4 && lines[0].contains("Depth 5"), qPrintable(lines.join('|')));
        QVERIFY(lines.join(' ').contains("Entry 1") && lines.join(' ').contains("photons gathered"));
        QCOMPARE(desk_->card().labels().size(), leaf.entries[static_cast<std::size_t>(leaf.answers)].lights.size());
        for (const PickCard::Label& label : desk_->card().labels()) QVERIFY(label.text.endsWith("lx"));
    }

    void labelsFollowTheCamera()
    {
        const auto before = desk_->card().labels();
        drag(*viewport_, {200, 200}, {240, 205});
        QVERIFY(settle(*viewport_));
        QVERIFY(desk_->card().labels().front().at != before.front().at);
    }

    void followsTheMix()
    {
        const float full = desk_->picked()->leaf->lux.y;
        auto* slider = window_->sceneDock().findChild<QSlider*>();
        QVERIFY(slider);
        slider->setValue(50);
        QVERIFY(QTest::qWaitFor(
            [&] { return desk_->picked() && std::abs(desk_->picked()->leaf->lux.y / full - 0.5f) < 1e-3f; },
            kPatience));
        slider->setValue(100);
    }

    void followsTheSnapshot()
    {
        QToolButton* coarser = nullptr;
        for (QToolButton* button : window_->snapshots().findChildren<QToolButton*>()) {
            if (button->text().startsWith("d4")) coarser = button;
        }
        QVERIFY(coarser);
        coarser->click();
        QVERIFY(QTest::qWaitFor(
            [&] { return desk_->picked() && desk_->picked()->leaf && desk_->picked()->leaf->depth == 4; }, kPatience));
        QVERIFY(desk_->card().lines()[0].contains("Depth 4"));
    }

    void dragsDoNotPick()
    {
        const glm::vec3 at = desk_->picked()->leaf->point;
        drag(*viewport_, {220, 220}, {200, 260});
        QTest::qWait(100);
        QCOMPARE(desk_->picked()->leaf->point, at);
    }

    void goesAway()
    {
        actionNamed(*window_, "Pick a cell")->trigger();
        QVERIFY(!desk_->picked());
        QVERIFY(!desk_->card().isVisible());
        QTest::mouseClick(viewport_, Qt::LeftButton, {}, onTheFloor()); // a plain click does nothing
        QTest::qWait(200);
        QVERIFY(!desk_->picked());
        window_->viewport()->useCamera(window_->scene()->cameras.front());
        QVERIFY(settle(*viewport_));
        actionNamed(*window_, "Pick a cell")->trigger(); // with the tool it picks
        QTest::mouseClick(viewport_, Qt::LeftButton, {}, onTheFloor());
        QVERIFY(waitForLeaf());
        window_->openScene(sampleFile("two_rooms")); // another scene has none of it
        QSignalSpy opened(window_.get(), &MainWindow::sceneOpened);
        QVERIFY(opened.wait(kPatience));
        QVERIFY(!desk_->picked());
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    QApplication::setApplicationName("lightloom");
    GuiPickTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_pick.moc"
