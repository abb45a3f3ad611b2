// SPDX-License-Identifier: Apache-2.0
// Claim: the octree rendered into the atlas by the GPU is the lightmap that the CPU makes of the same arrays, padding
// included; a frame through it shows the octree's light on each side of each surface; the window unwraps a scene by
// itself when the mode is chosen, and lamps that are dimmed dim it.
#include "core/atlas/lightmap.h"
#include "core/bake/packed_octree.h"
#include "core/base/units.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "gui_fixture.h"
#include "tests/atlas_helpers.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/scene_dock.h"
#include "widgets/snapshot_bar.h"
#include "window_helpers.h"
#include <QApplication>
#include <QLabel>
#include <QSlider>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr glm::ivec2 kSize{320, 240};

glm::vec3 xyz(glm::vec4 v) { return {v.x, v.y, v.z}; }

/// The texture arrays as a field.
class PackedField final : public IndirectField {
public:
    explicit PackedField(const GpuOctree& octree) : octree_(octree) {}
    bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override
    {
        const auto found = packedIlluminance(octree_, p, n);
        lux = found.value_or(glm::vec3(0.0f));
        return found.has_value();
    }
    std::shared_ptr<const IndirectField> withMix(Mix) const override { return nullptr; }
    std::string_view method() const override { return "packed"; }
    std::size_t memoryBytes() const override { return 0; }

private:
    const GpuOctree& octree_;
};

double quantile(std::vector<double> values, double share)
{
    std::ranges::sort(values);
    return values.empty() ? 1e30 : values[static_cast<std::size_t>(share * double(values.size() - 1))];
}

/// A double-sided sheet across a room, lit from above; the camera is below it.
Scene sheetFromBelow()
{
    SceneBuilder builder("sheet");
    builder.add("Room", boxMesh(glm::vec3(-2), glm::vec3(2), Facing::in), builder.addMaterial("grey", glm::vec3(0.5f)));
    Material paper;
    paper.metallic = 0.0f;
    paper.doubleSided = true;
    paper.baseColor = glm::vec4(0.5f, 0.5f, 0.5f, 1.0f);
    builder.add("Sheet", quadMesh({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), builder.addMaterial(paper));
    builder.addPoint("Lamp", {1.5f, 1.6f, 1.5f}, glm::vec3(100.0f));
    builder.addCamera("Below", {0.2f, -1.7f, 0.1f}, {0, 0, 0.05f}, 80.0f);
    return builder.finish();
}

} // namespace

class GuiAtlasTest : public QObject {
    Q_OBJECT
    GlFixture gl_;

    /// A renderer with a scene, its bake and its atlas, all of its light rendered.
    struct Shown {
        Shown(GlFixture& gl, Scene built, int size) : u(std::move(built), {size})
        {
            BakeParams params;
            params.photonCount = 60'000;
            params.gatherCount = 100;
            params.octreeFirstDepth = params.octreeDepth = 4;
            octree = bakeOctree(u.lit.scene, params);
            auto made = Renderer::make(*gl.gl);
            if (!octree || !u.atlas || !made) qFatal("no bake, no atlas or no OpenGL");
            gpu = std::make_shared<GpuOctree>(*makeGpuOctree(*octree));
            renderer = std::move(*made);
            if (!renderer->setScene(makeDrawData(u.lit.scene)) || !renderer->setOctree(gpu) ||
                !renderer->setAtlas(makeAtlasDraw(*u.lit.rays, *u.atlas))) {
                qFatal("the renderer refused");
            }
            while (!renderer->renderAtlas(5.0)) ++slices;
        }
        Unwrapped u;
        std::shared_ptr<const LightOctree> octree;
        std::shared_ptr<GpuOctree> gpu;
        std::unique_ptr<Renderer> renderer;
        int slices = 0;
    };

private Q_SLOTS:
    void initTestCase()
    {
        if (const Result<Done> gl = probeGl(); !gl) QSKIP(gl.error().message.c_str());
        QVERIFY(gl_.start(kSize));
    }

    void gpuAndCpuFillTheSameLightmap_data()
    {
        QTest::addColumn<QString>("name");
        for (const char* name : {"cornell", "sheet"}) QTest::newRow(name) << name;
    }
    void gpuAndCpuFillTheSameLightmap()
    {
        QFETCH(QString, name);
        Shown shown(gl_, name == "sheet" ? sheetFromBelow() : cornellBox(), 256);
        QVERIFY(shown.slices > 2); // in pieces, as frames allow
        const std::vector<glm::vec4> lit = shown.renderer->readAtlas();
        const Atlas& atlas = *shown.u.atlas;
        QCOMPARE(lit.size(), atlas.texelCount());
        Workers workers(2);
        const PackedField field(*shown.gpu);
        const auto twin = bakeLightmap(*shown.u.lit.rays, atlas, &field, {}, workers, {});
        const auto exact = bakeLightmap(*shown.u.lit.rays, atlas, shown.octree.get(), {}, workers, {});
        QVERIFY(twin && exact);
        double mean = 0.0;
        int owned = 0, unknown = 0;
        std::vector<double> fromTwin, fromExact;
        for (std::size_t i = 0; i < lit.size(); ++i) {
            if (atlas.owners[i] < 0) {
                QVERIFY(lit[i].w < 0.5f);
                continue;
            }
            ++owned;
            if (lit[i].w < 0.5f) {
                ++unknown;
                QCOMPARE(twin->pixels[i], glm::vec3(0.0f)); // a chart without any answer
                continue;
            }
            mean += luminance(twin->pixels[i]);
            fromTwin.push_back(double(glm::length(xyz(lit[i]) - twin->pixels[i])));
            fromExact.push_back(double(glm::length(xyz(lit[i]) - exact->pixels[i])));
        }
        mean /= owned;
        qInfo("of the mean %.3g lx: twin median %.1e, 99.9 %% %.1e; exact median %.1e, 99 %% %.1e; %d of %d without "
              "light",
              mean, quantile(fromTwin, 0.5) / mean, quantile(fromTwin, 0.999) / mean, quantile(fromExact, 0.5) / mean,
              quantile(fromExact, 0.99) / mean, unknown, owned);
        QVERIFY(owned > 20'000 && unknown < owned / 100);
        QVERIFY(quantile(fromTwin, 0.999) <= 1e-5 * mean); // a leaf more or less where rounding decides
        QVERIFY(quantile(fromExact, 0.5) <= 1e-3 * mean);  // packing: see tst_gui_octree_pixels
        QVERIFY(quantile(fromExact, 0.99) <= 1e-2 * mean);
    }

    void framesReadTheirOwnSide_data() { gpuAndCpuFillTheSameLightmap_data(); }
    void framesReadTheirOwnSide()
    {
        QFETCH(QString, name);
        Shown shown(gl_, name == "sheet" ? sheetFromBelow() : cornellBox(), 512);
        FrameView frame = viewOf(*shown.u.lit.scene, 0, kSize);
        frame.mode = ViewMode::atlas;
        QVERIFY(shown.renderer->draw(frame, 0, kSize, gl_.target(), kSize));
        const auto lit = shown.renderer->illuminance(frame, true);
        const auto pixels = shown.renderer->readBack();
        double mean = 0.0;
        int surfaces = 0, known = 0;
        std::vector<double> errors;
        for (std::size_t i = 0; i < lit.size(); ++i) {
            glm::vec3 lux(0.0f);
            if (pixels.position[i].w < 0.5f) continue;
            ++surfaces;
            if (lit[i].w < 0.5f) continue;
            ++known;
            if (!shown.octree->lookup(xyz(pixels.position[i]), xyz(pixels.normal[i]), lux)) continue;
            mean += luminance(lux);
            errors.push_back(std::abs(double(luminance(xyz(lit[i]))) - luminance(lux)));
        }
        mean /= double(errors.size());
        qInfo("median %.1e, 95 %% below %.1e of the mean; %d of %d pixels", quantile(errors, 0.5) / mean,
              quantile(errors, 0.95) / mean, known, surfaces);
        QVERIFY(surfaces > 10'000);
        QVERIFY(known >= surfaces - surfaces / 200); // where two surfaces meet in a pixel neither may be near enough
        QVERIFY(quantile(errors, 0.5) <= 1e-3 * mean);
        QVERIFY(quantile(errors, 0.95) <= 1e-2 * mean);
        // no pixel gets light twice, from surfaces that meet there
        QVERIFY2(quantile(errors, 0.999) <= 0.3 * mean, qPrintable(QString::number(quantile(errors, 0.999) / mean)));
    }

    /// Without directions a metal cannot shine; it is lit like paint of its colour, as in a colour octree.
    void roughMetalsAreLit()
    {
        SceneBuilder builder("metal");
        builder.add("Room", boxMesh(glm::vec3(-2), glm::vec3(2), Facing::in),
                    builder.addMaterial("grey", glm::vec3(0.6f)));
        Material metal;
        metal.metallic = 1.0f;
        metal.roughness = 0.6f;
        metal.baseColor = glm::vec4(0.8f, 0.6f, 0.3f, 1.0f);
        builder.add("Block", boxMesh({-0.8f, -2.0f, -0.8f}, {0.8f, -0.6f, 0.8f}), builder.addMaterial(metal));
        builder.addPoint("Lamp", {1.5f, 1.6f, 1.5f}, glm::vec3(100.0f));
        builder.addCamera("Front", {0.5f, 0.2f, 1.9f}, {0, -1.2f, 0}, 70.0f);
        Shown shown(gl_, builder.finish(), 256);
        const auto colours = makeGpuOctree(*shown.octree->showing(OctreeShow::colour));
        QVERIFY(colours && shown.renderer->setColours(std::make_shared<GpuOctree>(*colours)));
        FrameView frame = viewOf(*shown.u.lit.scene, 0, kSize);
        frame.indirectOnly = true;
        const auto lightIn = [&](ViewMode mode) {
            frame.mode = mode;
            if (!shown.renderer->draw(frame, 0, kSize, gl_.target(), kSize)) qFatal("not drawn");
            const auto pixels = shown.renderer->readBack();
            double sum = 0.0;
            int count = 0;
            for (std::size_t i = 0; i < pixels.light.size(); ++i) {
                const glm::vec3 p = xyz(pixels.position[i]);
                if (pixels.position[i].w < 0.5f || glm::max(std::abs(p.x), std::abs(p.z)) > 0.81f) continue;
                if (p.y > -0.59f || p.y < -1.99f) continue;
                sum += static_cast<double>(luminance(xyz(pixels.light[i])));
                ++count;
            }
            return count > 1000 ? sum / count : -1.0;
        };
        const double atlas = lightIn(ViewMode::atlas), painted = lightIn(ViewMode::colours);
        QVERIFY2(painted > 0.0 && std::abs(atlas / painted - 1.0) < 0.05,
                 qPrintable(QString("%1 cd/m2 for %2").arg(atlas).arg(painted)));
    }

    void windowUnwrapsWhenAsked()
    {
        const auto window = makeWindow();
        QVERIFY(openAndBake(*window));
        Viewport& viewport = *window->viewport();
        QVERIFY(!viewport.hasAtlas());
        QTest::keyClick(window.get(), Qt::Key_3, Qt::AltModifier);
        QCOMPARE(viewport.mode(), ViewMode::atlas);
        const auto labels = window->findChildren<QLabel*>();
        QVERIFY(std::ranges::any_of(labels, [](const QLabel* l) { return l->text().startsWith("Unwrapping"); }));
        QTRY_VERIFY_WITH_TIMEOUT(viewport.hasAtlas(), kPatience);
        QVERIFY(settle(viewport));
        const QImage bright = viewport.grabFramebuffer();
        const std::uint64_t before = window->snapshots().shown()->lookSerial;
        auto* slider = window->sceneDock().findChild<QSlider*>();
        slider->setValue(slider->maximum() / 8);
        QTRY_VERIFY_WITH_TIMEOUT(window->snapshots().shown()->lookSerial > before, kPatience);
        QVERIFY(settle(viewport));
        const QImage dim = viewport.grabFramebuffer();
        const auto level = [](const QImage& image) {
            double sum = 0.0;
            for (int y = 0; y < image.height(); y += 7) {
                for (int x = 0; x < image.width(); x += 7) sum += qGray(image.pixel(x, y));
            }
            return sum;
        };
        QVERIFY2(level(dim) < 0.8 * level(bright), qPrintable(QString::number(level(dim) / level(bright))));
        // another scene has another atlas
        QVERIFY(openAndBake(*window, sampleFile("two_rooms")));
        QTRY_VERIFY_WITH_TIMEOUT(viewport.hasAtlas(), kPatience);
        QVERIFY(settle(viewport));
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QApplication application(argc, argv);
    GuiAtlasTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_atlas.moc"
