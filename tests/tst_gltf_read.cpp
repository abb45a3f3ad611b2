// SPDX-License-Identifier: Apache-2.0
// Claims about reading well-formed glTF: lamps, materials, images, names and cameras arrive in their units, from files
// and text alike, and what we do not support is said once. Geometry is in tst_gltf_meshes, the way back in
// tst_gltf_write.
#include "core/base/atomic_file.h"
#include "core/scene/image_decode.h"
#include "tests/gltf_reading.h"
#include "tests/scene_checks.h"
#include <QTemporaryDir>
#include <QtTest>
#include <cstdio>
#include <jpeglib.h>
#include <png.h>

using namespace lightloom;
using namespace lightloom::test;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

Bytes pngOf(int width, int height, const Bytes& rgba)
{
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = PNG_FORMAT_RGBA;
    png_alloc_size_t size = 0;
    png_image_write_to_memory(&image, nullptr, &size, 0, rgba.data(), 0, nullptr);
    Bytes file(size);
    png_image_write_to_memory(&image, file.data(), &size, 0, rgba.data(), 0, nullptr);
    file.resize(size);
    return file;
}

Bytes jpegOf(int width, int height, std::uint8_t grey, J_COLOR_SPACE space = JCS_RGB)
{
    jpeg_compress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&jpeg, &bytes, &size);
    jpeg.image_width = static_cast<JDIMENSION>(width);
    jpeg.image_height = static_cast<JDIMENSION>(height);
    jpeg.input_components = space == JCS_CMYK ? 4 : 3;
    jpeg.in_color_space = space;
    jpeg_set_defaults(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    Bytes line(static_cast<std::size_t>(width) * 4, grey);
    JSAMPROW row = line.data();
    for (int y = 0; y < height; ++y) jpeg_write_scanlines(&jpeg, &row, 1);
    jpeg_finish_compress(&jpeg);
    Bytes file(bytes, bytes + size);
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);
    return file;
}

} // namespace

class GltfReadTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void lampsArriveInTheirUnits()
    {
        GltfBuilder file;
        file.root["extensionsUsed"] = {"KHR_lights_punctual"};
        file.root["extensionsRequired"] = {"KHR_lights_punctual"};
        file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
            {{"type", "point"},
             {"name", "bulb"},
             {"intensity", 3'000'000'000u},
             {"color", {1, 0.5, 0.25}},
             {"range", 3}},
            {{"type", "spot"}, {"intensity", 800}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.5}}}},
            {{"type", "directional"}}};
        const auto lamp = [](int i) { return Json{{"KHR_lights_punctual", {{"light", i}}}}; };
        file.node({{"mesh", file.quad()}});
        file.node({{"name", "a"}, {"extensions", lamp(0)}, {"translation", {1, 2, 3}}, {"scale", {5, 5, 5}}});
        const double h = std::sqrt(0.5); // -90 degrees about x: -z becomes -y
        file.node({{"name", "b"}, {"extensions", lamp(1)}, {"rotation", {-h, 0, 0, h}}});
        file.node({{"name", "c"}, {"extensions", lamp(2)}});
        file.node({{"name", "a"}, {"extensions", lamp(0)}});
        const auto scene = read(file);
        QVERIFY(scene);
        QCOMPARE(scene->lights.size(), 4u);
        const PunctualLight &point = scene->lights[0], &spot = scene->lights[1], &sun = scene->lights[2];
        QVERIFY(point.kind == PunctualLight::Kind::point && spot.kind == PunctualLight::Kind::spot &&
                sun.kind == PunctualLight::Kind::directional);
        QCOMPARE(point.intensity, glm::vec3(3e9f, 1.5e9f, 0.75e9f)); // more than an int holds
        QVERIFY(glm::length(scene->toFile(point.position) - glm::dvec3(1, 2, 3)) <= 1e-6);
        QVERIFY(glm::length(spot.travel - glm::vec3(0, -1, 0)) <= 1e-6f);
        QCOMPARE(spot.innerCone, 0.2f);
        QCOMPARE(spot.outerCone, 0.5f);
        QCOMPARE(sun.intensity, glm::vec3(1.0f));
        QCOMPARE(sun.travel, glm::vec3(0, 0, -1));
        QCOMPARE(scene->groups.size(), 4u);
        QCOMPARE(QString::fromStdString(scene->lights[3].node), QString("a#2"));
        QVERIFY(warns(*scene, "range"));
    }

    void materialsArrive()
    {
        GltfBuilder file;
        const Bytes picture = pngOf(2, 1, {255, 0, 0, 255, 10, 20, 30, 40});
        file.add("images", {{"bufferView", file.view(picture)}, {"mimeType", "image/png"}});
        file.add("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
        file.add("textures", {{"source", 0}, {"sampler", 0}});
        const Json transform{{"offset", {0.5, 0.25}}, {"scale", {2, 3}}, {"rotation", 0.1}, {"texCoord", 1}};
        const int full =
            file.add("materials",
                     {{"name", "full"},
                      {"pbrMetallicRoughness",
                       {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                        {"metallicFactor", 0.5},
                        {"roughnessFactor", 0.25},
                        {"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}},
                      {"emissiveFactor", {1, 0.5, 0}},
                      {"alphaMode", "MASK"},
                      {"alphaCutoff", 0.3},
                      {"doubleSided", true},
                      {"extensions",
                       {{"KHR_materials_emissive_strength", {{"emissiveStrength", 300}}},
                        {"KHR_materials_transmission", {{"transmissionFactor", 0.9}}},
                        {"KHR_materials_ior", {{"ior", 1.33}}},
                        {"KHR_materials_volume", {{"thicknessFactor", 0.1}, {"attenuationDistance", 2.0}}}}}});
        file.node({{"name", "lamp"}, {"mesh", file.quad(full)}});
        file.node({{"mesh", file.quad()}});
        const auto scene = read(file);
        QVERIFY(scene);
        QCOMPARE(scene->materials.size(), 2u);
        const Material& m = scene->materials[0];
        QCOMPARE(m.baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
        QCOMPARE(m.metallic, 0.5f);
        QCOMPARE(m.roughness, 0.25f);
        QCOMPARE(m.emission, glm::vec3(300, 150, 0));
        QVERIFY(m.alpha == Material::Alpha::mask && m.doubleSided);
        QCOMPARE(m.alphaCutoff, 0.3f);
        QCOMPARE(m.transmission, 0.9f);
        QCOMPARE(m.ior, 1.33f);
        QCOMPARE(m.thickness, 0.1f);
        QCOMPARE(m.attenuationDistance, 2.0f);
        const Texture& t = m.baseColorTexture;
        QVERIFY(t.isSet() && !t.smooth && t.uvSet == 1);
        QVERIFY(t.wrapS == Texture::Wrap::clamp && t.wrapT == Texture::Wrap::mirror);
        QCOMPARE(t.offset, glm::vec2(0.5f, 0.25f));
        QCOMPARE(t.scale, glm::vec2(2, 3));
        QCOMPARE(t.rotation, 0.1f);
        QCOMPARE(scene->images.at(0).rgba, (Bytes{255, 0, 0, 255, 10, 20, 30, 40}));
        const Material& plain = scene->materials[1]; // glTF's default
        QVERIFY(plain.metallic == 1.0f && plain.roughness == 1.0f && !plain.baseColorTexture.isSet());
        QCOMPARE(scene->groups.size(), 1u);
        QVERIFY(warns(*scene, "rough glass")); // taken as smooth
    }

    void jpegAndPngDecode()
    {
        const Result<Image> jpeg = decodeImage(jpegOf(17, 9, 128));
        QVERIFY(jpeg);
        QCOMPARE(jpeg->width, 17);
        QCOMPARE(jpeg->height, 9);
        for (std::size_t i = 0; i < jpeg->rgba.size(); ++i) {
            QVERIFY(std::abs(jpeg->rgba[i] - (i % 4 == 3 ? 255 : 128)) <= 2);
        }
        const Result<Image> cmyk = decodeImage(jpegOf(8, 8, 128, JCS_CMYK));
        QVERIFY(!cmyk);
        const Bytes png = pngOf(3, 2, Bytes(24, 200));
        for (std::size_t n = 0; n < png.size() - 12; ++n) { // IEND itself may be missing
            QVERIFY2(!decodeImage(std::span(png).first(n)), qPrintable(QString("%1 bytes were enough").arg(n)));
        }
        const Bytes whole = jpegOf(64, 64, 90);
        QVERIFY(!decodeImage(std::span(whole).first(whole.size() / 2)));
    }

    void uriFilesBase64AndPercentCodes()
    {
        QTemporaryDir folder;
        const fs::path home = folder.path().toStdString();
        for (const std::string uri : {"data", "my%20data.bin"}) {
            GltfBuilder file;
            file.node({{"mesh", file.quad()}});
            std::string at = uri;
            if (uri == "data") {
                at = "data:application/octet-stream;base64," +
                     QByteArray(reinterpret_cast<const char*>(file.binary.data()),
                                static_cast<qsizetype>(file.binary.size()))
                         .toBase64()
                         .toStdString();
            } else {
                QVERIFY(writeFile(home / "my data.bin", file.binary));
            }
            QVERIFY(writeFile(home / "scene.gltf", file.gltf(at)));
            const auto scene = readScene(home / "scene.gltf");
            QVERIFY2(scene, scene ? "" : scene.error().message.c_str());
            QCOMPARE((*scene)->meshes.at(0).triangles.size(), 2u);
        }
    }

    void namesGroupsCamerasExposure()
    {
        GltfBuilder file;
        const int glow = file.add("materials", {{"name", "glow"}, {"emissiveFactor", {1, 1, 1}}});
        const int quad = file.quad(glow, "lamp mesh");
        const Json joined{{"lightloom", {{"group", "ceiling"}}}};
        file.node({{"name", "A"}, {"mesh", quad}, {"extras", joined}});
        file.node({{"name", "A"}, {"mesh", quad}, {"translation", {3, 0, 0}}, {"extras", joined}});
        file.node({{"name", "A"}, {"mesh", quad}, {"translation", {6, 0, 0}}});
        file.node({{"mesh", quad}, {"translation", {9, 0, 0}}, {"extras", {{"lightloom.group", "flat"}}}});
        file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
        file.add("cameras",
                 {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 5}}}});
        const double h = std::sqrt(0.5);
        file.node({{"name", "view"}, {"camera", 0}, {"translation", {0, 1, 5}}, {"rotation", {0, h, 0, h}}});
        file.node({{"name", "plan"}, {"camera", 1}});
        file.root["scenes"][0]["name"] = "hall";
        file.root["scenes"][0]["extras"] = {{"lightloom", {{"exposure", 9.5}}}};
        const auto scene = read(file);
        QVERIFY(scene);
        QCOMPARE(QString::fromStdString(scene->name), QString("hall"));
        QCOMPARE(scene->exposureEv.value_or(0), 9.5f);
        const std::vector<std::string> nodes{"A", "A#2", "A#3", "node3"};
        for (std::size_t i = 0; i < nodes.size(); ++i) QCOMPARE(scene->instances.at(i).node, nodes[i]);
        QCOMPARE(scene->groups.size(), 3u);
        QCOMPARE(scene->instances[0].group, scene->instances[1].group);
        QCOMPARE(QString::fromStdString(scene->groups[0].id), QString("ceiling"));
        QCOMPARE(QString::fromStdString(scene->groups[1].id), QString("A#3"));
        QCOMPARE(QString::fromStdString(scene->groups[2].id), QString("flat"));
        QCOMPARE(scene->cameras.size(), 1u);
        const Camera& camera = scene->cameras[0];
        QCOMPARE(QString::fromStdString(camera.name), QString("view"));
        QCOMPARE(camera.yFov, 0.7f);
        QVERIFY(glm::length(scene->toFile(camera.position) - glm::dvec3(0, 1, 5)) <= 1e-6);
        QVERIFY(glm::length(camera.orientation * glm::vec3(0, 0, -1) - glm::vec3(-1, 0, 0)) <= 1e-6f);
        QVERIFY(warns(*scene, "without perspective"));
    }

    void ignoredThingsWarnOnce()
    {
        GltfBuilder file;
        file.root["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_materials_variants", "KHR_texture_transform"};
        const int quad = file.quad();
        file.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
        file.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
        file.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
        const int joint = file.node({{"name", "bone"}});
        file.add("skins", {{"joints", {joint}}});
        file.add("animations", {{"channels", Json::array()}, {"samplers", Json::array()}});
        file.node({{"mesh", quad}, {"skin", 0}});
        file.node({{"mesh", quad}, {"scale", {0, 1, 1}}});
        const auto scene = read(file);
        QVERIFY(scene);
        for (const char* part : {"clearcoat", "variants", "morph", "points and lines", "skins", "animations",
                                 "scaled to nothing", "without a material"}) {
            QVERIFY2(warns(*scene, part), part);
        }
        QCOMPARE(scene->instances.size(), 1u);
        std::vector<std::string> logged;
        QTemporaryDir folder;
        const fs::path path = fs::path(folder.path().toStdString()) / "a.glb";
        QVERIFY(writeFile(path, file.glb()));
        QVERIFY(readScene(path, [&](LogLevel level, const std::string& line) {
            if (level == LogLevel::warning) logged.push_back(line);
        }));
        QCOMPARE(logged.size(), scene->warnings.size());
    }

    void filesByOthers_data()
    {
        QTest::addColumn<QString>("name");
        QTest::addColumn<int>("triangles");
        QTest::addColumn<int>("groups");
        QTest::newRow("cornell") << "cornell" << 38 << 1;
        QTest::newRow("l_corridor") << "l_corridor" << 20 << 1;
        QTest::newRow("cie_spot") << "cie_spot" << 2 << 1;
    }
    void filesByOthers()
    {
        QFETCH(QString, name);
        QFETCH(int, triangles);
        QFETCH(int, groups);
        const fs::path path = fs::path(LIGHTLOOM_SOURCE_DIR) / "../shared/cases" / name.toStdString() / "scene.glb";
        if (!fs::exists(path)) QSKIP("the cases are not beside this checkout");
        const auto scene = readScene(path);
        QVERIFY2(scene, scene ? "" : scene.error().message.c_str());
        QCOMPARE(static_cast<int>(test::triangles(**scene).size()), triangles);
        QCOMPARE(static_cast<int>((*scene)->groups.size()), groups);
        QVERIFY2((*scene)->warnings.empty(), (*scene)->warnings.empty() ? "" : (*scene)->warnings[0].c_str());
        if (name == "cornell") {
            const glm::vec3 lamp = (*scene)->materials.at(3).emission;
            QVERIFY2(glm::length(lamp - glm::vec3(340, 238, 80)) <= 1e-4f, "the lamp is not 340/238/80 cd/m2");
            QVERIFY(!(*scene)->materials.at(3).doubleSided);
            QVERIFY(std::abs((*scene)->bounds.size().y - 0.5488f) <= 1e-6f);
        }
        if (name == "cie_spot") {
            const PunctualLight& spot = (*scene)->lights.at(0);
            QCOMPARE(spot.intensity, glm::vec3(800, 400, 200));
            QVERIFY(spot.kind == PunctualLight::Kind::spot && spot.travel.y < -0.9f);
        }
    }
};

QTEST_GUILESS_MAIN(GltfReadTest)
#include "tst_gltf_read.moc"
