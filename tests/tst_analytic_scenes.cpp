// SPDX-License-Identifier: Apache-2.0
// Claim: the scenes whose light we know have the shape their formulas need: areas, volumes, closedness, facing and
// emitted flux; and the body builders they stand on are closed and face where they say.
#include "core/base/units.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "tests/scene_checks.h"
#include <QtTest>
#include <numbers>

using namespace lightloom;
using namespace lightloom::test;

Q_DECLARE_METATYPE(lightloom::Mesh)
Q_DECLARE_METATYPE(lightloom::Scene)

class AnalyticScenesTest : public QObject {
    Q_OBJECT

    static void near(double got, double wanted, double tolerance, const char* what)
    {
        const double error = std::abs(got - wanted) / std::max(std::abs(wanted), 1e-30);
        QVERIFY2(error <= tolerance, qPrintable(QString("%1: %2, wanted %3").arg(what).arg(got).arg(wanted)));
    }
    static double pointFlux(const Scene& scene)
    {
        double sum = 0.0;
        for (const PunctualLight& light : scene.lights) sum += 4.0 * std::numbers::pi * light.intensity.x;
        return sum;
    }
    static Scene sceneOf(Mesh mesh)
    {
        SceneBuilder builder("body");
        const int grey = builder.addMaterial("grey", glm::vec3(0.5f));
        builder.add("Body", std::move(mesh), grey);
        return builder.finish();
    }

private Q_SLOTS:
    void bodiesAreClosedAndFaceOut_data()
    {
        QTest::addColumn<Mesh>("mesh");
        QTest::addColumn<double>("wantedArea");
        QTest::addColumn<double>("wantedVolume");
        QTest::addColumn<double>("tolerance");
        const double pi = std::numbers::pi;
        QTest::newRow("box") << boxMesh({-1, 0, 2}, {1, 3, 6}) << 52.0 << 24.0 << 1e-6;
        QTest::newRow("box, facing in") << boxMesh({-1, 0, 2}, {1, 3, 6}, Facing::in) << 52.0 << -24.0 << 1e-6;
        QTest::newRow("sphere") << sphereMesh({1, 2, 3}, 2, 64) << 16 * pi << 32 * pi / 3 << 2e-3;
        QTest::newRow("sphere, facing in")
            << sphereMesh({1, 2, 3}, 2, 64, Facing::in) << 16 * pi << -32 * pi / 3 << 2e-3;
        QTest::newRow("coarsest sphere") << sphereMesh({0, 0, 0}, 1, 2) << 4 * std::sqrt(3.0) << 4.0 / 3 << 1e-6;
        QTest::newRow("cylinder") << cylinderMesh({1, 0, 2}, 0.5f, 4, 200) << 4.5 * pi << pi << 1e-3;
        QTest::newRow("torus") << torusMesh({0, 1, 0}, {0, 0, 1}, 2, 0.5f, 200, 100) << 4 * pi * pi << pi * pi << 2e-3;
    }
    void bodiesAreClosedAndFaceOut()
    {
        QFETCH(Mesh, mesh);
        QFETCH(double, wantedArea);
        QFETCH(double, wantedVolume);
        QFETCH(double, tolerance);
        near(areaOf(mesh), wantedArea, tolerance, "area");
        near(volumeOf(mesh), wantedVolume, tolerance, "volume");
        for (std::size_t i = 0; i < mesh.normals.size(); ++i) near(glm::length(mesh.normals[i]), 1.0, 1e-5, "normal");
        for (const glm::uvec3 t : mesh.triangles) {
            if (mesh.normals.empty()) break;
            const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
            const float facing = glm::dot(glm::cross(b - a, c - a), mesh.normals[t.x]);
            QVERIFY2(facing >= 0.0f, "a triangle faces against its normal");
        }
        const Scene scene = sceneOf(mesh);
        QCOMPARE(openEdges(triangles(scene)), std::size_t(0));
    }

    void aMissingTriangleIsNoticed() // the check itself must be able to fail
    {
        Mesh mesh = boxMesh(glm::vec3(0.0f), glm::vec3(1.0f));
        mesh.triangles.pop_back();
        QCOMPARE(openEdges(triangles(sceneOf(mesh))), std::size_t(3));
    }

    void cellShellIsWatertight()
    {
        CellPlan plan; // two rooms and a door between them
        plan.xs = {0, 4, 4.2f, 8.2f};
        plan.ys = {0, 2, 2.8f};
        plan.zs = {0, 1, 2, 4};
        plan.isAir = [](glm::vec3 p) {
            const bool inWall = p.x > 4 && p.x < 4.2f;
            return !inWall || (p.y < 2 && p.z > 1 && p.z < 2);
        };
        const std::vector<Mesh> shell = cellShell(plan);
        QCOMPARE(shell.size(), std::size_t(1));
        QCOMPARE(openEdges(triangles(sceneOf(shell[0]))), std::size_t(0));
        near(volumeOf(shell[0]), -(2 * 4 * 2.8 * 4 + 0.2 * 2 * 1), 1e-5, "volume of the air");
        const double rooms = 2 * (2 * 16 + 4 * 4 * 2.8), door = 0.2 * (2 * 2 + 2 * 1) - 2 * 2 * 1;
        near(areaOf(shell[0]), rooms + door, 1e-5, "area");
    }

    void furnace()
    {
        const Scene scene = furnaceBox(0.8f, 3.0f, {2, 1, 4});
        const auto all = triangles(scene);
        QCOMPARE(openEdges(all), std::size_t(0));
        near(area(all), 28.0, 1e-6, "area");
        near(volume(all), -8.0, 1e-6, "volume");
        near(surfaceFlux(scene).x, 3.0 * 28.0, 1e-5, "flux");
        QCOMPARE(scene.groups.size(), std::size_t(1));
    }

    void closedRoomsFaceInAndShineAsSaid_data()
    {
        QTest::addColumn<Scene>("scene");
        QTest::addColumn<double>("wantedArea");
        QTest::addColumn<double>("wantedVolume");
        QTest::addColumn<double>("flux");
        const double pi = std::numbers::pi;
        QTest::newRow("cube") << litCube(0.5f, 100.0f) << 24.0 << 8.0 << 400.0 * pi;
        QTest::newRow("point source room") << pointSourceRoom() << 80.0 << 48.0 << 4000.0 * pi;
        QTest::newRow("area source room") << areaSourceRoom() << 80.0 << 48.0 << 10000.0;
        QTest::newRow("cavity cube") << cavityCube(0.7f) << 96.0 << 64.0 << 1000.0;
        QTest::newRow("cavity L") << cavityL(0.7f) << 72.0 << 36.0 << 1000.0;
    }
    void closedRoomsFaceInAndShineAsSaid()
    {
        QFETCH(Scene, scene);
        QFETCH(double, wantedArea);
        QFETCH(double, wantedVolume);
        QFETCH(double, flux);
        const auto all = triangles(scene);
        QCOMPARE(openEdges(all), std::size_t(0));
        near(area(all), wantedArea, 1e-5, "area");
        near(volume(all), -wantedVolume, 1e-5, "volume");
        near(pointFlux(scene) + surfaceFlux(scene).y, flux, 1e-5, "flux");
        QCOMPARE(scene.groups.size(), std::size_t(1));
        QVERIFY(scene.warnings.empty());
    }

    void areaSourceHangsInTheCeiling()
    {
        const Scene scene = areaSourceRoom();
        const auto panel = triangles(scene, "Panel");
        near(area(panel), 1.0, 1e-6, "area");
        for (const PlacedTriangle& t : panel) {
            QVERIFY(t.areaVector().y < 0.0);
            for (const glm::vec3 p : t.corner) {
                QCOMPARE(p.y, 3.0f);
                QVERIFY(std::abs(p.x - 2.0f) == 0.5f && std::abs(p.z - 2.0f) == 0.5f);
            }
        }
    }

    void zUpPointsKeepTheirRoom() // a right-handed turn: no mirror image, and the room is 3 m high
    {
        const glm::vec3 x = fromZUp(1, 0, 0), y = fromZUp(0, 1, 0), z = fromZUp(0, 0, 1);
        QCOMPARE(z, glm::vec3(0, 1, 0));
        QCOMPARE(glm::cross(x, y), z);
        QCOMPARE(pointSourceRoom().bounds.high, glm::vec3(4, 3, 4));
        QCOMPARE(pointSourceRoom().lights.at(0).position, glm::vec3(2, 2.9f, 2));
    }

    void reflectionPlanesFaceEachOther()
    {
        const Scene scene = obstructionScene(0.5f, 1000.0f);
        glm::dvec3 s2(0.0), wall(0.0), screen(0.0);
        for (const PlacedTriangle& t : triangles(scene, "S2")) s2 += t.areaVector();
        for (const PlacedTriangle& t : triangles(scene, "Wall")) wall += t.areaVector();
        for (const PlacedTriangle& t : triangles(scene, "Screen")) screen += t.areaVector();
        QCOMPARE(s2, glm::dvec3(fromZUp(0, 0, 16)));
        QCOMPARE(wall, glm::dvec3(fromZUp(0, 16, 0)));
        QCOMPARE(screen, glm::dvec3(fromZUp(0, 10, 0)));
        QCOMPARE(scene.lights.at(0).travel, glm::vec3(0, -1, 0));
        QCOMPARE(triangles(reflectionScene(0.5f)).size(), std::size_t(4));
    }

    void platesAndSpheresFaceEachOther()
    {
        const Scene plates = parallelPlates(0.5f, 0.8f, 1.0f, 10.0f, 2.0f);
        for (const PlacedTriangle& t : triangles(plates, "Low")) QVERIFY(t.areaVector().y > 0.0);
        for (const PlacedTriangle& t : triangles(plates, "High")) QVERIFY(t.areaVector().y < 0.0);
        near(surfaceFlux(plates).x, 100.0, 1e-5, "flux");
        const Scene spheres = concentricSpheres(0.5f, 0.8f);
        const auto inner = triangles(spheres, "Inner"), outer = triangles(spheres, "Outer");
        QCOMPARE(openEdges(inner), std::size_t(0));
        QCOMPARE(openEdges(outer), std::size_t(0));
        QVERIFY(volume(inner) > 0.0 && volume(outer) < 0.0);
        near(area(inner) / area(outer), 0.25, 1e-6, "ratio of areas");
        near(area(outer), 4.0 * std::numbers::pi, 1.1e-3, "area");
    }

    void cornellBoxFacesItsInside()
    {
        const Scene scene = cornellBox();
        const glm::dvec3 middle(0.278, 0.274, 0.28);
        for (const PlacedTriangle& t : triangles(scene, "Room")) {
            QVERIFY(glm::dot(middle - glm::dvec3(t.corner[0]), t.areaVector()) > 0.0);
        }
        for (const PlacedTriangle& t : triangles(scene, "Ceiling lamp")) QVERIFY(t.areaVector().y < 0.0);
        near(area(triangles(scene, "Ceiling lamp")), 0.13 * 0.105, 1e-5, "lamp area");
        for (const char* block : {"Short block", "Tall block"}) {
            const auto sides = triangles(scene, block);
            QCOMPARE(sides.size(), std::size_t(10));
            QCOMPARE(openEdges(sides), std::size_t(4)); // open below, where it stands
            const glm::dvec3 in = glm::dvec3(sides[0].corner[0] + sides[1].corner[1]) * 0.5 - glm::dvec3(0, 0.08, 0);
            for (const PlacedTriangle& t : sides) {
                QVERIFY(glm::dot(glm::dvec3(t.corner[0]) - in, t.areaVector()) > 0.0);
            }
        }
        near(surfaceFlux(scene).x, 340.0 * std::numbers::pi * 0.13 * 0.105, 1e-5, "flux");
    }
};

QTEST_APPLESS_MAIN(AnalyticScenesTest)
#include "tst_analytic_scenes.moc"
