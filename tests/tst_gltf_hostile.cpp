// SPDX-License-Identifier: Apache-2.0
// Claims about files that are damaged or mean harm: each is refused with one clear line, within a second, and nothing
// outside the scene's folder is ever opened.
#include "core/base/atomic_file.h"
#include "core/base/rng.h"
#include "core/scene/gltf_check.h"
#include "core/scene/gltf_files.h"
#include "core/scene/gltf_reader.h"
#include "core/scene/image_decode.h"
#include "tests/gltf_builder.h"
#include "tests/time_limits.h"
#include <QElapsedTimer>
#include <QTemporaryDir>
#include <QtTest>
#include <cmath>
#include <ctime>
#include <functional>
#include <limits>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

using namespace lightloom;
using namespace lightloom::test;
using Json = nlohmann::json;
namespace fs = std::filesystem;

namespace {

Json material(int texture) { return {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}}; }

/// A scene with a bit of everything: quad, texture, lamp, camera, strided and sparse data.
GltfBuilder everything()
{
    GltfBuilder file;
    const Bytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    file.add("images", {{"bufferView", file.view(png)}});
    file.add("samplers", {{"wrapS", 33071}});
    file.add("textures", {{"source", 0}, {"sampler", 0}});
    file.add("materials", {{"name", "m"}, {"emissiveFactor", {1, 1, 1}}});
    const int quad = file.quad(0);
    file.root["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", file.view(std::vector<std::uint8_t>{2})}, {"componentType", kUByte}}},
        {"values", {{"bufferView", file.view(std::vector<glm::vec3>{{1, 0, -2}})}}}};
    file.root["extensionsUsed"] = {"KHR_lights_punctual"};
    file.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"intensity", 5}, {"spot", Json::object()}}};
    file.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}});
    const int child = file.add("nodes", {{"name", "child"}, {"mesh", quad}});
    file.node({{"name", "root"},
               {"children", {child}},
               {"camera", 0},
               {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return file;
}

/// A PNG of one colour whose header says `width` x `height`; as many bytes of pixels as `dataBytes`, all zero.
Bytes hugePng(std::uint32_t width, std::uint32_t height, std::size_t dataBytes)
{
    Bytes file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    const auto word = [&](std::uint32_t v) {
        for (int i = 3; i >= 0; --i) file.push_back(static_cast<std::uint8_t>(v >> (8 * i) & 0xFF));
    };
    const auto chunk = [&](const char* name, const Bytes& data) {
        word(static_cast<std::uint32_t>(data.size()));
        const std::size_t start = file.size();
        file.insert(file.end(), name, name + 4);
        file.insert(file.end(), data.begin(), data.end());
        word(static_cast<std::uint32_t>(crc32(0, file.data() + start, static_cast<uInt>(file.size() - start))));
    };
    Bytes header;
    for (const std::uint32_t v : {width, height}) {
        for (int i = 3; i >= 0; --i) header.push_back(static_cast<std::uint8_t>(v >> (8 * i) & 0xFF));
    }
    header.insert(header.end(), {8, 6, 0, 0, 0});
    chunk("IHDR", header);
    const Bytes zeros(dataBytes, 0);
    uLongf size = compressBound(static_cast<uLong>(dataBytes));
    Bytes packed(size);
    compress2(packed.data(), &size, zeros.data(), static_cast<uLong>(dataBytes), 9);
    packed.resize(size);
    chunk("IDAT", packed);
    chunk("IEND", {});
    return file;
}

QString show(const Result<std::shared_ptr<const Scene>>& scene)
{
    return scene ? QString("it was read") : QString::fromStdString(scene.error().message);
}

/// Time this program has spent computing: what a file costs, whoever else uses the machine.
class CpuClock {
public:
    [[nodiscard]] bool isWithinASecond() const
    {
        return static_cast<double>(now() - start_) <= kSanitizerSlowdown * CLOCKS_PER_SEC;
    }

private:
    static std::clock_t now() { return std::clock(); }
    std::clock_t start_ = now();
};

/// One printable line of sensible length.
bool isOneLine(const std::string& text)
{
    return !text.empty() && text.size() < 700 &&
           std::none_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; });
}

} // namespace

class GltfHostileTest : public QObject {
    Q_OBJECT

    using Harm = std::function<void(GltfBuilder&)>;
    struct Case {
        const char *name, *says; ///< a part of the message that names the trouble
        Harm harm;
    };
    std::vector<Case> cases_;

    void addCases()
    {
        const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
        const auto add = [&](const char* name, const char* says, Harm harm) {
            cases_.push_back({name, says, std::move(harm)});
        };
        add("image view at 4e9", "byteOffset", [](auto& f) { f.root["bufferViews"][0]["byteOffset"] = 4e9; });
        add("view too long", "bufferViews[1]", [](auto& f) { f.root["bufferViews"][1]["byteLength"] = 100'000; });
        add("view length wraps", "byteLength",
            [](auto& f) { f.root["bufferViews"][1]["byteLength"] = 18446744073709551615u; });
        add("view offset negative", "byteOffset", [](auto& f) { f.root["bufferViews"][1]["byteOffset"] = -4; });
        add("view of no buffer", "buffer", [](auto& f) { f.root["bufferViews"][1]["buffer"] = 1; });
        add("buffer longer than the file", "byteLength", [](auto& f) { f.binary.resize(8); });
        add("stride 3", "byteStride", [](auto& f) { f.root["bufferViews"][1]["byteStride"] = 3; });
        add("stride below the element", "byteStride", [](auto& f) { f.root["bufferViews"][1]["byteStride"] = 4; });
        add("accessor too long", "accessors[0]", [](auto& f) { f.root["accessors"][0]["count"] = 5; });
        add("accessor count 1e18", "count", [](auto& f) { f.root["accessors"][0]["count"] = 1e18; });
        add("accessor count 0", "count", [](auto& f) { f.root["accessors"][0]["count"] = 0; });
        add("accessor offset", "accessors[0]", [](auto& f) { f.root["accessors"][0]["byteOffset"] = 4; });
        add("accessor view", "bufferView", [](auto& f) { f.root["accessors"][0]["bufferView"] = 99; });
        add("component type", "componentType", [](auto& f) { f.root["accessors"][0]["componentType"] = 5124; });
        add("type", "type", [](auto& f) { f.root["accessors"][0]["type"] = "VEC5"; });
        add("position of VEC2", "POSITION", [](auto& f) {
            f.root["accessors"][0]["type"] = "VEC2";
            f.root["accessors"][0].erase("sparse");
        });
        add("index out of range", "index", [](auto& f) {
            f.root["meshes"][0]["primitives"][0]["indices"] =
                f.indices(std::vector<std::uint32_t>{0, 1, 4'000'000'000u});
        });
        add("indices of floats", "indices", [](auto& f) { f.root["meshes"][0]["primitives"][0]["indices"] = 0; });
        add("indices without data", "bufferView", [](auto& f) { f.root["accessors"][1].erase("bufferView"); });
        add("sparse index out of range", "sparse.indices", [](auto& f) {
            f.root["accessors"][0]["sparse"]["indices"]["bufferView"] = f.view(std::vector<std::uint8_t>{4});
        });
        add("sparse count", "count", [](auto& f) { f.root["accessors"][0]["sparse"]["count"] = 1'000'000; });
        add("sparse range", "sparse.values",
            [](auto& f) { f.root["accessors"][0]["sparse"]["values"]["byteOffset"] = 1; });
        add("sparse view", "sparse.indices",
            [](auto& f) { f.root["accessors"][0]["sparse"]["indices"]["bufferView"] = -1; });
        add("NaN position", "POSITION", [nan](auto& f) {
            f.root["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
                f.vec3s({{0, 0, 0}, {1, 0, 0}, {1, nan, 0}, {0, 1, 0}});
        });
        add("infinite texture coordinate", "TEXCOORD_0", [inf](auto& f) {
            f.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
                f.vec2s({{0, 0}, {1, 0}, {1, inf}, {0, 1}});
        });
        add("attributes of other count", "entries", [](auto& f) {
            f.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = f.vec2s({{0, 0}, {1, 0}});
        });
        add("number too large", "large", [](auto& f) { f.root["nodes"][0]["translation"] = {1e300, 0, 0}; });
        add("places that overflow", "finite", [](auto& f) {
            f.root["nodes"][0]["scale"] = {1e30, 1e30, 1e30};
            f.root["nodes"][1]["scale"] = {1e30, 1e30, 1e30};
        });
        add("a light year", "units", [](auto& f) { f.root["nodes"][0]["translation"] = {9.46e15, 0, 0}; });
        add("node is its own child", "nodes", [](auto& f) { f.root["nodes"][0]["children"] = {0}; });
        add("node cycle", "ancestor", [](auto& f) {
            f.root["nodes"][0]["children"] = {1};
            f.root["scenes"][0]["nodes"] = Json::array();
        });
        add("two parents", "already a child", [](auto& f) { f.node({{"children", {0}}}); });
        add("root with a parent", "no root", [](auto& f) { f.root["scenes"][0]["nodes"] = {0, 1}; });
        add("root twice", "twice", [](auto& f) { f.root["scenes"][0]["nodes"] = {1, 1}; });
        add("tower of nodes", "levels", [](auto& f) {
            for (int i = 0; i < 400; ++i) f.node({{"children", {static_cast<int>(f.root["nodes"].size()) + 1}}});
            f.add("nodes", {{"name", "top"}});
            f.root["scenes"][0]["nodes"] = {1, 2};
        });
        add("child that is not there", "child", [](auto& f) { f.root["nodes"][1]["children"] = {7}; });
        add("child 0.5", "child", [](auto& f) { f.root["nodes"][1]["children"] = {0.5}; });
        add("mesh that is not there", "meshes", [](auto& f) { f.root["nodes"][0]["mesh"] = 4; });
        add("camera that is not there", "cameras", [](auto& f) { f.root["nodes"][0]["camera"] = 4; });
        add("lamp that is not there", "lights",
            [](auto& f) { f.root["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 3; });
        add("lamp of negative light", "intensity",
            [](auto& f) { f.root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = -1; });
        add("lamp of no kind", "type",
            [](auto& f) { f.root["extensions"]["KHR_lights_punctual"]["lights"][0]["type"] = "moon"; });
        add("matrix of 15", "matrix", [](auto& f) { f.root["nodes"][0]["matrix"] = std::vector<int>(15, 1); });
        add("material that is not there", "materials",
            [](auto& f) { f.root["meshes"][0]["primitives"][0]["material"] = 9; });
        add("texture that is not there", "textures", [](auto& f) { f.add("materials", material(5)); });
        add("image that is not there", "images", [](auto& f) { f.root["textures"][0]["source"] = 5; });
        add("colour of three", "baseColorFactor", [](auto& f) {
            f.root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1};
        });
        add("colour of text", "baseColorFactor", [](auto& f) {
            f.root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {"1", 1, 1, 1};
        });
        add("nodes is no list", "nodes", [](auto& f) { f.root["nodes"] = {{"a", 1}}; });
        add("node is no object", "nodes[0]", [](auto& f) { f.root["nodes"][0] = 5; });
        add("mesh is no object", "meshes[0]", [](auto& f) { f.root["meshes"][0] = "x"; });
        add("scene that is not there", "scene", [](auto& f) { f.root["scene"] = 3; });
        add("nothing to see", "no triangles", [](auto& f) { f.root["nodes"][0].erase("mesh"); });
        add("version 1", "version", [](auto& f) { f.root["asset"]["version"] = "1.0"; });
        add("no asset", "asset", [](auto& f) { f.root.erase("asset"); });
        add("truncated image", "PNG", [](auto& f) { f.root["materials"][0] = material(0); });
        add("huge image", "scale it down", [](auto& f) {
            f.root["materials"][0] = material(0);
            f.root["images"][0]["bufferView"] = f.view(hugePng(100'000, 100'000, 1000));
        });
        add("image larger than its bytes", "cannot hold", [](auto& f) {
            f.root["materials"][0] = material(0);
            f.root["images"][0]["bufferView"] = f.view(hugePng(8000, 8000, 1000));
        });
        add("image of unknown kind", "neither PNG nor JPEG", [](auto& f) {
            f.root["materials"][0] = material(0);
            f.root["images"][0]["bufferView"] = f.view(Bytes{'R', 'I', 'F', 'F', 0, 0, 0, 0, 'W', 'E', 'B', 'P'});
        });
        for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu"}) {
            add(name, name, [name](auto& f) { f.root["extensionsRequired"] = {name}; });
        }
        for (const char* uri :
             {"../../etc/passwd", "..%2F..%2Fetc%2Fpasswd", "/etc/passwd", "%2Fetc%2Fpasswd", "file:///etc/passwd",
              "http://example.org/a.bin", "C:\\a.bin", "a%00b", "a%2", "", "sub/../../x"}) {
            add(*uri != 0 ? uri : "empty uri", "uri", [uri](auto& f) {
                f.add("images", {{"uri", uri}});
                f.root["buffers"] = {{{"uri", uri}, {"byteLength", 4}}};
            });
        }
        add("base64 of nonsense", "base64", [](auto& f) {
            f.root["materials"][0] = material(0);
            f.root["images"][0] = {{"uri", "data:image/png;base64,@@@@"}};
        });
        add("data uri without base64", "base64", [](auto& f) {
            f.root["materials"][0] = material(0);
            f.root["images"][0] = {{"uri", "data:image/png,abc"}};
        });
    }

private Q_SLOTS:
    void initTestCase()
    {
        GltfBuilder file = everything();
        const auto scene = readScene(file.glb(), ".");
        QVERIFY2(scene, qPrintable(show(scene))); // harmless as it is: what follows fails for its own reason
        addCases();
    }

    void harmIsRefused_data()
    {
        QTest::addColumn<int>("number");
        for (std::size_t i = 0; i < cases_.size(); ++i) QTest::newRow(cases_[i].name) << static_cast<int>(i);
    }
    void harmIsRefused()
    {
        QFETCH(int, number);
        const Case& c = cases_[static_cast<std::size_t>(number)];
        GltfBuilder file = everything();
        file.root["buffers"] = {{{"byteLength", file.binary.size()}}};
        c.harm(file);
        const std::size_t promised = file.root["buffers"][0]["byteLength"].get<std::size_t>();
        if (!file.root["buffers"][0].contains("uri") && promised < file.binary.size()) {
            file.root["buffers"][0]["byteLength"] = file.binary.size(); // the case added data of its own
        }
        const CpuClock clock;
        const auto scene = readScene(GltfBuilder::glbOf(file.root.dump(), file.binary), ".");
        QVERIFY2(clock.isWithinASecond(), "it took longer than a second");
        QVERIFY2(!scene, qPrintable(show(scene)));
        QVERIFY2(isOneLine(scene.error().message), qPrintable(show(scene)));
        QVERIFY2(scene.error().message.find(c.says) != std::string::npos, qPrintable(show(scene)));
        if (std::string_view(c.name).ends_with("compression")) {
            QCOMPARE(scene.error().kind, Error::Kind::unsupported);
        }
    }

    void textThatIsNotGltf_data()
    {
        QTest::addColumn<QByteArray>("text");
        QTest::newRow("empty") << QByteArray();
        QTest::newRow("blank") << QByteArray("  \n");
        QTest::newRow("prose") << QByteArray("Once upon a time");
        QTest::newRow("open brace") << QByteArray("{");
        QTest::newRow("array") << QByteArray("[1,2]");
        QTest::newRow("other JSON") << QByteArray("{\"a\":1}");
        QTest::newRow("NaN") << QByteArray("{\"asset\":{\"version\":\"2.0\"},\"x\":NaN}");
        QTest::newRow("1e999") << QByteArray("{\"asset\":{\"version\":\"2.0\"},\"x\":1e999}");
        QTest::newRow("bad UTF-8") << QByteArray("{\"asset\":{\"version\":\"2.0\"},\"x\":\"\xff\xfe\"}");
        QTest::newRow("magic alone") << QByteArray("glTF");
        QTest::newRow("glb version 1") << QByteArray("glTF\1\0\0\0\x14\0\0\0\0\0\0\0\0\0\0\0", 20);
        const QByteArray nested = QByteArray("[").repeated(32'768) + QByteArray("]").repeated(32'768);
        QTest::newRow("32 KB of nested extras")
            << QByteArray("{\"asset\":{\"version\":\"2.0\"},\"extras\":" + nested + "}");
        QTest::newRow("nested and open") << QByteArray("{\"asset\":{\"version\":\"2.0\"},\"extras\":" +
                                                       QByteArray("{\"a\":").repeated(32'768));
        QTest::newRow("five million values") << QByteArray("{\"asset\":{\"version\":\"2.0\"},\"extras\":[0" +
                                                           QByteArray(",0").repeated(5'000'000) + "]}");
    }
    void textThatIsNotGltf()
    {
        QFETCH(QByteArray, text);
        const CpuClock clock;
        const auto scene = readScene(Bytes(text.begin(), text.end()), ".");
        QVERIFY2(clock.isWithinASecond(), "it took longer than a second");
        QVERIFY2(!scene && isOneLine(scene.error().message), qPrintable(show(scene)));
    }

    void pathsThatAreNoFiles()
    {
        QTemporaryDir folder;
        const fs::path home = folder.path().toStdString();
        QCOMPARE(::mkfifo((home / "pipe.glb").c_str(), 0600), 0);
        for (const fs::path& path :
             {home / "missing.glb", home, home / "pipe.glb", fs::path("/dev/zero"), fs::path()}) {
            QElapsedTimer clock;
            clock.start();
            const auto scene = readScene(path);
            QVERIFY2(clock.elapsed() < 1000, path.c_str());
            QVERIFY2(!scene && isOneLine(scene.error().message), qPrintable(show(scene)));
        }
        QCOMPARE(readScene(home / "missing.glb").error().kind, Error::Kind::notFound);
    }

    void urisThatAreNoFiles()
    {
        QTemporaryDir folder, elsewhere;
        const fs::path home = folder.path().toStdString(), other = elsewhere.path().toStdString();
        GltfBuilder file;
        file.node({{"mesh", file.quad()}});
        QVERIFY(writeFile(other / "secret.bin", file.binary));
        QVERIFY(writeFile(home / "good.bin", file.binary));
        QCOMPARE(::mkfifo((home / "pipe.bin").c_str(), 0600), 0);
        fs::create_directory(home / "folder.bin");
        fs::create_symlink(other / "secret.bin", home / "link.bin");
        fs::create_directory_symlink(other, home / "linked");
        fs::create_symlink("good.bin", home / "inside.bin");
        fs::create_symlink("loop.bin", home / "loop.bin");
        for (const char* uri : {"good.bin", "inside.bin", "./good.bin"}) { // links that stay inside are fine
            QVERIFY(writeFile(home / "s.gltf", file.gltf(uri)));
            const auto scene = readScene(home / "s.gltf");
            QVERIFY2(scene, qPrintable(show(scene)));
        }
        for (const char* uri :
             {"pipe.bin", "folder.bin", ".", "link.bin", "linked/secret.bin", "loop.bin", "missing.bin"}) {
            QVERIFY(writeFile(home / "s.gltf", file.gltf(uri)));
            QElapsedTimer clock;
            clock.start();
            const auto scene = readScene(home / "s.gltf");
            QVERIFY2(clock.elapsed() < 1000, uri);
            QVERIFY2(!scene && isOneLine(scene.error().message), qPrintable(QString(uri) + ": " + show(scene)));
        }
    }

    void everyCutIsRefused()
    {
        GltfBuilder file = everything();
        const Bytes whole = file.glb();
        for (std::size_t n = 0; n < whole.size(); ++n) {
            const auto scene = readScene(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n)), ".");
            QVERIFY2(!scene, qPrintable(QString("%1 of %2 bytes were enough").arg(n).arg(whole.size())));
        }
    }

    void flippedBytesNeverCrash()
    {
        GltfBuilder file = everything();
        const Bytes whole = file.glb();
        int read = 0;
        for (std::uint64_t i = 0; i < 20'000; ++i) {
            Rng rng(11, 3, i);
            Bytes bytes = whole;
            const auto flips = 1 + rng.bits() % 3;
            for (std::uint64_t f = 0; f < flips; ++f) {
                bytes[rng.bits() % bytes.size()] ^= static_cast<std::uint8_t>(1 + rng.bits() % 255);
            }
            const auto scene = readScene(std::move(bytes), ".");
            if (!scene) {
                QVERIFY2(isOneLine(scene.error().message), qPrintable(show(scene)));
                continue;
            }
            ++read;
            for (const Mesh& mesh : (*scene)->meshes) {
                for (const glm::uvec3 t : mesh.triangles) {
                    QVERIFY(t.x < mesh.positions.size() && t.y < mesh.positions.size() && t.z < mesh.positions.size());
                }
                for (const glm::vec3 p : mesh.positions) QVERIFY(std::isfinite(p.x + p.y + p.z));
                QVERIFY(mesh.material >= 0 && static_cast<std::size_t>(mesh.material) < (*scene)->materials.size());
            }
            QVERIFY(std::isfinite((*scene)->bounds.diagonal()) && (*scene)->bounds.diagonal() > 0.0f);
        }
        QVERIFY2(read > 100 && read < 19'900, qPrintable(QString("%1 of 20000 were read").arg(read)));
    }

    void base64AndImagesTakeTheirLimits()
    {
        QVERIFY(!decodeDataUri("data:;base64,AAAAAAAA", 5));
        const auto six = decodeDataUri("data:;base64,AAECAwQF", 6);
        QVERIFY(six && *six == (Bytes{0, 1, 2, 3, 4, 5}));
        QVERIFY(!decodeDataUri("data:;base64,A", 6));
        // a picture that fits its bytes and not the limits: 64 x 64 allowed, 65 x 64 not
        const Bytes picture = hugePng(65, 64, (65 * 4 + 1) * 64);
        QVERIFY(decodeImage(picture, {100, 65 * 64}));
        QVERIFY(!decodeImage(picture, {100, 64 * 64}));
        QVERIFY(!decodeImage(picture, {64, 65 * 64}));
    }
};

QTEST_GUILESS_MAIN(GltfHostileTest)
#include "tst_gltf_hostile.moc"
