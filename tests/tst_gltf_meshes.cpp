// SPDX-License-Identifier: Apache-2.0
// Claims about the geometry of well-formed glTF: every way to store a mesh gives the same mesh, transforms arrive
// exactly, far from the origin too.
#include "tests/gltf_reading.h"
#include <QtTest>

using namespace lightloom;
using namespace lightloom::test;
using Json = nlohmann::json;

namespace {

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

const std::vector<glm::vec3> kSquare{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<glm::dvec3> kSquareCorners{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};

} // namespace

class GltfMeshesTest : public QObject {
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
};

QTEST_APPLESS_MAIN(GltfMeshesTest)
#include "tst_gltf_meshes.moc"
