// SPDX-License-Identifier: Apache-2.0
// Claim: a lamp is chosen in the picture or in the dock and dragged by its handles, or moved by numbers; direct light
// follows at once, indirect light after it, from that lamp alone; Escape takes a drag back, undo brings the very same
// light again; the lamps can be saved, and the window says while they are not.
#include "core/octree/light_octree.h"
#include "core/scene/gltf_reader.h"
#include "widgets/bake_panel.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/lamp_desk.h"
#include "widgets/lamp_editor.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QApplication>
#include <QDoubleSpinBox>
#include <QMessageBox>
#include <QPushButton>
#include <QTimer>
#include <QToolButton>
#include <cmath>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// A line of sight from `eye` through `p`.
SightLine through(glm::vec3 eye, glm::vec3 p) { return {eye, glm::normalize(p - eye)}; }

PunctualLight lampAt(PunctualLight::Kind kind, glm::vec3 position, glm::vec3 travel)
{
    PunctualLight lamp;
    lamp.kind = kind;
    lamp.position = position;
    lamp.travel = glm::normalize(travel);
    return lamp;
}

double millimetres(glm::vec3 a, glm::vec3 b) { return 1000.0 * static_cast<double>(glm::length(a - b)); }

} // namespace

class GuiLampsTest : public QObject {
    Q_OBJECT

    OwnScene own_{"two_rooms"};
    std::unique_ptr<MainWindow> window_;
    Viewport* viewport_ = nullptr;
    LampDesk* desk_ = nullptr;
    QTemporaryDir folder_;

    [[nodiscard]] const PunctualLight& lamp() const { return window_->scene()->lights[0]; }
    [[nodiscard]] std::shared_ptr<const LightOctree> octree() const
    {
        return std::dynamic_pointer_cast<const LightOctree>(window_->snapshots().shown()->snapshot.field);
    }
    [[nodiscard]] QPoint handle(LampHandle which) const
    {
        const auto at = desk_->placeOfHandle(which);
        return at ? at->toPoint() : QPoint(-1, -1);
    }
    void sendMove(QPointF at, Qt::MouseButtons buttons)
    {
        QMouseEvent move(QEvent::MouseMove, at, viewport_->mapToGlobal(at), Qt::NoButton, buttons, {});
        QCoreApplication::sendEvent(viewport_, &move);
    }
    [[nodiscard]] bool bakes(const std::function<void()>& edit) const
    {
        QSignalSpy ended(window_.get(), &MainWindow::bakeEnded);
        edit();
        return ended.wait(kPatience) && ended.last().first().toBool() && !window_->isBaking();
    }

private Q_SLOTS:
    void initTestCase()
    {
        const Result<Done> gl = probeGl();
        QVERIFY2(gl, gl ? "" : gl.error().message.c_str());
        window_ = makeWindow();
        QVERIFY(openAndBake(*window_, own_.file()));
        viewport_ = window_->viewport();
        desk_ = window_->lampDesk();
        viewport_->useCamera(window_->scene()->cameras[1]); // into the room with the lamps
        QVERIFY(settle(*viewport_));
    }

    void handlesMoveAlongTheirAxisOrAcrossTheSight_data()
    {
        QTest::addColumn<LampHandle>("handle");
        QTest::addColumn<glm::vec3>("pulled"); // where the cursor takes what it holds
        QTest::addColumn<glm::vec3>("wanted");
        QTest::addRow("x") << LampHandle::x << glm::vec3(0.4f, 0.0f, 0.0f) << glm::vec3(0.4f, 0.0f, 0.0f);
        QTest::addRow("y") << LampHandle::y << glm::vec3(0.0f, -0.7f, 0.0f) << glm::vec3(0.0f, -0.7f, 0.0f);
        QTest::addRow("z") << LampHandle::z << glm::vec3(0.0f, 0.0f, 0.2f) << glm::vec3(0.0f, 0.0f, 0.2f);
        QTest::addRow("across") << LampHandle::free << glm::vec3(0.3f, 0.2f, 0.0f) << glm::vec3(0.3f, 0.2f, 0.0f);
    }
    void handlesMoveAlongTheirAxisOrAcrossTheSight()
    {
        QFETCH(LampHandle, handle);
        QFETCH(glm::vec3, pulled);
        QFETCH(glm::vec3, wanted);
        const PunctualLight lamp = lampAt(PunctualLight::Kind::point, {1.0f, 2.0f, -3.0f}, {0, -1, 0});
        // beside the axes, so that none is seen end-on; straight before the lamp where the plane across is meant
        const glm::vec3 eye = handle == LampHandle::free ? glm::vec3(1.0f, 2.0f, 2.0f) : glm::vec3(3.0f, 3.5f, 1.0f);
        const PunctualLight now =
            dragged(lamp, handle, {}, 0.5f, through(eye, lamp.position), through(eye, lamp.position + pulled));
        QVERIFY2(millimetres(now.position, lamp.position + wanted) < 0.01,
                 qPrintable(QString::number(millimetres(now.position, lamp.position + wanted))));
        QVERIFY(now.travel == lamp.travel);
    }

    void theKnobTurnsSpotsAndSuns()
    {
        for (const auto kind : {PunctualLight::Kind::spot, PunctualLight::Kind::directional}) {
            const PunctualLight lamp = lampAt(kind, {0.0f, 2.0f, 0.0f}, {0.1f, -1.0f, 0.3f});
            const glm::vec3 place(0.0f, 2.0f, 0.0f), eye(1.0f, 2.5f, 6.0f);
            const float size = 0.5f, length = 1.6f * size;
            const glm::vec3 aim = glm::normalize(glm::vec3(-0.5f, -0.8f, 0.35f)); // on the near side as well
            const PunctualLight now =
                dragged(lamp, LampHandle::aim, place, size, through(eye, place + length * lamp.travel),
                        through(eye, place + length * aim));
            const double off = std::acos(std::min(1.0, static_cast<double>(glm::dot(now.travel, aim))));
            QVERIFY2(off < 1e-3, qPrintable(QString::number(off)));
            QVERIFY(now.position == lamp.position);
        }
    }

    void lampsAreShownWithTheToolOnly()
    {
        const QImage before = viewport_->grabFramebuffer();
        actionNamed(*window_, "Move lamps")->trigger();
        QVERIFY(settle(*viewport_));
        QVERIFY(viewport_->grabFramebuffer() != before);
        actionNamed(*window_, "Move lamps")->trigger();
        QVERIFY(settle(*viewport_));
        QVERIFY(viewport_->grabFramebuffer() == before);
        actionNamed(*window_, "Move lamps")->trigger();
    }

    void aClickChooses()
    {
        QCOMPARE(desk_->light(), -1);
        QVERIFY(!window_->sceneDock().editor().isVisible());
        QTest::mouseClick(viewport_, Qt::LeftButton, {}, desk_->placeOfLamp(0)->toPoint());
        QCOMPARE(desk_->light(), 0);
        const LampEditor& editor = window_->sceneDock().editor();
        QVERIFY(editor.isVisible());
        const glm::dvec3 place = window_->scene()->toFile(lamp().position);
        QVERIFY(std::abs(editor.findChild<QDoubleSpinBox*>("lampX")->value() - place.x) < 1e-3);
        QVERIFY(std::abs(editor.findChild<QDoubleSpinBox*>("lampY")->value() - place.y) < 1e-3);
        QVERIFY(!editor.findChild<QDoubleSpinBox*>("lampTurn")->isVisible()); // a point shines all around
    }

    void aDragIsFollowedByThatLampAlone()
    {
        const auto before = octree();
        const PunctualLight was = lamp();
        QVERIFY(settle(*viewport_));
        const QImage picture = viewport_->grabFramebuffer();
        const int layers = viewport_->shadowLayersDrawn();
        const QPoint from = handle(LampHandle::y);
        QVERIFY(viewport_->rect().contains(from));
        QSignalSpy shown(window_.get(), &MainWindow::lightShown), ended(window_.get(), &MainWindow::bakeEnded);
        drag(*viewport_, from, from + QPoint(3, 60));
        const glm::vec3 way = lamp().position - was.position;
        QVERIFY2(way.x == 0.0f && way.z == 0.0f && way.y < -0.05f, qPrintable(QString::number(way.y)));
        QVERIFY(window_->isWindowModified());
        // shadows: the six faces of this lamp alone, as often as a picture was drawn
        QSignalSpy drawn(viewport_, &Viewport::frameDrawn);
        QVERIFY(drawn.wait(kPatience));
        const int redrawn = viewport_->shadowLayersDrawn() - layers;
        QVERIFY2(redrawn >= 6 && redrawn % 6 == 0, qPrintable(QString::number(redrawn)));
        QVERIFY(viewport_->grabFramebuffer() != picture);
        QVERIFY(ended.wait(kPatience) || ended.count() > 0);
        QVERIFY(ended.last().first().toBool());
        QVERIFY(!shown.first().first().toBool()); // a rough picture came before
        const auto after = octree();
        const auto group = static_cast<std::size_t>(lamp().group);
        for (std::size_t g = 0; g < before->layers().size(); ++g) {
            QCOMPARE(after->layers()[g] == before->layers()[g], g != group);
        }
        const QString did = window_->bakePanel().countersText();
        QVERIFY2(did.contains("2 on, photons of 1 kept"), qPrintable(did));
        // the lamp is nearer to the table now: more light goes up from there to the ceiling
        const glm::vec3 ceiling = window_->scene()->toScene({2.0, 2.8, 2.0}), down(0.0f, -1.0f, 0.0f);
        QVERIFY(after->irradiance(ceiling, down).y != before->irradiance(ceiling, down).y);
    }

    void undoBringsTheVerySameLight()
    {
        const auto moved = octree();
        const glm::vec3 at = lamp().position;
        QVERIFY(actionNamed(*window_, "Undo")->text().contains("moving"));
        QVERIFY(bakes([&] { actionNamed(*window_, "Undo")->trigger(); }));
        QVERIFY(lamp().position != at);
        QVERIFY(!window_->isWindowModified());
        const auto back = octree();
        QVERIFY(back->layers() != moved->layers());
        QVERIFY2(window_->bakePanel().countersText().contains("Photons: 0 shot"),
                 qPrintable(window_->bakePanel().countersText()));
        QVERIFY(bakes([&] { actionNamed(*window_, "Redo")->trigger(); }));
        QVERIFY(lamp().position == at && octree()->layers() == moved->layers());
        QVERIFY(bakes([&] { actionNamed(*window_, "Undo")->trigger(); }));
        QVERIFY(octree()->layers() == back->layers());
        QVERIFY(!actionNamed(*window_, "Undo")->text().contains("moving")); // one step for the whole drag
    }

    void escapeTakesADragBack()
    {
        const PunctualLight was = lamp();
        const QPoint from = handle(LampHandle::x);
        QTest::mousePress(viewport_, Qt::LeftButton, {}, from);
        for (const int step : {15, 30, 45}) sendMove(from + QPoint(step, 5), Qt::LeftButton);
        QVERIFY(desk_->isDragging() && lamp().position != was.position);
        QTest::keyClick(viewport_, Qt::Key_Escape);
        QVERIFY(!desk_->isDragging() && lamp().position == was.position);
        QTest::mouseRelease(viewport_, Qt::LeftButton, {}, from + QPoint(45, 5));
        QVERIFY(lamp().position == was.position && !window_->isWindowModified());
        QVERIFY(!actionNamed(*window_, "Undo")->text().contains("moving"));
        QVERIFY(QTest::qWaitFor([&] { return !window_->isBaking(); }, kPatience));
    }

    void nothingElseHappensDuringADrag()
    {
        const PunctualLight was = lamp();
        const glm::vec3 eye = viewport_->camera().eye();
        const QString step = actionNamed(*window_, "Undo")->text();
        const QPoint from = handle(LampHandle::x);
        QTest::mousePress(viewport_, Qt::LeftButton, {}, from);
        sendMove(from + QPoint(30, 5), Qt::LeftButton);
        const glm::vec3 at = lamp().position;
        QVERIFY(desk_->isDragging() && at != was.position);
        const QPointF here(from + QPoint(30, 5));
        QWheelEvent wheel(here, viewport_->mapToGlobal(here), {}, {0, 240}, Qt::LeftButton, {}, Qt::NoScrollPhase,
                          false);
        QCoreApplication::sendEvent(viewport_, &wheel);
        QTest::mousePress(viewport_, Qt::RightButton, {}, here.toPoint());
        QTest::keyPress(viewport_, Qt::Key_W);
        QTest::qWait(120); // some steps of a walk
        QTest::keyRelease(viewport_, Qt::Key_W);
        QTest::mouseRelease(viewport_, Qt::RightButton, {}, here.toPoint());
        QVERIFY(viewport_->camera().eye() == eye);
        QTest::keyClick(viewport_, Qt::Key_Z, Qt::ControlModifier);
        QVERIFY(desk_->isDragging() && lamp().position == at);
        QCOMPARE(actionNamed(*window_, "Undo")->text(), step);
        // the button came up where nobody told the window: the lamp stays where it was last
        sendMove(from + QPoint(90, 5), Qt::NoButton);
        QVERIFY(!desk_->isDragging() && lamp().position == at);
        QVERIFY(actionNamed(*window_, "Undo")->text().contains("moving"));
        QVERIFY(bakes([&] { actionNamed(*window_, "Undo")->trigger(); }));
        QVERIFY(lamp().position == was.position);
        QTest::mouseRelease(viewport_, Qt::LeftButton, {}, {5, 5});
    }

    void theSecondPressOfADoubleClickTakesHold()
    {
        const glm::vec3 eye = viewport_->camera().eye();
        const QPointF at(handle(LampHandle::x));
        QMouseEvent again(QEvent::MouseButtonDblClick, at, viewport_->mapToGlobal(at), Qt::LeftButton, Qt::LeftButton,
                          {});
        QCoreApplication::sendEvent(viewport_, &again);
        QVERIFY(desk_->isDragging());
        QTest::keyClick(viewport_, Qt::Key_Escape);
        QTest::mouseRelease(viewport_, Qt::LeftButton, {}, at.toPoint());
        QVERIFY(!desk_->isDragging() && viewport_->camera().eye() == eye);
        QVERIFY(QTest::qWaitFor([&] { return !window_->isBaking(); }, kPatience));
    }

    void besideAHandleTheCameraTurns()
    {
        const PunctualLight was = lamp();
        const glm::vec3 eye = viewport_->camera().eye();
        drag(*viewport_, {20, 20}, {60, 30});
        QVERIFY(viewport_->camera().eye() != eye && lamp().position == was.position);
        viewport_->useCamera(window_->scene()->cameras[1]);
    }

    void numbersMoveALamp()
    {
        auto* button = window_->sceneDock().findChild<QToolButton*>(
            "edit." + QString::fromStdString(window_->scene()->groups[static_cast<std::size_t>(lamp().group)].id));
        QVERIFY(button && button->isChecked()); // chosen in the picture, shown in the dock
        auto* x = window_->sceneDock().editor().findChild<QDoubleSpinBox*>("lampX");
        const glm::dvec3 place = window_->scene()->toFile(lamp().position);
        QVERIFY(bakes([&] { x->setValue(1.25); }));
        const glm::dvec3 now = window_->scene()->toFile(lamp().position);
        QVERIFY(std::abs(now.x - 1.25) < 1e-6 && std::abs(now.y - place.y) < 1e-6 && std::abs(now.z - place.z) < 1e-6);
        auto* candela = window_->sceneDock().editor().findChild<QDoubleSpinBox*>("lampIntensity");
        const glm::vec3 was = lamp().intensity;
        QVERIFY(bakes([&] { candela->setValue(2.0 * candela->value()); }));
        QVERIFY(glm::length(lamp().intensity / was - glm::vec3(2.0f)) < 0.01f); // the tint stays
        button->click();
        QVERIFY(!window_->sceneDock().editor().isVisible());
        QCOMPARE(desk_->light(), -1);
    }

    void savedLampsComeBack()
    {
        QVERIFY(window_->isWindowModified());
        const QString file = folder_.filePath("moved.glb");
        window_->saveSceneAs(file);
        QVERIFY(QTest::qWaitFor([&] { return !window_->isWindowModified(); }, kPatience));
        const auto read = readScene(std::filesystem::path(file.toStdString()));
        QVERIFY2(static_cast<bool>(read), read ? "" : read.error().message.c_str());
        const Scene &open = *window_->scene(), &saved = **read;
        QCOMPARE(saved.lights.size(), open.lights.size());
        const glm::dvec3 kept = saved.toFile(saved.lights[0].position), shown = open.toFile(lamp().position);
        QVERIFY(glm::length(kept - shown) < 1e-5);
        QVERIFY(glm::length(saved.lights[0].intensity / lamp().intensity - glm::vec3(1.0f)) < 1e-5f);
        QVERIFY(saved.groups.size() == open.groups.size() && saved.groups[0].id == open.groups[0].id);
        // undo leaves the saved state
        QVERIFY(bakes([&] { actionNamed(*window_, "Undo")->trigger(); }));
        QVERIFY(window_->isWindowModified());
        QVERIFY(bakes([&] { actionNamed(*window_, "Redo")->trigger(); }));
        QVERIFY(!window_->isWindowModified());
    }

    void aFolderThatIsNotThereIsSaid()
    {
        QVERIFY(bakes([&] { actionNamed(*window_, "Undo")->trigger(); }));
        window_->saveSceneAs(folder_.filePath("nowhere/x.glb"));
        QTest::qWait(500);
        QVERIFY(window_->isWindowModified()); // nothing was lost, and nothing is claimed
        QVERIFY(bakes([&] { actionNamed(*window_, "Redo")->trigger(); }));
    }

    void editsMadeWhileASceneIsReadAreNotLost()
    {
        QVERIFY(!window_->isWindowModified());
        QMessageBox::StandardButton answer = QMessageBox::Cancel;
        int asked = 0;
        QTimer asking; // answers what the window asks
        connect(&asking, &QTimer::timeout, this, [&] {
            auto* box = qobject_cast<QMessageBox*>(QApplication::activeModalWidget());
            if (box == nullptr) return;
            ++asked;
            box->button(answer)->click();
        });
        asking.start(20);
        QSignalSpy opened(window_.get(), &MainWindow::sceneOpened);
        window_->openScene(own_.file()); // nothing to lose yet
        QTest::mouseClick(viewport_, Qt::LeftButton, {}, desk_->placeOfLamp(0)->toPoint());
        auto* x = window_->sceneDock().editor().findChild<QDoubleSpinBox*>("lampX");
        x->setValue(x->value() + 0.1);
        const glm::vec3 moved = lamp().position;
        QVERIFY(QTest::qWaitFor([&] { return asked > 0 || opened.count() > 0; }, kPatience));
        QTest::qWait(100);
        QCOMPARE(opened.count(), 0);
        QVERIFY(lamp().position == moved && window_->isWindowModified());
        answer = QMessageBox::Discard; // known when it is asked for: said once, and not asked again
        asked = 0;
        window_->openScene(own_.file());
        QVERIFY(opened.wait(kPatience));
        QCOMPARE(asked, 1);
        QVERIFY(lamp().position != moved && !window_->isWindowModified());
        QVERIFY(QTest::qWaitFor([&] { return !window_->isBaking(); }, kPatience));
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    QApplication::setApplicationName("lightloom");
    GuiLampsTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_lamps.moc"
