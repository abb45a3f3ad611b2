// SPDX-License-Identifier: Apache-2.0
// Claims: the form of a lamp changes what was typed and nothing else; a lamp of no light keeps its own colour; what the
// window does with every step of a drag costs the same however many glowing surfaces there are.
#include "core/scene/scene_builder.h"
#include "widgets/gl/draw_data.h"
#include "widgets/lamp_editor.h"
#include "widgets/lamp_gizmo.h"
#include <QApplication>
#include <QDoubleSpinBox>
#include <QtTest>
#include <cmath>

using namespace lightloom;

namespace {

constexpr float kDegree = 0.017453292f;

/// Spots between the form's decimals: a wide one, a narrow one whose cones are below what the form shows, and a dark
/// one.
std::shared_ptr<const Scene> spots()
{
    SceneBuilder builder("spots");
    const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
    builder.add("Floor", boxMesh({-5.0f, -0.1f, -5.0f}, {5.0f, 0.0f, 5.0f}), grey);
    const glm::vec3 red(100.0f, 40.0f, 10.0f);
    builder.addSpot("Wide", {0, 3, 0}, {0.3123f, -0.8f, 0.4567f}, red, 20.037f * kDegree, 30.041f * kDegree);
    builder.addSpot("Narrow", {1, 3, 0}, {0.1f, -1.0f, 0.2f}, red, 0.02f * kDegree, 0.05f * kDegree);
    builder.addSpot("Dark", {2, 3, 0}, {0.1f, -1.0f, 0.2f}, glm::vec3(0.0f), 0.1f, 0.2f);
    return std::make_shared<const Scene>(builder.finish());
}

/// The form, and the scene as its edits leave it.
struct Desk {
    std::shared_ptr<const Scene> scene = spots();
    LampEditor editor;
    Desk()
    {
        QObject::connect(&editor, &LampEditor::edited, &editor, [this](int light, const PunctualLight& now) {
            auto edited = std::make_shared<Scene>(*scene);
            edited->lights[static_cast<std::size_t>(light)] = now;
            scene = edited;
            choose(light);
        });
    }
    void choose(int light) { editor.setLamp(scene, lamp(light).group, light); }
    [[nodiscard]] const PunctualLight& lamp(int light) const { return scene->lights[static_cast<std::size_t>(light)]; }
    void type(const char* field, double value) const { editor.findChild<QDoubleSpinBox*>(field)->setValue(value); }
};

double turnDeg(glm::vec3 travel)
{
    return glm::degrees(std::atan2(static_cast<double>(travel.x), static_cast<double>(travel.z)));
}
double tiltDeg(glm::vec3 travel) { return glm::degrees(std::asin(static_cast<double>(travel.y))); }

double bestMs(const std::function<void()>& what)
{
    double best = 1e9;
    for (int i = 0; i < 5; ++i) {
        QElapsedTimer clock;
        clock.start();
        what();
        best = std::min(best, 1e-6 * static_cast<double>(clock.nsecsElapsed()));
    }
    return best;
}

bool isAlike(const PreviewLight& a, const PreviewLight& b)
{
    return a.kind == b.kind && a.group == b.group && a.position == b.position && a.travel == b.travel &&
           a.colour == b.colour && a.cosInner == b.cosInner && a.cosOuter == b.cosOuter && a.area == b.area &&
           a.inCube == b.inCube;
}

} // namespace

class GuiLampFormTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void theOtherAngleIsNotRounded()
    {
        Desk desk;
        desk.choose(0);
        const double turn = turnDeg(desk.lamp(0).travel), tilt = tiltDeg(desk.lamp(0).travel);
        QVERIFY(std::abs(turn * 10.0 - std::round(turn * 10.0)) > 0.05); // the form shows another number
        desk.type("lampTilt", -30.0);
        QVERIFY2(std::abs(turnDeg(desk.lamp(0).travel) - turn) < 1e-4,
                 qPrintable(QString("%1 for %2").arg(turnDeg(desk.lamp(0).travel)).arg(turn)));
        QVERIFY(std::abs(tiltDeg(desk.lamp(0).travel) + 30.0) < 1e-4 && std::abs(tilt + 30.0) > 1.0);
    }

    void theOtherConeIsNotRounded()
    {
        Desk desk;
        desk.choose(0);
        const float outer = desk.lamp(0).outerCone;
        desk.type("lampInner", 10.0);
        QVERIFY(desk.lamp(0).outerCone == outer);
        QVERIFY(std::abs(desk.lamp(0).innerCone - 10.0f * kDegree) < 1e-6f);
        desk.choose(1);
        const float narrow = desk.lamp(1).innerCone;
        desk.type("lampOuter", 5.0);
        QVERIFY(desk.lamp(1).innerCone == narrow);
        QVERIFY(std::abs(desk.lamp(1).outerCone - 5.0f * kDegree) < 1e-6f);
    }

    void oneConeStaysInsideTheOther()
    {
        Desk desk;
        desk.choose(0);
        for (const double inner : {30.0, 40.0, 89.9, 90.0}) {
            desk.type("lampInner", inner);
            const PunctualLight& now = desk.lamp(0);
            QVERIFY2(now.innerCone <= 0.99901f * now.outerCone && now.outerCone <= 90.0f * kDegree + 1e-6f,
                     qPrintable(QString("%1: %2 in %3").arg(inner).arg(now.innerCone).arg(now.outerCone)));
            QVERIFY(std::abs(now.innerCone - static_cast<float>(inner) * kDegree) < 0.002f);
        }
        desk.type("lampOuter", 20.0);
        QVERIFY(std::abs(desk.lamp(0).outerCone - 20.0f * kDegree) < 1e-6f);
        QVERIFY(desk.lamp(0).innerCone <= 0.99901f * desk.lamp(0).outerCone);
    }

    void aLampOfNoLightKeepsItsOwnColour()
    {
        Desk desk;
        desk.choose(0);
        const glm::vec3 red = desk.lamp(0).intensity;
        desk.choose(2); // it has never shone: white
        desk.type("lampIntensity", 50.0);
        QVERIFY(glm::length(desk.lamp(2).intensity - glm::vec3(50.0f)) < 1e-3f);
        desk.choose(0);
        desk.type("lampIntensity", 0.0);
        QVERIFY(desk.lamp(0).intensity == glm::vec3(0.0f));
        desk.choose(2);
        desk.choose(0);
        desk.type("lampIntensity", 20.0);
        const glm::vec3 now = desk.lamp(0).intensity;
        QVERIFY2(glm::length(now / now.x - red / red.x) < 1e-4f,
                 qPrintable(QString("%1 %2 %3").arg(now.x).arg(now.y).arg(now.z)));
    }

    void aMovedLampDoesNotTouchGlowingSurfaces()
    {
        SceneBuilder builder("globe");
        const int glow = builder.addEmitter("glow", glm::vec3(1000.0f));
        builder.add("Globe", sphereMesh({0.0f, 1.0f, 0.0f}, 0.5f, 300), glow);
        for (int i = 0; i < 9; ++i) {
            builder.addSpot("Spot/" + std::to_string(i), {2, 3, 0}, {0.1f, -1.0f, 0.2f}, glm::vec3(10.0f), 0.3f, 0.6f);
        }
        const auto scene = std::make_shared<const Scene>(builder.finish());
        std::shared_ptr<const DrawData> made, taken;
        const double making = bestMs([&] { made = makeDrawData(scene); });
        const auto edit = [&](const std::function<void(PunctualLight&)>& change) {
            auto copy = std::make_shared<Scene>(*scene);
            for (PunctualLight& light : copy->lights) change(light);
            return std::shared_ptr<const Scene>(std::move(copy));
        };
        const auto isAsMade = [&](const std::shared_ptr<const Scene>& edited) {
            const auto by = withLamps(*made, edited), anew = makeDrawData(edited);
            return by->scene == edited && by->lampMessage == anew->lampMessage &&
                   std::ranges::equal(by->lights, anew->lights, isAlike);
        };
        const auto moved = edit([](PunctualLight& l) { l.position.x += 1.0f; });
        QVERIFY(isAsMade(moved));
        // wide cones need six shadow maps each: the surface's patches must make room
        QVERIFY(isAsMade(edit([](PunctualLight& l) { l.outerCone = 1.4f; })));
        const double moving = bestMs([&] { taken = withLamps(*made, moved); });
        QVERIFY2(moving < 0.05 * making, qPrintable(QString("%1 of %2 ms").arg(moving).arg(making)));
    }

    void outlinesAreLinesEnoughAndNotMore()
    {
        SceneBuilder builder("many lamps");
        const int glow = builder.addEmitter("glow", glm::vec3(1000.0f));
        const int mesh = builder.addMesh(quadMesh({0, 0, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}), glow);
        for (int i = 0; i < 4'000; ++i) {
            glm::mat4 at(1.0f);
            at[3] = glm::vec4(static_cast<float>(i), 2.0f, 0.0f, 1.0f);
            builder.place("Lamp/" + std::to_string(i), mesh, at, i < 2 ? "pair" : "rest");
        }
        builder.add("Other", boxMesh({0, 5, 0}, {1, 6, 1}), glow, "box");
        const Scene scene = builder.finish();
        const auto outlines = outlinesOf(scene);
        QCOMPARE(outlines.size(), scene.groups.size());
        std::size_t all = 0;
        for (std::size_t g = 0; g < outlines.size(); ++g) {
            all += outlines[g].size();
            if (scene.groups[g].label != "pair") continue;
            QCOMPARE(outlines[g].size(), std::size_t(8)); // four edges each, not the diagonal
            float farthest = 0.0f;
            for (const HandleLine& line : outlines[g]) farthest = std::max(farthest, line.a.x);
            QVERIFY(std::abs(farthest - 1.1f) < 1e-5f);
        }
        QVERIFY2(all > 4'000 && all <= 8'000, qPrintable(QString::number(all)));
    }
};

QTEST_MAIN(GuiLampFormTest)
#include "tst_gui_lamp_form.moc"
