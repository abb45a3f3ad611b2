// SPDX-License-Identifier: Apache-2.0
// Claim: what the glTF writer writes reads back as the same scene, far from the origin too; the same scene gives the
// same bytes; and the files in sample_scenes/ are what make-scene makes today.
#include "core/base/atomic_file.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/gltf_reader.h"
#include "core/scene/gltf_writer.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "tests/scene_checks.h"
#include <QTemporaryDir>
#include <QtTest>
#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>
#include <set>

using namespace lightloom;
using namespace lightloom::test;

class GltfWriteTest : public QObject {
    Q_OBJECT

    QTemporaryDir folder_;

    Scene roundTrip(const Scene& scene)
    {
        const std::string path = folder_.filePath("scene.glb").toStdString();
        const Result<Done> written = writeGltf(scene, path);
        if (!written) qFatal("%s", written.error().message.c_str());
        const Result<std::shared_ptr<const Scene>> read = readScene(path);
        if (!read) qFatal("%s", read.error().message.c_str());
        return **read;
    }

    static nlohmann::json jsonOf(const Scene& scene)
    {
        const Result<std::vector<std::uint8_t>> bytes = gltfBytes(scene);
        if (!bytes) qFatal("%s", bytes.error().message.c_str());
        const auto number = [&](std::size_t at) {
            std::uint32_t value = 0;
            for (unsigned k = 0; k < 4; ++k) value |= std::uint32_t((*bytes)[at + k]) << (8 * k);
            return value;
        };
        if (number(8) != bytes->size() || number(12) % 4 != 0) qFatal("the glb's lengths are wrong");
        return nlohmann::json::parse(bytes->begin() + 20, bytes->begin() + 20 + number(12));
    }

    /// Apart by no more than floats of the scene's size are: the reader moves the origin to the middle.
    static void samePlace(const Scene& a, glm::vec3 inA, const Scene& b, glm::vec3 inB)
    {
        const double error = glm::length(b.toFile(inB) - a.toFile(inA)), limit = 2e-7 * double(a.bounds.diagonal());
        QVERIFY2(error <= limit, qPrintable(QString("%1 m, at most %2").arg(error).arg(limit)));
    }

    template<class List>
    static auto byNode(const List& list, const std::string& node)
    {
        return std::find_if(list.begin(), list.end(), [&](const auto& entry) { return entry.node == node; });
    }

    static void compareMaterials(const Material& a, const Material& b)
    {
        QCOMPARE(b.name, a.name);
        QCOMPARE(b.baseColor, a.baseColor);
        QCOMPARE(b.metallic, a.metallic);
        QCOMPARE(b.roughness, a.roughness);
        QCOMPARE(b.emission, a.emission);
        QCOMPARE(b.doubleSided, a.doubleSided);
        QCOMPARE(int(b.alpha), int(a.alpha));
        QCOMPARE(b.transmission, a.transmission);
        QCOMPARE(b.ior, a.ior);
        QCOMPARE(b.thickness, a.thickness);
        QCOMPARE(b.attenuationColor, a.attenuationColor);
        QCOMPARE(b.attenuationDistance, a.attenuationDistance);
        compareTextures(a.baseColorTexture, b.baseColorTexture);
        compareTextures(a.emissionTexture, b.emissionTexture);
    }
    static void compareTextures(const Texture& a, const Texture& b)
    {
        QCOMPARE(b.image, a.image);
        if (!a.isSet()) return;
        QCOMPARE(b.uvSet, a.uvSet);
        QCOMPARE(int(b.wrapS), int(a.wrapS));
        QCOMPARE(int(b.wrapT), int(a.wrapT));
        QCOMPARE(b.smooth, a.smooth);
        QCOMPARE(b.offset, a.offset);
        QCOMPARE(b.scale, a.scale);
        QCOMPARE(b.rotation, a.rotation);
    }

    static void compareLights(const Scene& a, const Scene& b)
    {
        QCOMPARE(b.lights.size(), a.lights.size());
        for (const PunctualLight& light : a.lights) {
            const auto other = byNode(b.lights, light.node);
            QVERIFY2(other != b.lights.end(), light.node.c_str());
            QCOMPARE(int(other->kind), int(light.kind));
            samePlace(a, light.position, b, other->position);
            for (int c = 0; c < 3; ++c) {
                const float error = std::abs(other->intensity[c] - light.intensity[c]);
                QVERIFY2(error <= 1e-7f * light.intensity[c], light.node.c_str());
            }
            if (light.kind != PunctualLight::Kind::point) {
                QVERIFY(glm::length(other->travel - light.travel) <= 2e-7f);
            }
            if (light.kind == PunctualLight::Kind::spot) {
                QCOMPARE(other->innerCone, light.innerCone);
                QCOMPARE(other->outerCone, light.outerCone);
            }
            QCOMPARE(b.groups.at(std::size_t(other->group)).id, a.groups.at(std::size_t(light.group)).id);
        }
    }

    static void compareScenes(const Scene& a, const Scene& b)
    {
        QCOMPARE(b.warnings.size(), std::size_t(0));
        QCOMPARE(b.materials.size(), a.materials.size());
        for (std::size_t i = 0; i < a.materials.size(); ++i) compareMaterials(a.materials[i], b.materials[i]);
        QCOMPARE(b.images.size(), a.images.size());
        for (std::size_t i = 0; i < a.images.size(); ++i) QCOMPARE(b.images[i].rgba, a.images[i].rgba);
        QCOMPARE(b.instances.size(), a.instances.size());
        for (const Instance& instance : a.instances) {
            const auto other = byNode(b.instances, instance.node);
            QVERIFY2(other != b.instances.end(), instance.node.c_str());
            QCOMPARE(other->group < 0, instance.group < 0);
            const Mesh &m = a.meshes[std::size_t(instance.mesh)], &n = b.meshes[std::size_t(other->mesh)];
            QCOMPARE(n.material, m.material);
            QVERIFY(n.triangles == m.triangles && n.uv[0] == m.uv[0]);
            const auto wanted = triangles(a, instance.node), got = triangles(b, instance.node);
            QCOMPARE(got.size(), wanted.size());
            for (std::size_t t = 0; t < got.size(); ++t) {
                for (std::size_t k = 0; k < 3; ++k) samePlace(a, wanted[t].corner[k], b, got[t].corner[k]);
            }
            QCOMPARE(n.normals.size(), m.normals.size());
            for (std::size_t v = 0; v < m.normals.size(); ++v) {
                QVERIFY(glm::length(n.normals[v] - m.normals[v]) <= 2e-7f);
            }
            if (instance.group < 0) continue;
            QCOMPARE(b.groups.at(std::size_t(other->group)).id, a.groups.at(std::size_t(instance.group)).id);
        }
        compareLights(a, b);
        QCOMPARE(b.groups.size(), a.groups.size());
        QCOMPARE(b.cameras.size(), a.cameras.size());
        for (std::size_t i = 0; i < a.cameras.size(); ++i) {
            QCOMPARE(b.cameras[i].name, a.cameras[i].name);
            QCOMPARE(b.cameras[i].yFov, a.cameras[i].yFov);
            QCOMPARE(b.cameras[i].nearPlane, a.cameras[i].nearPlane);
            samePlace(a, a.cameras[i].position, b, b.cameras[i].position);
            const float same = std::abs(glm::dot(b.cameras[i].orientation, a.cameras[i].orientation));
            QVERIFY(same >= 1.0f - 1e-6f && same <= 1.0f + 1e-6f);
        }
        QCOMPARE(b.exposureEv, a.exposureEv);
    }

private Q_SLOTS:
    void sampleScenesReadBack_data()
    {
        QTest::addColumn<QString>("name");
        for (const std::string_view name : kSampleSceneNames) {
            QTest::newRow(std::string(name).c_str()) << QString::fromUtf8(name.data(), qsizetype(name.size()));
        }
    }
    void sampleScenesReadBack()
    {
        QFETCH(QString, name);
        const Result<Scene> scene = sampleScene(name.toStdString());
        QVERIFY(scene);
        compareScenes(*scene, roundTrip(*scene));
    }

    void storedFilesAreWhatMakeSceneMakes_data() { sampleScenesReadBack_data(); }
    void storedFilesAreWhatMakeSceneMakes()
    {
        QFETCH(QString, name);
        const QString path = QStringLiteral(LIGHTLOOM_SOURCE_DIR "/sample_scenes/%1.glb").arg(name);
        const Result<std::vector<std::uint8_t>> stored = readFile(path.toStdString(), 1 << 24);
        QVERIFY2(stored, qPrintable(path));
        const Result<Scene> scene = sampleScene(name.toStdString());
        QVERIFY(scene);
        const Result<std::vector<std::uint8_t>> now = gltfBytes(*scene);
        QVERIFY(now);
        QVERIFY2(*stored == *now, qPrintable("make it again: lightloom-cli make-scene " + name + " -o " + path));
        QVERIFY2(stored->size() < 1'000'000, qPrintable(QString("%1 bytes").arg(stored->size())));
    }

    void materialsOfEveryKindReadBack()
    {
        SceneBuilder builder("materials");
        Image image{"pixels", 2, 1, {255, 0, 128, 255, 1, 2, 3, 77}};
        Material m;
        m.name = "leaf";
        m.metallic = 0.25f;
        m.roughness = 0.7f;
        m.baseColorTexture.image = builder.addImage(image);
        m.baseColorTexture.wrapT = Texture::Wrap::mirror;
        m.baseColorTexture.smooth = false;
        m.baseColorTexture.rotation = 0.3f;
        m.baseColorTexture.offset = {0.1f, -2.0f};
        m.alpha = Material::Alpha::mask;
        m.alphaCutoff = 0.4f;
        m.doubleSided = true;
        const int leaf = builder.addMaterial(m);
        Material glass;
        glass.name = "glass";
        glass.metallic = 0.0f;
        glass.roughness = 0.0f;
        glass.transmission = 1.0f;
        glass.ior = 1.33f;
        glass.thickness = 0.02f;
        glass.attenuationColor = {0.9f, 1.0f, 0.8f};
        glass.attenuationDistance = 0.5f;
        const int pane = builder.addMaterial(glass);
        const int dim = builder.addEmitter("dim", {0.1f, 0.2f, 0.3f}),
                  bright = builder.addEmitter("bright", {1e6f, 3.0f, 0.7f});
        builder.add("A/Leaf", texturedQuadMesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), leaf);
        builder.add("A/Pane", quadMesh({0, 0, 1}, {1, 0, 0}, {0, 1, 0}), pane);
        builder.add("B/Dim", quadMesh({0, 0, 2}, {1, 0, 0}, {0, 1, 0}), dim, "Joined lamps");
        builder.add("B/Bright", quadMesh({0, 0, 3}, {1, 0, 0}, {0, 1, 0}), bright, "Joined lamps");
        builder.addSpot("Spot", {1, 2, 3}, {1, 2, 9}, {10, 0, 3}, 0.1f, 0.2f, "Joined lamps"); // straight along +z
        builder.addDirectional("Sun", {0.2f, -1.0f, 0.1f}, {9, 8, 7});
        builder.addPoint("Off", {1, 1, 1}, {0, 0, 0});
        const Scene scene = builder.finish();
        QCOMPARE(scene.groups.size(), std::size_t(3));
        const Scene read = roundTrip(scene);
        QCOMPARE(read.materials.size(), scene.materials.size());
        for (std::size_t i = 0; i < scene.materials.size(); ++i) {
            compareMaterials(scene.materials[i], read.materials[i]);
        }
        QCOMPARE(read.images.at(0).rgba, image.rgba);
        QCOMPARE(read.materials.at(0).alphaCutoff, 0.4f);
        compareLights(scene, read);
        QCOMPARE(read.groups.size(), scene.groups.size());
    }

    void instancesShareOneMesh()
    {
        const nlohmann::json json = jsonOf(atrium());
        int columns = 0;
        std::set<int> meshes;
        for (const auto& node : json.at("nodes")) {
            const std::string name = node.value("name", "");
            if (name.rfind("Ground south", 0) != 0) continue;
            ++columns;
            meshes.insert(node.at("mesh").get<int>());
        }
        QCOMPARE(columns, 6);
        QCOMPARE(meshes.size(), std::size_t(1));
    }

    void transformsReadBack()
    {
        SceneBuilder builder("transforms");
        const int mesh = builder.addMesh(boxMesh({0, 0, 0}, {1, 2, 3}), builder.addMaterial("grey", glm::vec3(0.5f)));
        const glm::mat4 moved = glm::translate(glm::mat4(1.0f), {5.1f, -3.3f, 0.7f});
        const glm::mat4 turned = glm::rotate(moved, 0.7f, glm::vec3(0.6f, 0.0f, 0.8f));
        builder.place("Moved", mesh, moved);
        builder.place("Turned", mesh, turned);
        builder.place("Mirrored", mesh, glm::scale(turned, {-1.0f, 2.0f, 0.5f}));
        const Scene scene = builder.finish(), read = roundTrip(scene);
        for (const char* node : {"Moved", "Turned", "Mirrored"}) {
            const auto wanted = triangles(scene, node), got = triangles(read, node);
            QCOMPARE(got.size(), wanted.size());
            for (std::size_t t = 0; t < got.size(); ++t) {
                for (std::size_t k = 0; k < 3; ++k) samePlace(scene, wanted[t].corner[k], read, got[t].corner[k]);
            }
        }
    }

    void farFromTheOriginNothingMoves() // a millimetre is kept at a thousand kilometres
    {
        Scene scene = twoRooms();
        scene.origin = {1.0e6, -250.125, 4.0e5};
        const Scene read = roundTrip(scene);
        const auto wanted = triangles(scene), got = triangles(read);
        QCOMPARE(got.size(), wanted.size());
        double worst = 0.0;
        const auto low = [](const Scene& s) { return s.toFile(s.bounds.low); };
        worst = std::max(worst, glm::length(low(read) - low(scene)));
        for (const Camera& camera : scene.cameras) {
            const auto other = std::find_if(read.cameras.begin(), read.cameras.end(),
                                            [&](const Camera& c) { return c.name == camera.name; });
            QVERIFY(other != read.cameras.end());
            worst = std::max(worst, glm::length(read.toFile(other->position) - scene.toFile(camera.position)));
        }
        QVERIFY2(worst <= 2e-6, qPrintable(QString("%1 m").arg(worst)));
        QVERIFY(std::abs(area(got) - area(wanted)) <= 1e-5 * area(wanted));
        QCOMPARE(openEdges(got), std::size_t(0));
    }

    void figureMeetsTheAskedNumber()
    {
        for (const std::uint64_t asked : {40ull, 41ull, 99ull, 1000ull, 24000ull, 123457ull}) {
            const Result<Scene> scene = figureScene(asked);
            QVERIFY(scene);
            QCOMPARE(triangles(*scene).size(), std::size_t(asked - asked % 2));
            const auto figure = triangles(*scene, "Figure");
            QCOMPARE(openEdges(figure), std::size_t(0));
            QVERIFY(volume(figure) > 0.0);
        }
        QVERIFY(!figureScene(39));
        QVERIFY(!figureScene(kMostFigureTriangles + 1));
        QVERIFY(!sampleScene("cornell", 1000));
        QVERIFY(!sampleScene("kitchen"));
    }

    void sampleRoomsAreAsPromised()
    {
        QCOMPARE(openEdges(triangles(twoRooms())), std::size_t(0));
        const Scene hall = atrium(), show = gallery();
        QCOMPARE(openEdges(triangles(hall)), std::size_t(0));
        QCOMPARE(std::count_if(hall.instances.begin(), hall.instances.end(),
                               [](const Instance& i) { return i.node.rfind("Columns/", 0) == 0; }),
                 std::ptrdiff_t(24));
        std::vector<PlacedTriangle> room = triangles(show, "Room/");
        const auto panels = triangles(show, "Lamps/");
        room.insert(room.end(), panels.begin(), panels.end());
        QCOMPARE(openEdges(room), std::size_t(0));
        QCOMPARE(show.groups.size(), std::size_t(11));
        for (const std::string_view name : kSampleSceneNames) {
            const Result<Scene> scene = sampleScene(name);
            QVERIFY(scene && scene->cameras.size() >= 2 && scene->cameras.size() <= 4 && scene->exposureEv);
            QVERIFY(scene->warnings.empty());
        }
    }
};

QTEST_GUILESS_MAIN(GltfWriteTest)
#include "tst_gltf_write.moc"
