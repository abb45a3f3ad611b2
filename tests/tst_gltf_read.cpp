// SPDX-License-Identifier: Apache-2.0
// Claims about reading well-formed glTF: every way to store a mesh gives the same mesh, transforms and units arrive
// exactly, and what we do not support is said once.
#include "core/base/atomic_file.h"
#include "core/scene/gltf_reader.h"
#include "core/scene/gltf_writer.h"
#include "core/scene/image_decode.h"
#include "core/scene/sample_scenes.h"
#include "tests/gltf_builder.h"
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

std::shared_ptr<const Scene> read(GltfBuilder& file, const fs::path& folder = ".")
{
    const auto scene = readScene(file.glb(), folder);
    if (scene) return *scene;
    qWarning("%s", scene.error().message.c_str());
    return nullptr;
}

bool warns(const Scene& scene, const char* part)
{
    return std::count_if(scene.warnings.begin(), scene.warnings.end(),
                         [&](const std::string& line) { return line.find(part) != std::string::npos; }) == 1;
}

/// Corners of all triangles in the file's space, in drawing order.
std::vector<glm::dvec3> corners(const Scene& scene)
{
    std::vector<glm::dvec3> all;
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[static_cast<std::size_t>(instance.mesh)];
        for (const glm::uvec3 t : mesh.triangles) {
            for (const unsigned v : {t.x, t.y, t.z}) {
                all.push_back(scene.toFile(glm::vec3(instance.toWorld * glm::vec4(mesh.positions[v], 1.0f))));
            }
        }
    }
    return all;
}

double worst(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b)
{
    if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, glm::length(a[i] - b[i]));
    return most;
}

std::string groupOf(const Scene& scene, int group)
{
    return group < 0 ? std::string() : scene.groups[static_cast<std::size_t>(group)].id;
}

const std::vector<glm::vec3> kSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<glm::dvec3> kSquareCorners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};

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
    void modesAndIndexTypesGiveTheSameSquare_data()
    {
        QTest::addColumn<int>("mode");
        QTest::addColumn<int>("bytes"); // per index; 0: none
        for (const int bytes : {0, 1, 2, 4}) {
            for (const int mode : {4, 5, 6}) QTest::addRow("mode %d, %d-byte indices", mode, bytes) << mode << bytes;
        }
    }
    void modesAndIndexTypesGiveTheSameSquare()
    {
        QFETCH(int, mode);
        QFETCH(int, bytes);
        const std::vector<std::uint32_t> order = mode == 4   ? std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}
                                                 : mode == 5 ? std::vector<std::uint32_t>{3, 0, 2, 1}
                                                             : std::vector<std::uint32_t>{0, 1, 2, 3};
        GltfBuilder file;
        Json primitive{{"mode", mode}};
        if (bytes == 0) {
            std::vector<glm::vec3> positions;
            for (const auto i : order) positions.push_back(kSquare[i]);
            primitive["attributes"]["POSITION"] = file.vec3s(positions);
        } else {
            primitive["attributes"]["POSITION"] = file.vec3s(kSquare);
            if (bytes == 1) primitive["indices"] = file.indices(std::vector<std::uint8_t>(order.begin(), order.end()));
            if (bytes == 2) primitive["indices"] = file.indices(std::vector<std::uint16_t>(order.begin(), order.end()));
            if (bytes == 4) primitive["indices"] = file.indices(order);
        }
        file.node({{"mesh", file.mesh(primitive)}});
        const auto scene = read(file);
        QVERIFY(scene);
        QCOMPARE(scene->meshes.at(0).triangles.size(), 2u);
        double area = 0;
        const auto all = corners(*scene);
        for (std::size_t i = 0; i < all.size(); i += 3) {
            const glm::dvec3 n = glm::cross(all[i + 1] - all[i], all[i + 2] - all[i]);
            QVERIFY2(n.z > 0, "a triangle faces the wrong way");
            area += 0.5 * glm::length(n);
        }
        QVERIFY(std::abs(area - 1.0) <= 1e-6);
    }

    void componentTypesStridesAndSparseGiveTheSameSquare_data()
    {
        QTest::addColumn<QString>("how");
        for (const char* how : {"float", "stride 32", "byte", "ubyte", "short", "ushort", "byte normalized",
                                "ubyte normalized", "short normalized", "ushort normalized", "sparse", "sparse only"}) {
            QTest::addRow("%s", how) << how;
        }
    }
    void componentTypesStridesAndSparseGiveTheSameSquare()
    {
        QFETCH(QString, how);
        GltfBuilder file;
        const bool isNormalized = how.endsWith("normalized");
        const auto whole = [&](auto one, int component) { // stride 4 or 8: rows of three, padded
            using T = decltype(one);
            std::vector<T> values;
            for (const glm::vec3 p : kSquare) {
                for (int c = 0; c < 3; ++c) values.push_back(static_cast<T>(p[c] * static_cast<float>(one)));
                values.push_back(T(77));
            }
            return file.accessor(file.view(values, 4 * sizeof(T)), component, "VEC3", 4, isNormalized);
        };
        int position = -1;
        if (how == "float") position = file.vec3s(kSquare);
        if (how == "stride 32") {
            std::vector<float> values;
            for (const glm::vec3 p : kSquare) values.insert(values.end(), {-9, -9, p.x, p.y, p.z, -9, -9, -9});
            position = file.accessor(file.view(values, 32), kFloat, "VEC3", 4);
            file.root["accessors"][position]["byteOffset"] = 8;
        }
        if (how.startsWith("byte")) position = whole(std::int8_t(isNormalized ? 127 : 1), kByte);
        if (how.startsWith("ubyte")) position = whole(std::uint8_t(isNormalized ? 255 : 1), kUByte);
        if (how.startsWith("short")) position = whole(std::int16_t(isNormalized ? 32767 : 1), kShort);
        if (how.startsWith("ushort")) position = whole(std::uint16_t(isNormalized ? 65535 : 1), kUShort);
        if (how.startsWith("sparse")) {
            auto base = kSquare;
            base[2] = {50, 50, 50};
            base[1] = {60, 60, 60};
            position = file.vec3s(base);
            std::vector<std::uint16_t> which{1, 2};
            std::vector<glm::vec3> values{kSquare[1], kSquare[2]};
            if (how == "sparse only") { // zeros below
                file.root["accessors"][position].erase("bufferView");
                which.push_back(3);
                values.push_back(kSquare[3]);
            }
            file.root["accessors"][position]["sparse"] = {
                {"count", which.size()},
                {"indices", {{"bufferView", file.view(which)}, {"componentType", kUShort}}},
                {"values", {{"bufferView", file.view(values)}}}};
        }
        const int index = file.indices<std::uint8_t>({0, 1, 2, 0, 2, 3});
        file.node({{"mesh", file.mesh({{"attributes", {{"POSITION", position}}}, {"indices", index}})}});
        const auto scene = read(file);
        QVERIFY(scene);
        const double error = worst(corners(*scene), kSquareCorners);
        QVERIFY2(error <= 1e-6, qPrintable(QString("off by %1").arg(error)));
    }

    void otherAttributesArrive()
    {
        GltfBuilder file;
        const std::vector<std::uint8_t> colours{255, 0, 0, 0, 0, 51, 255, 0, 255, 255, 255, 0, 0, 0, 0, 0};
        const std::vector<std::uint16_t> uv{0, 0, 65535, 0, 65535, 65535, 0, 65535};
        const int corners = file.indices<std::uint8_t>({0, 1, 2, 0, 2, 3});
        Json attributes{{"POSITION", file.vec3s(kSquare)},
                        {"NORMAL", file.vec3s({{0, 0, 2}, {0, 0, 0}, {0, 3, 4}, {0, 0, 1}})},
                        {"TEXCOORD_0", file.accessor(file.view(uv), kUShort, "VEC2", 4, true)},
                        {"TEXCOORD_1", file.vec2s({{0, 0}, {2, 0}, {2, 3}, {0, 3}})},
                        {"COLOR_0", file.accessor(file.view(colours, 4), kUByte, "VEC3", 4, true)},
                        {"_TEMPERATURE", file.vec2s({{0, 0}, {0, 0}, {0, 0}, {0, 0}})}};
        file.node({{"mesh", file.mesh({{"attributes", attributes}, {"indices", corners}})}});
        const auto scene = read(file);
        QVERIFY(scene);
        const Mesh& mesh = scene->meshes.at(0);
        QCOMPARE(mesh.normals.at(0), glm::vec3(0, 0, 1));
        QCOMPARE(mesh.normals.at(1), glm::vec3(0, 0, 1)); // had no length: its triangle's
        QCOMPARE(mesh.normals.at(2), glm::vec3(0, 0.6f, 0.8f));
        QCOMPARE(mesh.uv[0].at(2), glm::vec2(1, 1));
        QCOMPARE(mesh.uv[1].at(2), glm::vec2(2, 3));
        QCOMPARE(mesh.colors.at(0), glm::vec4(1, 0, 0, 1));
        QCOMPARE(mesh.colors.at(1), glm::vec4(0, 0.2f, 1, 1));
    }

    void flatTrianglesAndStrayVerticesGo()
    {
        GltfBuilder file;
        auto positions = kSquare;
        positions.insert(positions.begin(), {1e6f, 0, 0}); // used by nothing: must not widen the bound
        positions.push_back({0.5f, 0.5f, 0});
        const int corners = file.indices<std::uint8_t>({1, 2, 3, 1, 3, 4, 1, 1, 2, 1, 5, 3});
        file.node({{"mesh", file.mesh({{"attributes", {{"POSITION", file.vec3s(positions)}}}, {"indices", corners}})}});
        const auto scene = read(file);
        QVERIFY(scene);
        QCOMPARE(scene->meshes.at(0).triangles.size(), 2u);
        QCOMPARE(scene->meshes.at(0).positions.size(), 4u);
        QVERIFY(scene->bounds.diagonal() <= 1.4143f);
        QVERIFY(warns(*scene, "2 triangles without area"));
    }

    void transformsCompose()
    {
        GltfBuilder file;
        const int quad = file.quad();
        // 90 degrees about y takes (1,0,0) to (0,0,-1); child mirrored in x by its scale, moved by a matrix
        const double h = std::sqrt(0.5);
        const int child = file.add("nodes", {{"name", "child"}, {"mesh", quad}, {"scale", {-2, 1, 1}}});
        file.node(
            {{"name", "turned"}, {"rotation", {0, h, 0, h}}, {"translation", {10, 20, 30}}, {"children", {child}}});
        file.node({{"name", "moved"}, {"mesh", quad}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}}});
        const auto scene = read(file);
        QVERIFY(scene);
        QCOMPARE(scene->meshes.size(), 1u); // instanced
        QCOMPARE(scene->instances.size(), 2u);
        QVERIFY(scene->instances[0].isMirrored() && !scene->instances[1].isMirrored());
        QCOMPARE(QString::fromStdString(scene->instances[0].node), QString("turned/child"));
        const auto all = corners(*scene);
        const double first = glm::length(all[1] - glm::dvec3(10, 20, 32)); // (1,0,0) -> (-2,0,0) -> (0,0,2)
        const double second = glm::length(all[7] - glm::dvec3(6, 6, 7));
        QVERIFY2(first <= 1e-5 && second <= 1e-5, qPrintable(QString("%1 %2").arg(first).arg(second)));
    }

    void farFromTheOriginKeepsItsDetail_data()
    {
        QTest::addColumn<bool>("inNode");
        QTest::newRow("moved by the node") << true;
        QTest::newRow("moved in the mesh, and turned") << false;
    }
    void farFromTheOriginKeepsItsDetail()
    {
        QFETCH(bool, inNode);
        GltfBuilder file;
        const glm::dvec3 far(1e6, 2e6, -1e6); // floats there are 1/16 to 1/8 m apart
        auto positions = kSquare;
        if (!inNode) {
            for (glm::vec3& p : positions) p += glm::vec3(far);
        }
        const int corner = file.indices<std::uint8_t>({0, 1, 2, 0, 2, 3});
        const int mesh = file.mesh({{"attributes", {{"POSITION", file.vec3s(positions)}}}, {"indices", corner}});
        const glm::dvec3 offset(0.0123, 0.0456, 0.0789);
        const glm::dvec3 t = inNode ? far + offset : offset;
        const double angle = inNode ? 0.0 : 0.3;
        file.node({{"mesh", mesh},
                   {"translation", {t.x, t.y, t.z}},
                   {"rotation", {0, 0, std::sin(angle / 2), std::cos(angle / 2)}}});
        const auto scene = read(file);
        QVERIFY(scene);
        std::vector<glm::dvec3> expected;
        for (const glm::dvec3 p : kSquareCorners) {
            const glm::dvec3 q = inNode ? p : p + far;
            expected.push_back(glm::dvec3(std::cos(angle) * q.x - std::sin(angle) * q.y,
                                          std::sin(angle) * q.x + std::cos(angle) * q.y, q.z) +
                               t);
        }
        const double error = worst(corners(*scene), expected);
        QVERIFY2(error <= 1e-6, qPrintable(QString("off by %1 m").arg(error)));
    }

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
        QVERIFY(warns(*scene, "transmission"));
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

    void whatWeWriteComesBack_data()
    {
        QTest::addColumn<QString>("name");
        for (const std::string_view name : kSampleSceneNames) {
            const auto text = QString::fromUtf8(name.data(), static_cast<qsizetype>(name.size()));
            QTest::newRow(qPrintable(text)) << text;
        }
    }
    void whatWeWriteComesBack()
    {
        QFETCH(QString, name);
        const Result<Scene> scene = sampleScene(name.toStdString());
        QVERIFY(scene);
        const auto bytes = gltfBytes(*scene);
        QVERIFY(bytes);
        const auto read = readScene(*bytes, ".");
        QVERIFY2(read, read ? "" : read.error().message.c_str());
        Scene a = *scene, b = **read;
        for (Scene* s : {&a, &b}) { // the file orders by its node tree
            std::stable_sort(s->instances.begin(), s->instances.end(),
                             [](const Instance& x, const Instance& y) { return x.node < y.node; });
            std::stable_sort(s->lights.begin(), s->lights.end(),
                             [](const PunctualLight& x, const PunctualLight& y) { return x.node < y.node; });
        }
        const double error = worst(corners(a), corners(b));
        QVERIFY2(error <= 1e-6 * static_cast<double>(a.bounds.diagonal()),
                 qPrintable(QString("off by %1 m").arg(error)));
        QVERIFY2(b.warnings.empty(), b.warnings.empty() ? "" : b.warnings[0].c_str());
        QCOMPARE(b.groups.size(), a.groups.size());
        QCOMPARE(b.instances.size(), a.instances.size());
        for (std::size_t i = 0; i < a.instances.size(); ++i) {
            QCOMPARE(b.instances[i].node, a.instances[i].node);
            QVERIFY(groupOf(b, b.instances[i].group) == groupOf(a, a.instances[i].group));
            const auto material = [&](const Scene& s) -> const Material& {
                const Mesh& mesh = s.meshes[static_cast<std::size_t>(s.instances[i].mesh)];
                return s.materials[static_cast<std::size_t>(mesh.material)];
            };
            const Material &x = material(a), &y = material(b);
            QCOMPARE(y.name, x.name);
            QVERIFY(glm::length(y.baseColor - x.baseColor) <= 1e-6f && glm::abs(y.metallic - x.metallic) <= 1e-6f);
            QVERIFY(glm::abs(y.roughness - x.roughness) <= 1e-6f && y.doubleSided == x.doubleSided);
            QVERIFY(glm::length(y.emission - x.emission) <= 1e-6f * glm::length(x.emission));
            QCOMPARE(y.baseColorTexture.isSet(), x.baseColorTexture.isSet());
        }
        QCOMPARE(b.lights.size(), a.lights.size());
        for (std::size_t i = 0; i < a.lights.size(); ++i) {
            QVERIFY(b.lights[i].kind == a.lights[i].kind && b.lights[i].node == a.lights[i].node);
            QVERIFY(groupOf(b, b.lights[i].group) == groupOf(a, a.lights[i].group));
            QVERIFY(glm::length(b.toFile(b.lights[i].position) - a.toFile(a.lights[i].position)) <= 1e-5);
            QVERIFY(glm::length(b.lights[i].travel - a.lights[i].travel) <= 1e-5f ||
                    a.lights[i].kind == PunctualLight::Kind::point);
            QVERIFY(glm::length(b.lights[i].intensity - a.lights[i].intensity) <=
                    1e-6f * glm::length(a.lights[i].intensity));
        }
        QCOMPARE(b.cameras.size(), a.cameras.size());
        for (std::size_t i = 0; i < a.cameras.size(); ++i) {
            QCOMPARE(b.cameras[i].name, a.cameras[i].name);
            const glm::vec3 ahead(0, 0, -1);
            QVERIFY(glm::length(b.cameras[i].orientation * ahead - a.cameras[i].orientation * ahead) <= 1e-5f);
        }
        QVERIFY(b.exposureEv == a.exposureEv);
        QVERIFY(b.images.size() == a.images.size());
        for (std::size_t i = 0; i < b.images.size(); ++i) {
            const auto same = [&](const Image& image) { return image.rgba == b.images[i].rgba; };
            QVERIFY(std::any_of(a.images.begin(), a.images.end(), same));
        }
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
        QCOMPARE(static_cast<int>(corners(**scene).size()), 3 * triangles);
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
