// SPDX-License-Identifier: Apache-2.0
// Claims: while the picture rests its direct light becomes even, a lamp at a time: shadows of surfaces come near what
// rays say, glow stays, dimmed lamps bring nothing; in the window it comes by itself, holds up nothing, and begins anew
// when the camera moves.
#include "core/scene/scene_builder.h"
#include "core/trace/direct_light.h"
#include "gui_fixture.h"
#include "widgets/gl/gl_probe.h"
#include "window_helpers.h"
#include <QApplication>
#include <QElapsedTimer>
#include <QLabel>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr glm::ivec2 kSize{240, 180};
constexpr int kSamples = 8;
constexpr float kGrey = 0.5f;

/// A board half way between a panel lamp and the floor. The camera looks at the edge of its shadow.
Scene boardUnderALamp()
{
    SceneBuilder builder("board");
    const int grey = builder.addMaterial("grey", glm::vec3(kGrey));
    builder.add("Floor", quadMesh({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}), grey);
    builder.add("Board", boxMesh({-3.0f, 1.0f, -0.5f}, {0.0f, 1.02f, 0.5f}), grey);
    const int glow = builder.addEmitter("glow", glm::vec3(1000.0f));
    builder.add("Lamp", quadMesh({-0.5f, 2.0f, -0.5f}, {1, 0, 0}, {0, 0, 1}), glow);
    builder.addCamera("Edge", {1.5f, 1.2f, 2.2f}, {0, 0.3f, 0}, 70.0f);
    return builder.finish();
}

/// A wall that the sun grazes, in a wide place. With a roof before it: its edge keeps the sun off all of the wall, and
/// at the wall's foot by no more than 2 cm.
constexpr glm::vec3 kGrazing{-0.1f, -1.0f, 0.0f};
Scene wallInTheSun(bool hasRoof)
{
    SceneBuilder builder("wall");
    const int grey = builder.addMaterial("grey", glm::vec3(kGrey));
    builder.add("Floor", quadMesh({-10, 0, 10}, {20, 0, 0}, {0, 0, -20}), grey);
    builder.add("Wall", boxMesh({-0.2f, 0.0f, -3.0f}, {0.0f, 4.0f, 3.0f}), grey);
    if (hasRoof) builder.add("Roof", boxMesh({-0.2f, 6.0f, -5.0f}, {0.62f, 6.1f, 5.0f}), grey);
    builder.addDirectional("Sun", kGrazing, glm::vec3(1000.0f));
    builder.addCamera("Wall", {4.0f, 2.0f, 0.7f}, {0, 2.0f, 0}, 60.0f);
    return builder.finish();
}

/// Of the floor beside the board, against rays: root mean square of the difference over the mean.
double errorOf(const std::vector<glm::vec4>& picture, const Renderer::Pixels& pixels,
               const std::shared_ptr<const RayScene>& rays)
{
    const LightSampler lights(rays);
    double sum = 0.0, squares = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < picture.size(); i += 7) {
        const glm::vec4 at = pixels.position[i];
        if (picture[i].w < 0.999f || std::abs(at.y) > 1e-4f || std::abs(at.x) > 1.2f || std::abs(at.z) > 1.2f) continue;
        Rng rng(7, 0, i);
        const glm::vec3 p(at.x, at.y, at.z);
        const double exact = double(directIlluminance(*rays, lights, {}, p, {0, 1, 0}, 1024, rng).y);
        const double lux = double(picture[i].y) * 3.14159265 / double(kGrey);
        sum += exact, squares += (lux - exact) * (lux - exact);
        ++count;
    }
    if (count < 500) return -1.0;
    return std::sqrt(squares / count) / (sum / count);
}

} // namespace

class GuiRefineTest : public QObject {
    Q_OBJECT
    GlFixture gl_;

    struct Stage {
        std::shared_ptr<const Scene> scene;
        std::unique_ptr<Renderer> renderer;
        FrameView frame;
    };
    Stage stageOf(Scene made)
    {
        Stage stage;
        stage.scene = std::make_shared<const Scene>(std::move(made));
        auto renderer = Renderer::make(*gl_.gl);
        if (!renderer || !(*renderer)->setScene(makeDrawData(stage.scene))) qFatal("no renderer");
        stage.renderer = std::move(*renderer);
        while (!stage.renderer->drawShadows(1000.0)) {
        }
        stage.frame = viewOf(*stage.scene, 0, kSize);
        stage.frame.mode = ViewMode::direct;
        stage.frame.willRefine = true;
        return stage;
    }
    void rest(Stage& stage)
    {
        for (int i = 0; i < kSamples; ++i) {
            if (!stage.renderer->draw(stage.frame, i, kSize, gl_.target(), kSize)) qFatal("not drawn");
        }
    }
    static int refine(Stage& stage)
    {
        int parts = 1;
        while (stage.renderer->refine(stage.frame) != Renderer::Refined::all) ++parts;
        return parts;
    }

private Q_SLOTS:
    void initTestCase()
    {
        const Result<Done> gl = probeGl();
        QVERIFY2(gl, gl ? "" : gl.error().message.c_str());
        QVERIFY(gl_.start(kSize));
    }

    void softShadowsComeNearRays()
    {
        Stage stage = stageOf(boardUnderALamp());
        const auto rays = RayScene::build(stage.scene);
        QVERIFY(rays);
        rest(stage);
        const auto pixels = stage.renderer->readBack();
        const double before = errorOf(stage.renderer->picture(kSamples), pixels, *rays);
        const int parts = refine(stage);
        const double after = errorOf(stage.renderer->picture(kSamples), pixels, *rays);
        qInfo("%.2f %% of the mean off with few points, %.2f %% refined, %d parts", 100 * before, 100 * after, parts);
        QVERIFY(parts > 100); // each of them short
        QVERIFY(before > 0.0 && after > 0.0);
        QVERIFY(after <= 0.4 * before);
        QVERIFY(after <= 0.02);
        QCOMPARE(stage.renderer->refine(stage.frame), Renderer::Refined::all); // and nothing more comes
        // a new picture is none of the old ones'
        QVERIFY(stage.renderer->draw(stage.frame, 0, kSize, gl_.target(), kSize));
        QVERIFY(errorOf(stage.renderer->picture(1), stage.renderer->readBack(), *rays) > 2.0 * after);
    }

    void sunThatGrazesStaysBehindEdges_data()
    {
        QTest::addColumn<bool>("hasRoof");
        QTest::newRow("in the sun") << false;
        QTest::newRow("in the shadow of an edge") << true;
    }
    void sunThatGrazesStaysBehindEdges()
    {
        QFETCH(bool, hasRoof);
        Stage stage = stageOf(wallInTheSun(hasRoof));
        const double sunlit = 1000.0 * double(glm::dot(-glm::normalize(kGrazing), glm::vec3(1, 0, 0)));
        rest(stage);
        const auto pixels = stage.renderer->readBack();
        for (const bool isRefined : {false, true}) {
            if (isRefined) refine(stage);
            const auto picture = stage.renderer->picture(kSamples);
            double sum = 0.0, least = 1e9, most = 0.0;
            int count = 0;
            for (std::size_t i = 0; i < picture.size(); ++i) {
                const glm::vec4 at = pixels.position[i];
                if (picture[i].w < 0.999f || std::abs(at.x) > 1e-4f || at.y < 0.1f || at.y > 3.9f ||
                    std::abs(at.z) > 2.9f)
                    continue;
                const double part = double(picture[i].y) * 3.14159265 / double(kGrey) / sunlit;
                sum += part, least = std::min(least, part), most = std::max(most, part);
                ++count;
            }
            QVERIFY(count > 5000);
            qInfo("%.4f of the sun, %.4f to %.4f", sum / count, least, most);
            if (hasRoof)
                QVERIFY(sum / count <= 0.01 && most <= 0.5);
            else
                QVERIFY(sum / count >= 0.99 && least >= 0.95);
        }
    }

    void glowStaysAndTheMeanIsKept()
    {
        SceneBuilder builder("lamp");
        builder.add("Floor", quadMesh({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}),
                    builder.addMaterial("grey", glm::vec3(kGrey)));
        builder.add("Lamp", quadMesh({-0.5f, 2.0f, -0.5f}, {1, 0, 0}, {0, 0, 1}),
                    builder.addEmitter("glow", glm::vec3(1000.0f)));
        builder.addPoint("Bulb", {2.0f, 2.5f, 1.0f}, glm::vec3(200.0f));
        builder.addCamera("Up", {0, 0.3f, 2.6f}, {0, 1.4f, 0}, 70.0f);
        Stage stage = stageOf(builder.finish());
        rest(stage);
        const auto pixels = stage.renderer->readBack();
        const auto before = stage.renderer->picture(kSamples);
        refine(stage);
        const auto after = stage.renderer->picture(kSamples);
        int lamp = 0, floor = 0;
        double was = 0.0, is = 0.0, apart = 0.0;
        for (std::size_t i = 0; i < before.size(); ++i) {
            if (before[i].w < 0.999f) continue;
            if (pixels.position[i].y > 1.99f) {
                apart = std::max(apart, std::abs(double(after[i].y - before[i].y)));
                ++lamp;
            } else {
                was += double(before[i].y), is += double(after[i].y);
                ++floor;
            }
        }
        QVERIFY(lamp > 200 && floor > 2000);
        QVERIFY2(apart <= 0.5, qPrintable(QString("glow is off by %1 of 1000 cd/m2").arg(apart)));
        QVERIFY2(std::abs(is / was - 1.0) <= 0.01, qPrintable(QString::number(is / was)));

        // half the bulb, no panel: what is left is the bulb's
        Mix mix;
        for (const LightGroup& group : stage.scene->groups) mix.emplace_back(group.label == "Bulb" ? 0.5f : 0.0f);
        stage.renderer->setMix(mix);
        rest(stage);
        const auto dimmed = stage.renderer->picture(kSamples);
        refine(stage);
        const auto refined = stage.renderer->picture(kSamples);
        double sumDimmed = 0.0, sumRefined = 0.0;
        for (std::size_t i = 0; i < dimmed.size(); ++i) {
            if (dimmed[i].w < 0.999f || pixels.position[i].y > 1.99f) continue;
            sumDimmed += double(dimmed[i].y), sumRefined += double(refined[i].y);
        }
        QVERIFY(sumDimmed > 0.0 && sumDimmed < 0.6 * was);
        QVERIFY2(std::abs(sumRefined / sumDimmed - 1.0) <= 0.01, qPrintable(QString::number(sumRefined / sumDimmed)));
    }

    void withoutLampsThereIsNothingToDo()
    {
        Stage stage = stageOf(boardUnderALamp());
        stage.frame.mode = ViewMode::plain;
        rest(stage);
        QCOMPARE(stage.renderer->refine(stage.frame), Renderer::Refined::all);
        QVERIFY(!stage.renderer->mayRefine(stage.frame));
    }

    void theWindowRefinesByItself()
    {
        const auto window = makeWindow();
        window->resize(900, 500);
        QVERIFY(openAndBake(*window));
        Viewport& viewport = *window->viewport();
        const auto direct = [&] {
            for (const QLabel* label : window->findChildren<QLabel*>()) {
                if (label->text().startsWith("direct: ")) return label->text();
            }
            return QString();
        };
        QVERIFY(settle(viewport));
        const QImage before = viewport.grabFramebuffer();
        QElapsedTimer beat, whole;
        qint64 longest = 0;
        QTimer timer;
        connect(&timer, &QTimer::timeout, &timer, [&] { longest = std::max(longest, beat.restart()); });
        timer.start(5);
        beat.start(), whole.start();
        QTRY_VERIFY_WITH_TIMEOUT(viewport.isRefined(), kPatience);
        qInfo("refined after %lld ms, longest pause %lld ms, a frame takes %.0f ms", whole.elapsed(), longest,
              viewport.frameMs());
        QVERIFY(static_cast<double>(longest) <= std::max(500.0, 3.0 * viewport.frameMs()));
        QCOMPARE(direct(), QString("direct: refined"));
        const QImage after = viewport.grabFramebuffer();
        QVERIFY(after != before);
        drag(viewport, viewport.rect().center(), viewport.rect().center() + QPoint(20, 3));
        QVERIFY(!viewport.isRefined());
        QTRY_COMPARE_WITH_TIMEOUT(direct(), QString("direct: preview"), 5000);
        QVERIFY(settle(viewport));
        QTRY_VERIFY_WITH_TIMEOUT(viewport.isRefined(), kPatience);
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    GuiRefineTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_refine.moc"
