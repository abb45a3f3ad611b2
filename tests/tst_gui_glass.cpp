// SPDX-License-Identifier: Apache-2.0
// Claim: the window sees through glass. What lies behind a pane or a slab is dimmed and tinted by what core says glass
// lets through, what lies before it is not, and glass itself is no surface.
#include "core/scene/scene_builder.h"
#include "core/trace/dielectric.h"
#include "gui_fixture.h"
#include <QtTest>

using namespace lightloom;

namespace {

constexpr glm::ivec2 kSize{240, 180};
constexpr glm::vec3 kTint(0.9f, 0.5f, 0.0f), kEye(0.0f, 0.0f, 4.0f);

enum class Kind { none, pane, slab };

/// A glowing wall, glass before its right half, and a glowing card before the glass.
Scene glowing(Kind kind)
{
    SceneBuilder b("glass");
    b.add("wall", quadMesh({-3, -3, -2}, {6, 0, 0}, {0, 6, 0}), b.addEmitter("wall", {3, 2, 1}));
    b.add("card", quadMesh({0.2f, 0.2f, 1}, {0.5f, 0, 0}, {0, 0.5f, 0}), b.addEmitter("card", {1, 5, 2}));
    if (kind == Kind::pane) b.add("pane", quadMesh({0, -3, 0}, {3, 0, 0}, {0, 6, 0}), b.addPane("tinted", kTint));
    if (kind == Kind::slab) b.add("slab", boxMesh({0, -3, -1}, {3, 3, -0.5f}), b.addGlass("clear", 1.5f));
    b.addCamera("eye", kEye, {0, 0, 0}, 50.0f);
    return b.finish();
}

} // namespace

class GuiGlassTest : public QObject {
    Q_OBJECT
    GlFixture gl_;

    Renderer::Pixels drawn(Kind kind)
    {
        const auto scene = std::make_shared<const Scene>(glowing(kind));
        auto renderer = Renderer::make(*gl_.gl);
        if (!renderer || !(*renderer)->setScene(makeDrawData(scene))) qFatal("no renderer");
        while (!(*renderer)->drawShadows(1000.0)) {
        }
        FrameView frame = viewOf(*scene, 0, kSize);
        frame.mode = ViewMode::direct;
        if (!(*renderer)->draw(frame, 0, kSize, gl_.target(), kSize)) qFatal("not drawn");
        return (*renderer)->readBack();
    }

private Q_SLOTS:
    void initTestCase() { QVERIFY(gl_.start(kSize)); }

    void behindGlassLightIsDimmed_data()
    {
        QTest::addColumn<bool>("isSlab");
        QTest::newRow("pane") << false;
        QTest::newRow("slab") << true;
    }
    void behindGlassLightIsDimmed()
    {
        QFETCH(bool, isSlab);
        const Renderer::Pixels bare = drawn(Kind::none), glazed = drawn(isSlab ? Kind::slab : Kind::pane);
        int behind = 0, beside = 0, before = 0;
        for (std::size_t i = 0; i < bare.light.size(); ++i) {
            QCOMPARE(glazed.position[i], bare.position[i]); // glass is no surface
            if (bare.position[i].w < 0.5f) continue;
            const glm::vec3 p(bare.position[i].x, bare.position[i].y, bare.position[i].z), way = p - kEye;
            const bool isCard = p.z > 0.5f;
            const float atNear = kEye.x + way.x * ((isSlab ? 4.5f : 4.0f) / -way.z);
            const float atFar = kEye.x + way.x * ((isSlab ? 5.0f : 4.0f) / -way.z);
            if (!isCard && glm::min(atNear, atFar) < 0.05f && glm::max(atNear, atFar) > -0.05f) continue; // its edge
            const bool isBehind = !isCard && atNear > 0.0f;
            glm::vec3 share(1.0f);
            if (isBehind) {
                const float cosine = -way.z / glm::length(way);
                const Glass glass{1.0f, 1.5f, !isSlab, isSlab ? glm::vec3(1.0f) : kTint, glm::vec3(0.0f)};
                share = glassShares(glass, cosine).through;
                if (isSlab) share *= share; // two borders
            }
            ++(isCard ? before : isBehind ? behind : beside);
            for (int c = 0; c < 3; ++c) {
                const float error = std::abs(glazed.light[i][c] - share[c] * bare.light[i][c]);
                QVERIFY2(error <= 1e-3f * bare.light[i][c], qPrintable(QString("%1 instead of %2")
                                                                           .arg(double(glazed.light[i][c]))
                                                                           .arg(double(share[c] * bare.light[i][c]))));
            }
        }
        QVERIFY(behind > 5000 && beside > 5000 && before > 200);
    }
};

QTEST_MAIN(GuiGlassTest)
#include "tst_gui_glass.moc"
