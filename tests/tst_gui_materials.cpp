// SPDX-License-Identifier: Apache-2.0
// Claims: materials use the octree's lights. A normal map shows where all light is indirect, and not in a colour
// octree; a smooth metal mirrors its surroundings, lit by the octree, as rays from its middle see them; rough metals
// and modes without a bake have no environment map.
#include "core/base/units.h"
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/trace/material.h"
#include "gui_fixture.h"
#include "widgets/gl/gl_probe.h"
#include <QGuiApplication>
#include <QtTest>

using namespace lightloom;

namespace {

constexpr glm::ivec2 kSize{320, 240};

glm::vec3 xyz(glm::vec4 v) { return {v.x, v.y, v.z}; }

/// Waves along u as a normal map: normals lean by up to 45 degrees.
Image waves()
{
    Image image;
    image.width = image.height = 64;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            const float lean = std::sin(2.0f * kPi * static_cast<float>(x) / 16.0f);
            const glm::vec3 n = glm::normalize(glm::vec3(lean, 0.0f, 1.0f));
            for (const float c : {n.x, n.y, n.z}) {
                image.rgba.push_back(static_cast<std::uint8_t>(std::lround((0.5f + 0.5f * c) * 255.0f)));
            }
            image.rgba.push_back(255);
        }
    }
    return image;
}

/// A room 4 m wide, red on the left (-x), green on the right, blue behind (-z), lit from a lamp that shines at the
/// ceiling only.
SceneBuilder room()
{
    SceneBuilder b("room");
    const int grey = b.addMaterial("grey", glm::vec3(0.7f)), red = b.addMaterial("red", {0.7f, 0.05f, 0.05f}),
              green = b.addMaterial("green", {0.05f, 0.6f, 0.05f}), blue = b.addMaterial("blue", {0.1f, 0.1f, 0.8f});
    b.add("ceiling", quadMesh({-2, 4, -2}, {4, 0, 0}, {0, 0, 4}), grey);
    b.add("floor", quadMesh({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), grey);
    b.add("left", quadMesh({-2, 0, 2}, {0, 0, -4}, {0, 4, 0}), red);
    b.add("right", quadMesh({2, 0, -2}, {0, 0, 4}, {0, 4, 0}), green);
    b.add("back", quadMesh({-2, 0, -2}, {4, 0, 0}, {0, 4, 0}), blue);
    b.add("front", quadMesh({2, 0, 2}, {-4, 0, 0}, {0, 4, 0}), grey);
    b.addSpot("lamp", {0, 3.2f, 0}, {0, 4, 0}, glm::vec3(3000.0f), 1.0f, 1.1f);
    return b;
}

} // namespace

class GuiMaterialsTest : public QObject {
    Q_OBJECT
    GlFixture gl_;

    struct Drawn {
        Renderer::Pixels pixels;
        std::vector<glm::vec4> illuminance;
    };
    struct Stage {
        std::shared_ptr<const Scene> scene;
        std::shared_ptr<const LightOctree> octree;
        std::unique_ptr<Renderer> renderer;
    };
    Stage stageOf(Scene made)
    {
        Stage stage;
        stage.scene = std::make_shared<const Scene>(std::move(made));
        BakeParams params;
        params.photonCount = 100'000;
        params.gatherCount = 150;
        params.octreeFirstDepth = params.octreeDepth = 5;
        stage.octree = bakeOctree(stage.scene, params);
        auto renderer = Renderer::make(*gl_.gl);
        if (!stage.octree || !renderer) qFatal("no bake or no renderer");
        stage.renderer = std::move(*renderer);
        const auto gpu = makeGpuOctree(*stage.octree),
                   colours = makeGpuOctree(*stage.octree->showing(OctreeShow::colour));
        const bool isSet = stage.renderer->setScene(makeDrawData(stage.scene)) &&
                           stage.renderer->setOctree(std::make_shared<GpuOctree>(*gpu)) &&
                           stage.renderer->setColours(std::make_shared<GpuOctree>(*colours));
        if (!isSet) qFatal("not uploaded");
        while (!stage.renderer->drawShadows(1000.0)) {
        }
        while (!stage.renderer->drawEnvironments(1000.0)) {
        }
        return stage;
    }
    Drawn draw(Stage& stage, ViewMode mode, bool indirectOnly)
    {
        FrameView frame = viewOf(*stage.scene, 0, kSize);
        frame.mode = mode;
        frame.indirectOnly = indirectOnly;
        if (!stage.renderer->draw(frame, 0, kSize, gl_.target(), kSize)) qFatal("not drawn");
        Drawn drawn;
        drawn.pixels = stage.renderer->readBack();
        drawn.illuminance = stage.renderer->illuminance(frame, true);
        return drawn;
    }
    /// Spread of the light over mean, over pixels of a surface that `isMine` names.
    template<class IsMine>
    static double contrast(const Drawn& drawn, const IsMine& isMine)
    {
        double sum = 0.0, squares = 0.0;
        int count = 0;
        for (std::size_t i = 0; i < drawn.pixels.light.size(); ++i) {
            if (drawn.pixels.position[i].w < 0.5f || !isMine(xyz(drawn.pixels.position[i]))) continue;
            const auto l = static_cast<double>(luminance(xyz(drawn.pixels.light[i])));
            sum += l, squares += l * l, ++count;
        }
        const double mean = sum / count;
        return std::sqrt(std::max(0.0, squares / count - mean * mean)) / mean;
    }

private Q_SLOTS:
    void initTestCase() { QVERIFY(gl_.start(kSize)); }

    void bumpsShowUnderIndirectLight()
    {
        const auto made = [&](bool isBumpy) {
            SceneBuilder b = room();
            Material material;
            material.name = "panel";
            material.metallic = 0.0f;
            material.baseColor = glm::vec4(0.6f, 0.6f, 0.6f, 1.0f);
            if (isBumpy) material.normalTexture.image = b.addImage(waves());
            // a panel before the back wall, lit from ceiling, red and green side
            b.add("panel", texturedQuadMesh({-1, 1, -1.8f}, {2, 0, 0}, {0, 2, 0}), b.addMaterial(material));
            b.addCamera("front", {0, 2, 1.5f}, {0, 2, -2}, 40.0f);
            return b.finish();
        };
        Stage flat = stageOf(made(false)), bumpy = stageOf(made(true));
        const auto onPanel = [](glm::vec3 p) { // its middle: edges are another matter
            return std::abs(p.z + 1.8f) < 0.01f && std::abs(p.x) < 0.7f && std::abs(p.y - 2.0f) < 0.7f;
        };
        const double plain = contrast(draw(flat, ViewMode::octree, true), onPanel),
                     bumps = contrast(draw(bumpy, ViewMode::octree, true), onPanel),
                     colours = contrast(draw(bumpy, ViewMode::colours, true), onPanel);
        qInfo("contrast of the panel under indirect light: flat %.3f, bumpy %.3f, bumpy in a colour octree %.3f", plain,
              bumps, colours);
        // variances add: what the bumps bring beside the panel's own gradient
        QVERIFY(bumps * bumps - plain * plain >= 0.15 * 0.15);
        QVERIFY(std::abs(colours * colours - plain * plain) <= 0.03 * 0.03);
        // the lamp sends nothing there itself
        const Drawn direct = draw(bumpy, ViewMode::direct, false);
        double straight = 0.0, indirect = 0.0;
        const Drawn all = draw(bumpy, ViewMode::octree, true);
        for (std::size_t i = 0; i < all.pixels.light.size(); ++i) {
            if (all.pixels.position[i].w < 0.5f || !onPanel(xyz(all.pixels.position[i]))) continue;
            straight += static_cast<double>(luminance(xyz(direct.pixels.light[i])));
            indirect += static_cast<double>(luminance(xyz(all.pixels.light[i])));
        }
        QVERIFY(straight <= 1e-6 * indirect);
    }

    void smoothMetalsMirrorTheRoom()
    {
        SceneBuilder b = room();
        b.add("ball", sphereMesh({0, 2, 0}, 0.4f, 32), b.addMetal("steel", glm::vec3(0.9f), 0.06f));
        b.addCamera("front", {0, 2, 1.8f}, {0, 2, -2}, 40.0f);
        Stage stage = stageOf(b.finish());
        QCOMPARE(stage.renderer->environmentCount(), 1);
        const Drawn drawn = draw(stage, ViewMode::octree, true);
        const auto rays = RayScene::build(stage.scene);
        QVERIFY(rays);
        const glm::vec3 centre(0, 2, 0);
        std::vector<double> errors;
        double mean = 0.0;
        for (std::size_t i = 0; i < drawn.pixels.light.size(); i += 3) {
            const glm::vec3 p = xyz(drawn.pixels.position[i]), n = xyz(drawn.pixels.normal[i]);
            const glm::vec3 eye(0, 2, 1.8f), toEye = glm::normalize(eye - p);
            const bool isBall = drawn.pixels.position[i].w > 0.5f && glm::length(p - centre) < 0.41f;
            if (!isBall || glm::dot(n, toEye) < 0.5f) continue;
            // what a ray from the middle of the ball meets outside it
            Hit hit;
            const glm::vec3 away = glm::reflect(-toEye, n);
            if (!(*rays)->intersect(centre + 0.45f * away, away, 100.0f, hit)) continue;
            glm::vec3 lux(0.0f);
            if (!stage.octree->lookup(hit.position, hit.facing(), lux)) continue;
            if (hit.position.y > 3.9f) continue; // the ceiling has direct light as well
            const glm::vec3 seen = surfaceAt(**rays, hit).diffuse / kPi * lux;
            const float out = 1.0f - glm::dot(n, toEye);
            const glm::vec3 expected = seen * (0.9f + 0.1f * std::pow(out, 5.0f));
            errors.push_back(static_cast<double>(glm::length(xyz(drawn.pixels.light[i]) - expected)));
            mean += static_cast<double>(glm::length(expected));
        }
        QVERIFY(errors.size() > 300);
        mean /= static_cast<double>(errors.size());
        std::ranges::sort(errors);
        const double median = errors[errors.size() / 2] / mean, most = errors[errors.size() * 9 / 10] / mean;
        qInfo("mirrored room at %zu pixels: median error %.3f, 90 %% below %.3f of the mean", errors.size(), median,
              most);
        // whichever way the octree is shown, a mirror shows the same
        const Drawn colours = draw(stage, ViewMode::colours, true);
        for (std::size_t i = 0; i < drawn.pixels.light.size(); ++i) {
            if (drawn.pixels.position[i].w < 0.5f || glm::length(xyz(drawn.pixels.position[i]) - centre) > 0.41f)
                continue;
            QCOMPARE(colours.pixels.light[i], drawn.pixels.light[i]);
        }
        QVERIFY(median <= 0.05);
        QVERIFY(most <= 0.25); // texels of the map across edges of the room
    }

    void roughMetalsKeepTheirLights()
    {
        SceneBuilder b = room();
        b.add("ball", sphereMesh({0, 2, 0}, 0.4f, 32), b.addMetal("brushed", glm::vec3(0.9f), 0.5f));
        b.addCamera("front", {0, 2, 1.8f}, {0, 2, -2}, 40.0f);
        Stage stage = stageOf(b.finish());
        QCOMPARE(stage.renderer->environmentCount(), 0);
        const Drawn drawn = draw(stage, ViewMode::octree, true);
        const std::size_t middle = static_cast<std::size_t>(kSize.x) * static_cast<std::size_t>(kSize.y / 2) +
                                   static_cast<std::size_t>(kSize.x / 2);
        QVERIFY(luminance(xyz(drawn.pixels.light[middle])) > 0.0f); // its virtual lights
    }

    void mapsAreDrawnAFewFacesAtATime()
    {
        SceneBuilder b = room();
        for (int i = 0; i < 6; ++i) {
            b.add("ball" + std::to_string(i), sphereMesh({-1.5f + 0.6f * float(i), 1, 0}, 0.1f + 0.02f * float(i), 16),
                  b.addMetal("steel", glm::vec3(0.9f), 0.06f));
        }
        b.addCamera("front", {0, 2, 1.8f}, {0, 2, -2}, 60.0f);
        Stage stage = stageOf(b.finish());
        QCOMPARE(stage.renderer->environmentCount(), EnvironmentMaps::kMost);
        stage.renderer->setMix({});
        int slices = 1;
        while (!stage.renderer->drawEnvironments(0.0)) ++slices;
        QCOMPARE(slices, 6 * EnvironmentMaps::kMost); // a face each: as little as can be
        QVERIFY(stage.renderer->drawEnvironments(0.0));
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QGuiApplication application(argc, argv);
    GuiMaterialsTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_materials.moc"
