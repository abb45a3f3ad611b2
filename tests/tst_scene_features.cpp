// SPDX-License-Identifier: Apache-2.0
// Claims about looking a scene over: counts and units are right, closed is told from open, the thinnest wall is found,
// and what follows names the work that is skipped.
#include "core/base/units.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/mesh_closed.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_features.h"
#include <QElapsedTimer>
#include <QtTest>

using namespace lightloom;

namespace {

bool says(const SceneFeatures& f, const char* part)
{
    return std::any_of(f.follows.begin(), f.follows.end(),
                       [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

/// Axis-aligned box that faces outward; vertices doubled per face, as exporters write them, and moved by up to
/// `jitter`.
Mesh box(glm::vec3 low, glm::vec3 high, float jitter = 0.0f)
{
    Mesh mesh;
    const glm::vec3 centre = 0.5f * (low + high), half = 0.5f * (high - low);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            glm::vec3 n(0.0f), u(0.0f), v(0.0f);
            n[axis] = side;
            const glm::vec3 tear(jitter * static_cast<float>(2 * axis) + jitter * side); // another for each face
            u[(axis + 1) % 3] = side;
            v[(axis + 2) % 3] = 1.0f;
            const auto first = static_cast<unsigned>(mesh.positions.size());
            for (const glm::vec2 c : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
                mesh.positions.push_back(centre + half * (n + c.x * u + c.y * v) + tear);
            }
            mesh.triangles.emplace_back(first, first + 1, first + 2);
            mesh.triangles.emplace_back(first, first + 2, first + 3);
        }
    }
    return mesh;
}

Scene sceneOf(std::vector<Mesh> meshes)
{
    Scene scene;
    scene.materials.emplace_back().metallic = 0.0f;
    scene.meshes = std::move(meshes);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        Instance instance;
        instance.mesh = static_cast<int>(i);
        instance.node = "node " + std::to_string(i);
        scene.instances.push_back(instance);
    }
    finishScene(scene, {});
    return scene;
}

} // namespace

class SceneFeaturesTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void closedIsToldFromOpen()
    {
        Mesh open = box({2, 0, 0}, {3, 1, 1});
        open.triangles.pop_back();
        Mesh turned = box({4, 0, 0}, {5, 1, 1}); // one triangle the other way round: no body
        std::swap(turned.triangles[0].y, turned.triangles[0].z);
        const SceneFeatures mixed = findFeatures(sceneOf({box({0, 0, 0}, {1, 1, 1}), open, turned}));
        QCOMPARE(mixed.bodies, 3u);
        QCOMPARE(mixed.closedBodies, 1u);
        QVERIFY(mixed.isWatertight && !*mixed.isWatertight);
        QVERIFY(says(mixed, "do not close"));
        const SceneFeatures furnace = findFeatures(furnaceBox(0.5f));
        QVERIFY(furnace.isWatertight && *furnace.isWatertight);
        QVERIFY(says(furnace, "no light escapes"));
    }

    void sizeAndRoundingDoNotOpenABody_data()
    {
        QTest::addColumn<float>("size");
        for (const float size : {1e-4f, 1.0f, 1e5f}) QTest::addRow("%g m", static_cast<double>(size)) << size;
    }
    void sizeAndRoundingDoNotOpenABody()
    {
        QFETCH(float, size);
        const Mesh mesh = box({0.1f * size, 0, 0}, {1.1f * size, size, size}, 1e-6f * size);
        QCOMPARE(findFeatures(sceneOf({mesh})).closedBodies, 1u);
        const Mesh torn = box({0, 0, 0}, {size, size, size}, 1e-3f * size);
        QCOMPARE(findFeatures(sceneOf({torn})).closedBodies, 0u);
    }

    void weldingJoinsAcrossCells()
    {
        std::vector<glm::vec3> points; // pairs 0.9 tolerances apart, on and around every kind of cell border
        for (int i = 0; i < 1000; ++i) {
            const auto x = 0.1f * static_cast<float>(i);
            points.push_back({x, 0, 0});
            points.push_back({x + 0.0009f, 0, 0});
        }
        const auto standIn = weldVertices(points, 0.001f);
        for (std::size_t i = 0; i < points.size(); ++i) QCOMPARE(standIn[i], static_cast<std::uint32_t>(i / 2 * 2));
    }

    void thinnestWallIsFound_data()
    {
        QTest::addColumn<float>("thickness");
        for (const float t : {0.5f, 0.1f, 0.01f}) QTest::addRow("%g", static_cast<double>(t)) << t;
    }
    void thinnestWallIsFound()
    {
        QFETCH(float, thickness);
        Scene scene = sceneOf({box({0, 0, 0}, {4, 3, 1}), box({6, 0, 0}, {6 + thickness, 3, 4})});
        scene.instances[1].toWorld[0] = glm::vec4(-1, 0, 0, 0); // mirrored: still a body with an inside
        const ThinWallSearch walls = findThinWalls(scene);
        QCOMPARE(walls.samples, 4096);
        QVERIFY(walls.thinnest);
        QVERIFY2(std::abs(walls.thinnest->thickness - thickness) <= 1e-5f,
                 qPrintable(QString::number(walls.thinnest->thickness)));
        const float at = walls.thinnest->at.x;
        QVERIFY(std::abs(at + 6) <= 1e-5f || std::abs(at + 6 + thickness) <= 1e-5f);
    }

    void twoRoomsHaveTheirWall()
    {
        Scene scene = twoRooms();
        const SceneFeatures furnished = findFeatures(scene);
        QVERIFY(furnished.walls.thinnest); // the foot of the floor lamp: a 12-sided bar, 0.04 m from edge to edge
        const double foot = 0.04 * std::cos(std::acos(-1.0) / 12.0);
        QVERIFY2(std::abs(static_cast<double>(furnished.walls.thinnest->thickness) - foot) <= 1e-5,
                 qPrintable(QString::number(furnished.walls.thinnest->thickness)));
        QVERIFY(furnished.isWatertight && *furnished.isWatertight);
        std::erase_if(scene.instances, [](const Instance& i) { return !i.node.starts_with("Rooms/"); });
        const SceneFeatures bare = findFeatures(scene);
        QVERIFY(bare.walls.thinnest);
        QVERIFY2(std::abs(bare.walls.thinnest->thickness - 0.2f) <= 1e-5f,
                 qPrintable(QString::number(bare.walls.thinnest->thickness)));
    }

    void bodiesThatStandInEachOtherAreNoWalls()
    {
        // a column sunk 5 mm into a slab and reaching into a beam: what is sunk is no wall, the three bodies are
        const ThinWallSearch walls = findThinWalls(sceneOf(
            {box({0, 0, 0}, {4, 1, 4}), box({1, 0.995f, 1}, {3, 2.005f, 3}), box({0.5f, 2, 0.5f}, {3.5f, 3, 3.5f})}));
        QVERIFY(walls.thinnest);
        QVERIFY2(walls.thinnest->thickness >= 0.99f, qPrintable(QString::number(walls.thinnest->thickness)));
    }

    void sheetsAreNoWalls()
    {
        const SceneFeatures f = findFeatures(litCube(0.5f)); // faces inward, nothing behind
        QCOMPARE(f.walls.samples, 4096);
        QVERIFY(!f.walls.thinnest);
    }

    void lampsAndUnits()
    {
        Scene scene = sceneOf({box({0, 0, 0}, {1, 1, 1})});
        const auto lamp = [&](PunctualLight::Kind kind, glm::vec3 intensity) {
            PunctualLight light;
            light.kind = kind;
            light.intensity = intensity;
            light.node = "lamp " + std::to_string(scene.lights.size());
            scene.lights.push_back(light);
        };
        lamp(PunctualLight::Kind::point, glm::vec3(10));
        lamp(PunctualLight::Kind::spot, {0, 1000, 0});
        lamp(PunctualLight::Kind::directional, glm::vec3(5000));
        lamp(PunctualLight::Kind::point, glm::vec3(0));
        scene.materials[0].emission = glm::vec3(340, 238, 80);
        finishScene(scene, {});
        const SceneFeatures f = findFeatures(scene);
        QVERIFY(f.pointLamps == 2 && f.spotLamps == 1 && f.suns == 1 && f.darkLamps == 1 && f.glowingInstances == 1);
        QVERIFY(std::abs(f.candela->least - 10.0f) <= 1e-4f && std::abs(f.candela->most - 715.2f) <= 1e-3f);
        QVERIFY(std::abs(f.lux->most - 5000.0f) <= 1e-2f);
        QVERIFY(std::abs(f.luminance->most - luminance({340, 238, 80})) <= 1e-3f);
        QVERIFY(std::abs(f.area - 6.0) <= 1e-6);
        QVERIFY(says(f, "1 of the lamps give no light") && says(f, "5 light groups"));
    }

    void whatIsAbsentIsSkipped()
    {
        Scene scene = sceneOf({box({0, 0, 0}, {1, 1, 1})});
        QVERIFY(says(findFeatures(scene), "nothing is shot"));
        scene.materials[0].emission = glm::vec3(1);
        finishScene(scene, {});
        const SceneFeatures plain = findFeatures(scene);
        QVERIFY(says(plain, "no caustic photons") && says(plain, "No textures") && says(plain, "No cut-outs"));
        scene.materials[0].metallic = 1.0f;
        scene.materials[0].roughness = 0.0f;
        scene.materials[0].alpha = Material::Alpha::mask;
        scene.materials.emplace_back().metallic = 1.0f; // nobody wears it
        const SceneFeatures mirror = findFeatures(scene);
        QVERIFY(mirror.hasMirrors && !mirror.hasGlossyMetal && mirror.materials == 1);
        QVERIFY(!says(mirror, "no caustic photons") && says(mirror, "followed as caustics") &&
                !says(mirror, "No cut-outs"));
        scene.materials[0].roughness = 0.3f;
        const SceneFeatures glossy = findFeatures(scene);
        QVERIFY(!glossy.hasMirrors && glossy.hasGlossyMetal);
        scene.materials[0].transmission = 1.0f; // metal all the same: nothing gets through
        QVERIFY(!findFeatures(scene).hasGlass && !findFeatures(scene).hasPanes);
        scene.materials[0].metallic = 0.0f;
        const SceneFeatures pane = findFeatures(scene);
        QVERIFY(pane.hasPanes && !pane.hasGlass && pane.hasSpecular() && says(pane, "Thin panes"));
        scene.materials[0].thickness = 0.1f;
        const SceneFeatures glass = findFeatures(scene);
        QVERIFY(glass.hasGlass && !glass.hasPanes && says(glass, "Solid glass") && !says(glass, "no caustic photons"));
    }

    void largeScenesTakeSeconds()
    {
        const Result<Scene> scene = figureScene(400'000);
        QVERIFY(scene);
        QElapsedTimer clock;
        clock.start();
        const SceneFeatures f = findFeatures(*scene);
        qInfo("%llu triangles looked over in %lld ms", static_cast<unsigned long long>(f.triangles), clock.elapsed());
        QVERIFY(f.triangles >= 399'999 && f.triangles <= 400'000);
        QVERIFY2(clock.elapsed() < 20'000, "it took longer than 20 s");
        QVERIFY(f.closedBodies >= 1);
    }

    void emptySceneIsNoTrouble()
    {
        const SceneFeatures f = findFeatures(Scene{});
        QVERIFY(f.triangles == 0 && f.bodies == 0 && !f.walls.thinnest && f.emitters() == 0);
    }
};

QTEST_GUILESS_MAIN(SceneFeaturesTest)
#include "tst_scene_features.moc"
