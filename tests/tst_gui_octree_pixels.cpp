// SPDX-License-Identifier: Apache-2.0
// Claim: the viewport shows what the bake says. Indirect illuminance per pixel equals LightOctree::lookup at the same
// points, and direct illuminance of the preview comes near the exact one where nothing is in half shadow.
#include "core/bake/packed_octree.h"
#include "core/base/units.h"
#include "core/octree/detail_union.h"
#include "core/scene/sample_scenes.h"
#include "core/trace/direct_light.h"
#include "gui_fixture.h"
#include "widgets/gl/gl_probe.h"
#include <QGuiApplication>
#include <QtTest>

using namespace lightloom;

namespace {
constexpr glm::ivec2 kSize{320, 240};

glm::vec3 xyz(glm::vec4 v) { return {v.x, v.y, v.z}; }

/// Share of values beyond `limit`, and the median.
struct Spread {
    std::vector<double> errors;
    double median() { return at(0.5); }
    double at(double share)
    {
        std::sort(errors.begin(), errors.end());
        return errors.empty() ? 1e30 : errors[static_cast<std::size_t>(share * double(errors.size() - 1))];
    }
};
} // namespace

class OctreePixelsTest : public QObject {
    Q_OBJECT
    GlFixture gl_;
    std::shared_ptr<const Scene> scene_;

private Q_SLOTS:
    void initTestCase()
    {
        QVERIFY(gl_.start(kSize));
        scene_ = std::make_shared<const Scene>(cornellBox());
    }

    void indirectEqualsLookup_data()
    {
        QTest::addColumn<int>("vdls");
        QTest::addColumn<float>("shift");
        QTest::addColumn<bool>("asColours");
        QTest::newRow("k=1") << 1 << 0.0f << false;
        QTest::newRow("k=4") << 4 << 0.0f << false;
        QTest::newRow("k=4, lattice shifted") << 4 << 0.5f << false;
        QTest::newRow("colour octree") << 4 << 0.5f << true;
        QTest::newRow("leaves split") << 4 << 0.25f << false; // caustic_ring
        QTest::newRow("leaves split, colour octree") << 4 << 0.0f << true;
    }
    void indirectEqualsLookup()
    {
        QFETCH(int, vdls);
        QFETCH(float, shift);
        BakeParams params;
        params.photonCount = 60'000;
        params.gatherCount = 100;
        params.octreeFirstDepth = params.octreeDepth = 4;
        params.vdlCount = vdls;
        params.gridShift = shift;
        const bool isRing = QString(QTest::currentDataTag()).startsWith("leaves split");
        const auto scene = isRing ? std::make_shared<const Scene>(causticRing()) : scene_;
        if (isRing) params.photonCount = 200'000, params.octreeFirstDepth = params.octreeDepth = 5;
        auto octree = bakeOctree(scene, params);
        QVERIFY(octree && (!isRing || !octree->deeper().empty()));
        QFETCH(bool, asColours);
        if (asColours) octree = octree->showing(OctreeShow::colour);
        const auto gpu = makeGpuOctree(*octree);
        QVERIFY(gpu);
        auto renderer = Renderer::make(*gl_.gl);
        QVERIFY2(renderer, renderer ? "" : renderer.error().message.c_str());
        Renderer& draw = **renderer;
        QVERIFY(draw.setScene(makeDrawData(scene)));
        const auto shared = std::make_shared<GpuOctree>(*gpu);
        QVERIFY(asColours ? draw.setColours(shared) : draw.setOctree(shared));
        FrameView frame = viewOf(*scene, 0, kSize);
        if (asColours) frame.mode = ViewMode::colours;
        QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
        const auto shown = draw.illuminance(frame, true);
        const auto pixels = draw.readBack();
        Spread spread, twins;
        int missing = 0, surfaces = 0;
        double mean = 0.0;
        for (std::size_t i = 0; i < shown.size(); ++i) {
            if (pixels.position[i].w < 0.5f) continue;
            ++surfaces;
            glm::vec3 lux(0.0f);
            const bool known = octree->lookup(xyz(pixels.position[i]), xyz(pixels.normal[i]), lux);
            if (known != (shown[i].w > 0.5f)) ++missing;
            if (!known) continue;
            mean += luminance(lux);
            spread.errors.push_back(std::abs(double(luminance(xyz(shown[i]))) - luminance(lux)));
            const auto packed = packedIlluminance(*gpu, xyz(pixels.position[i]), xyz(pixels.normal[i]));
            QVERIFY(packed);
            twins.errors.push_back(std::abs(double(luminance(xyz(shown[i]))) - luminance(*packed)));
        }
        QVERIFY(surfaces > kSize.x * kSize.y / 2);
        mean /= double(spread.errors.size());
        // Halves carry 11 bits, directions 8 + 8: .79 degrees off at worst, which moves the cosine of one light by up
        // to 1.4 %; packing keeps the sum on an entry's own normal. Few pixels sit where rounding picks another entry.
        qInfo("%s: median %.2e, 99 %% below %.2e, worst %.2e of the mean %.3g lx; answers differ at %d of %d pixels",
              QTest::currentDataTag(), spread.median() / mean, spread.at(0.99) / mean, spread.at(1.0) / mean, mean,
              missing, surfaces);
        QVERIFY(spread.median() <= 1e-3 * mean);
        QVERIFY(spread.at(0.99) <= 1e-2 * mean);
        QVERIFY(missing <= surfaces / 1000);
        // the same arrays by the same text: what sine and cosine round differently, and one cell more or less at a face
        qInfo("against the arrays: median %.2e, 99.9 %% below %.2e, worst %.2e", twins.median() / mean,
              twins.at(0.999) / mean, twins.at(1.0) / mean);
        QVERIFY(twins.at(0.999) <= 1e-5 * mean);
        QVERIFY(twins.at(1.0) <= 1e-3 * mean);
    }

    void stripsAreThePicture() // glass and mirrors in it; to the bit, direct light that is refined later as well
    {
        const auto scene = std::make_shared<const Scene>(causticRing());
        BakeParams params;
        params.photonCount = 30'000;
        params.octreeFirstDepth = params.octreeDepth = 4;
        const auto octree = bakeOctree(scene, params);
        auto renderer = Renderer::make(*gl_.gl);
        QVERIFY(octree && renderer);
        Renderer& draw = **renderer;
        QVERIFY(draw.setScene(makeDrawData(scene)));
        QVERIFY(draw.setOctree(std::make_shared<GpuOctree>(*makeGpuOctree(*octree))));
        while (!draw.drawShadows(1000.0) || !draw.drawEnvironments(1000.0)) {
        }
        FrameView frame = viewOf(*scene, 0, kSize);
        frame.willRefine = true;
        const auto refined = [&] {
            for (int rounds = 0; rounds < 3;) rounds += draw.refine(frame) != Renderer::Refined::part ? 1 : 0;
            return draw.picture(2);
        };
        for (int i = 0; i < 2; ++i) QVERIFY(draw.draw(frame, i, kSize, gl_.target(), kSize));
        const auto whole = draw.picture(2), wholeRefined = refined();
        QVERIFY(draw.begin(frame, 0, kSize)); // and dropped
        QVERIFY(!draw.shade(0.01));
        for (int i = 0; i < 2; ++i) {
            QVERIFY(draw.begin(frame, i, kSize));
            int turns = 1;
            while (!draw.shade(0.01)) ++turns;
            QVERIFY2(turns > 10, qPrintable(QString::number(turns)));
        }
        const auto parts = draw.picture(2), partsRefined = refined();
        QVERIFY(whole.size() == parts.size() && whole == parts);
        QVERIFY(!(wholeRefined == whole));
        QVERIFY(wholeRefined == partsRefined);
    }

    void directComesNearTheExactOne()
    {
        auto renderer = Renderer::make(*gl_.gl);
        QVERIFY(renderer);
        Renderer& draw = **renderer;
        QVERIFY(draw.setScene(makeDrawData(scene_)));
        while (!draw.drawShadows(1000.0)) {
        }
        const FrameView frame = viewOf(*scene_, 0, kSize);
        QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
        const auto shown = draw.illuminance(frame, false);
        const auto pixels = draw.readBack();
        const auto rays = RayScene::build(scene_);
        QVERIFY(rays);
        const LightSampler lights(*rays);
        Spread spread;
        for (std::size_t i = 0; i < shown.size(); i += 7) {
            if (pixels.position[i].w < 0.5f) continue;
            Rng rng(1, 1, i);
            const glm::vec3 n = xyz(pixels.normal[i]), p = (*rays)->leave(xyz(pixels.position[i]), n);
            const float exact = luminance(directIlluminance(**rays, lights, {}, p, n, 64, rng));
            if (exact > 0.0f) spread.errors.push_back(std::abs(luminance(xyz(shown[i])) - exact) / double(exact));
        }
        qInfo("direct: median %.3f, 80 %% below %.3f", spread.median(), spread.at(0.8));
        QVERIFY(spread.errors.size() > 1000);
        QVERIFY(spread.median() <= 0.02);
        QVERIFY(spread.at(0.8) <= 0.08);
    }

    void dimmingDrawsNoShadowAgain()
    {
        auto renderer = Renderer::make(*gl_.gl);
        QVERIFY(renderer);
        Renderer& draw = **renderer;
        QVERIFY(draw.setScene(makeDrawData(scene_)));
        while (!draw.drawShadows(1000.0)) {
        }
        const int drawn = draw.shadowLayersDrawn();
        QVERIFY(drawn > 0);
        const FrameView frame = viewOf(*scene_, 0, kSize);
        QVERIFY(draw.draw(frame, 0, kSize, gl_.target(), kSize));
        const auto full = draw.illuminance(frame, false);
        draw.setMix(Mix(scene_->groups.size(), glm::vec3(0.5f)));
        QVERIFY(draw.drawShadows(1000.0));
        const auto half = draw.illuminance(frame, false);
        QCOMPARE(draw.shadowLayersDrawn(), drawn);
        double sumFull = 0.0, sumHalf = 0.0;
        for (std::size_t i = 0; i < full.size(); ++i) sumFull += full[i].y, sumHalf += half[i].y;
        QVERIFY(sumFull > 0.0);
        QVERIFY(std::abs(sumHalf / sumFull - 0.5) <= 1e-5);
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QGuiApplication application(argc, argv);
    OctreePixelsTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_octree_pixels.moc"
