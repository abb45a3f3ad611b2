// SPDX-License-Identifier: Apache-2.0
// Claim: an object that was not in the bake can be put into the picture and dragged through the light: it follows the
// mouse level, or up and down, turns by the wheel, goes back by Escape, and no bake is made for it. Files with errors
// change nothing; another scene takes it away.
#include "widgets/gl/gl_probe.h"
#include "widgets/guest_desk.h"
#include "widgets/message_bar.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QAbstractButton>
#include <QApplication>
#include <QWheelEvent>

using namespace lightloom;
using namespace lightloom::test;

class GuiGuestTest : public QObject {
    Q_OBJECT

    std::unique_ptr<MainWindow> window_;
    Viewport* viewport_ = nullptr;
    GuestDesk* desk_ = nullptr;

    [[nodiscard]] bool add(const QString& command) const
    {
        QSignalSpy added(desk_, &GuestDesk::added);
        actionNamed(*window_, command)->trigger();
        return (!added.isEmpty() || added.wait(kPatience)) && settle(*viewport_);
    }
    [[nodiscard]] QPoint onGuest() const
    {
        const auto at = viewport_->placeIn(desk_->position());
        return at ? at->toPoint() : QPoint(-1, -1);
    }
    [[nodiscard]] bool isGuestAt(QPoint at) const
    {
        const auto seen = viewport_->surfaceAt(at);
        return seen && seen->isGuest;
    }
    void press(Qt::Key key) const
    {
        viewport_->setFocus();
        QTest::keyClick(viewport_, key);
    }
    void mouse(QEvent::Type type, QPoint at, Qt::KeyboardModifiers with = {}) const
    {
        const bool isMove = type == QEvent::MouseMove, isUp = type == QEvent::MouseButtonRelease;
        QMouseEvent event(type, at, viewport_->mapToGlobal(at), isMove ? Qt::NoButton : Qt::LeftButton,
                          isUp ? Qt::NoButton : Qt::LeftButton, with);
        QCoreApplication::sendEvent(viewport_, &event);
    }
    void dragGuest(QPoint by, Qt::KeyboardModifiers with = {}) const
    {
        const QPoint from = onGuest();
        mouse(QEvent::MouseButtonPress, from, with);
        for (int i = 1; i <= 4; ++i) mouse(QEvent::MouseMove, from + by * i / 4, with);
    }

private Q_SLOTS:
    void initTestCase()
    {
        window_ = makeWindow();
        window_->resize(960, 520);
        BakeParams params = smallBake();
        params.gridSize = 12;
        window_->setParams(params);
        QVERIFY(!actionNamed(*window_, "Add a ball")->isEnabled()); // to what?
        QVERIFY(openAndBake(*window_));
        viewport_ = window_->viewport();
        desk_ = window_->guestDesk();
        QVERIFY(viewport_ && desk_);
    }

    void itComesBeforeTheCamera()
    {
        QVERIFY(add("Add a ball"));
        QVERIFY(isGuestAt(onGuest()));
        QVERIFY(!isGuestAt({3, 3}));
        const Bounds& bounds = window_->scene()->bounds;
        QVERIFY(glm::all(glm::greaterThan(desk_->position(), bounds.low)));
        QVERIFY(glm::all(glm::lessThan(desk_->position(), bounds.high)));
        const glm::mat4 place = desk_->place();
        QVERIFY(std::abs(glm::length(glm::vec3(place[0])) - bounds.diagonal() / 8.0f) <= 1e-4f); // it is 1 m wide
    }

    void theOctreeSaysThatItLacksLight()
    {
        QVERIFY(window_->messages().text().contains("grid"));
        QSignalSpy ended(window_.get(), &MainWindow::bakeEnded);
        QAbstractButton* way = nullptr;
        for (QAbstractButton* each : window_->messages().findChildren<QAbstractButton*>()) {
            if (each->text().contains("grid")) way = each;
        }
        QVERIFY(way);
        way->click();
        QVERIFY(ended.wait(kPatience));
        QCOMPARE(viewport_->mode(), ViewMode::grid);
        QVERIFY(settle(*viewport_));
        QVERIFY(desk_->hasGuest());
    }

    void itIsLitByTheGrid() // on the side that no lamp shines on, by what the grid says there
    {
        actionNamed(*window_, "Indirect only")->trigger();
        QVERIFY(settle(*viewport_));
        const QImage shown = viewport_->grabFramebuffer();
        const QPoint below = onGuest() + QPoint(0, 4);
        const auto seen = viewport_->surfaceAt(below);
        QVERIFY(seen && seen->isGuest);
        glm::vec3 lux(0.0f);
        QVERIFY(window_->snapshots().shown()->snapshot.field->lookup(seen->position, seen->normal, lux));
        QVERIFY(lux.y > 0.0f);
        QVERIFY(qGray(shown.pixel(below)) > 10);
        actionNamed(*window_, "Indirect only")->trigger();
        QVERIFY(settle(*viewport_));
    }

    void dragsGoLevelOrUpright()
    {
        QSignalSpy baked(window_.get(), &MainWindow::bakeEnded);
        const glm::vec3 eye = viewport_->camera().eye();
        glm::vec3 before = desk_->position();
        dragGuest({60, 0});
        mouse(QEvent::MouseButtonRelease, onGuest());
        const glm::vec3 moved = desk_->position() - before;
        QVERIFY(glm::length(moved) > 0.01f * window_->scene()->bounds.diagonal());
        QVERIFY(viewport_->camera().eye() == eye); // it is not the camera that was dragged
        QVERIFY(settle(*viewport_));
        QVERIFY(isGuestAt(onGuest())); // drawn where it is
        before = desk_->position();
        dragGuest({0, -50}, Qt::ShiftModifier);
        mouse(QEvent::MouseButtonRelease, onGuest(), Qt::ShiftModifier);
        const glm::vec3 lifted = desk_->position() - before;
        QVERIFY(lifted.y > 0.0f);
        QVERIFY(std::abs(lifted.x) + std::abs(lifted.z) <= 1e-5f);
        QVERIFY(settle(*viewport_));
        QVERIFY(baked.isEmpty() && !window_->isBaking());
    }

    void escapeTakesADragBack()
    {
        const glm::vec3 before = desk_->position();
        dragGuest({-70, 10});
        QVERIFY(desk_->isDragging());
        QVERIFY(!(desk_->position() == before));
        QTest::keyClick(viewport_, Qt::Key_Escape);
        QVERIFY(!desk_->isDragging());
        QCOMPARE(desk_->position(), before);
        QVERIFY(settle(*viewport_));
    }

    void aDragIsOneStepToUndo()
    {
        const QAction* undo = actionNamed(*window_, "Undo");
        const glm::vec3 before = desk_->position();
        dragGuest({50, 5});
        mouse(QEvent::MouseButtonRelease, onGuest());
        const glm::vec3 after = desk_->position();
        QVERIFY(!(after == before));
        actionNamed(*window_, "Undo")->trigger();
        QCOMPARE(desk_->position(), before);
        actionNamed(*window_, "Redo")->trigger();
        QCOMPARE(desk_->position(), after);
        dragGuest({-50, 0}); // one that is taken back is none
        QTest::keyClick(viewport_, Qt::Key_Escape);
        actionNamed(*window_, "Undo")->trigger();
        QCOMPARE(desk_->position(), before);
        actionNamed(*window_, "Remove the object")->trigger();
        QVERIFY(!desk_->hasGuest() && !actionNamed(*window_, "Remove the object")->isEnabled());
        QVERIFY(undo->isEnabled());
        actionNamed(*window_, "Undo")->trigger();
        QVERIFY(desk_->hasGuest() && actionNamed(*window_, "Remove the object")->isEnabled());
        QCOMPARE(desk_->position(), before);
        QVERIFY(settle(*viewport_));
        QVERIFY(isGuestAt(onGuest()));
    }

    void itThrowsShadows() // in lamps' light; where it is, and no more where it was
    {
        press(Qt::Key_5); // direct light alone
        const Guest shown = desk_->guest();
        const auto picture = [&](const Guest& guest) {
            desk_->restore(guest);
            [&] { QTRY_VERIFY_WITH_TIMEOUT(viewport_->isSettled() && viewport_->isRefined(), kPatience); }();
            return viewport_->grabFramebuffer();
        };
        const QImage without = picture({});
        Guest there = shown;
        there.position = window_->scene()->bounds.centre(); // below the lamp
        const QImage with = picture(there);
        int darker = 0, brighter = 0;
        for (int y = 0; y < with.height(); ++y) {
            for (int x = 0; x < with.width(); ++x) {
                const QPoint at = QPointF(QPointF(x, y) / viewport_->devicePixelRatioF()).toPoint();
                if (x % 4 != 0 || y % 4 != 0 || isGuestAt(at)) continue; // the scene's own surfaces
                const int change = qGray(with.pixel(x, y)) - qGray(without.pixel(x, y));
                darker += change < -25 ? 1 : 0;
                brighter += change > 10 ? 1 : 0;
            }
        }
        qInfo("%d of each 16 pixels darker, %d brighter", darker, brighter);
        QVERIFY(darker > 100 && brighter < darker / 20);
        QVERIFY(picture({}) == without); // nothing of it stays
        (void)picture(shown);
        press(Qt::Key_2);
        QVERIFY(settle(*viewport_));
    }

    void theWheelTurnsIt()
    {
        const glm::mat4 before = desk_->place();
        const float distance = viewport_->camera().distance();
        const QPoint at = onGuest();
        QWheelEvent event(at, viewport_->mapToGlobal(at), {}, {0, 120}, Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase,
                          false);
        QCoreApplication::sendEvent(viewport_, &event);
        QVERIFY(!(desk_->place() == before));
        QCOMPARE(desk_->place()[3].y, before[3].y);
        QCOMPARE(viewport_->camera().distance(), distance);
    }

    void filesMayBeAddedAndMayBeBad()
    {
        QSignalSpy added(desk_, &GuestDesk::added), failed(desk_, &GuestDesk::failed);
        QTemporaryDir folder;
        QFile bad(folder.filePath("bad.glb"));
        QVERIFY(bad.open(QIODevice::WriteOnly));
        bad.write("no scene");
        bad.close();
        const glm::vec3 before = desk_->position();
        desk_->addFile(bad.fileName());
        QVERIFY(failed.wait(kPatience));
        QVERIFY(desk_->hasGuest());
        QCOMPARE(desk_->position(), before); // the ball stays
        desk_->addFile(sampleFile("caustic_ring"));
        QVERIFY(added.wait(kPatience));
        QCOMPARE(added.first().first().toString(), QString("caustic_ring"));
        QVERIFY(settle(*viewport_));
        QVERIFY(add("Add a figure"));
        QVERIFY(isGuestAt(onGuest()));
    }

    void itGoesByCommandAndWithTheScene()
    {
        actionNamed(*window_, "Remove the object")->trigger();
        QVERIFY(!desk_->hasGuest());
        QVERIFY(!actionNamed(*window_, "Remove the object")->isEnabled());
        QVERIFY(settle(*viewport_));
        QVERIFY(add("Add a ring"));
        QVERIFY(openAndBake(*window_, sampleFile("two_rooms")));
        QVERIFY(!desk_->hasGuest());
        QVERIFY(settle(*viewport_));
        const QPoint middle(viewport_->width() / 2, viewport_->height() / 2);
        QVERIFY(!isGuestAt(middle));
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    QApplication::setApplicationName("lightloom");
    GuiGuestTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_guest.moc"
