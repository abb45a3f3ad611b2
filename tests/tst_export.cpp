// SPDX-License-Identifier: Apache-2.0
// Claims: what export writes says what the bake says: the lightmap read through the glTF's own coordinates is the
// field's light on the surface; sides with places of their own come twice; the volume opens as plain OpenVDB with every
// leaf active; same bytes on any number of threads; nothing is written after a stop.
#include "core/bake/export_bake.h"
#include "core/bake/solver_for.h"
#include "core/bake/vdb_file.h"
#include "core/bake/vdb_seal.h"
#include "core/base/atomic_file.h"
#include "core/ivg/irradiance_grid.h"
#include "core/scene/gltf_reader.h"
#include "core/scene/gltf_writer.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/trace/cell_clip.h"
#include "tests/atlas_helpers.h"
#include "tests/bake_helpers.h"
#include <QProcess>
#include <QStandardPaths>
#include <QTemporaryDir>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

using namespace lightloom;
using namespace lightloom::test;

namespace {

BakeParams quick()
{
    BakeParams params;
    params.photonCount = 20'000;
    params.octreeDepth = 4;
    params.directSamples = 4;
    return params;
}

/// A bake of a scene, ready for export.
struct Exporter {
    explicit Exporter(Scene scene, const BakeParams& params = quick(), Method method = Method::lightOctree)
        : lit(std::move(scene))
    {
        BakeProducts products;
        bake = runSolver(*solverFor(method), {lit.scene, params, {}}, products);
        if (!bake.field) qFatal("%s", bake.error.c_str());
        info.method = method;
        info.params = params;
        info.isa = std::string(lit.rays->isaName());
        info.sceneHash = sceneHash(*lit.scene);
        info.program = "test";
    }
    [[nodiscard]] Result<ExportReport> run(const ExportRequest& request, int threads = 2, std::stop_token stop = {},
                                           const std::function<void(double)>& progress = {}) const
    {
        Workers workers(threads);
        return exportBake({*lit.rays, *lit.lights, nullptr, *bake.field, info}, request, workers, stop, progress);
    }
    LitScene lit;
    Baked bake;
    BakeInfo info;
};

std::vector<std::uint8_t> bytesOf(const std::filesystem::path& path)
{
    const auto read = readFile(path, 1 << 30);
    return read ? *read : std::vector<std::uint8_t>();
}

nlohmann::json jsonOf(const std::vector<std::uint8_t>& glb)
{
    std::uint32_t length = 0;
    for (unsigned k = 0; k < 4; ++k) length |= std::uint32_t(glb.at(12 + k)) << (8 * k);
    return nlohmann::json::parse(glb.begin() + 20, glb.begin() + 20 + length);
}

Scene sheetInRoom()
{
    SceneBuilder builder("room");
    builder.add("Room", boxMesh(glm::vec3(-2), glm::vec3(2), Facing::in), builder.addMaterial("grey", glm::vec3(0.5f)));
    Material material;
    material.name = "paper";
    material.metallic = 0.0f;
    material.doubleSided = true;
    builder.add("Sheet", quadMesh({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), builder.addMaterial(material));
    builder.addPoint("Lamp", {1.2f, 1.5f, 1}, glm::vec3(100.0f));
    return builder.finish();
}

} // namespace

class ExportTest : public QObject {
    Q_OBJECT
    QTemporaryDir folder_;

    std::filesystem::path at(const char* name) const { return folder_.filePath(name).toStdString(); }

private Q_SLOTS:
    void lightmapThroughGltfIsTheFieldsLight()
    {
        const Exporter exporter(*sampleScene("cornell"));
        ExportRequest request;
        request.gltf = at("cornell.glb");
        request.atlas.size = 512;
        const auto report = exporter.run(request);
        QVERIFY2(report, report ? "" : report.error().message.c_str());
        QCOMPARE(report->files.size(), std::size_t(2));
        QVERIFY(report->files[0] == at("cornell.exr") && report->files[1] == at("cornell.glb"));

        const auto scene = readScene(at("cornell.glb"));
        QVERIFY2(scene, scene ? "" : scene.error().message.c_str());
        const auto picture = readExr(at("cornell.exr"));
        QVERIFY2(picture, picture ? "" : picture.error().message.c_str());
        QCOMPARE(picture->layers.size(), std::size_t(1));
        const FloatImage* lux = picture->find("");
        QVERIFY(lux && lux->width == 512 && lux->height == 512);

        double squares = 0.0, mean = 0.0;
        int count = 0;
        for (const Instance& instance : (*scene)->instances) {
            const Mesh& mesh = (*scene)->meshes[static_cast<std::size_t>(instance.mesh)];
            QCOMPARE(mesh.uv[1].size(), mesh.positions.size());
            for (const glm::uvec3 t : mesh.triangles) {
                const std::array<glm::vec2, 3> uv{mesh.uv[1][t.x], mesh.uv[1][t.y], mesh.uv[1][t.z]};
                for (const glm::vec2 p : uv) QVERIFY(p.x > 0.0f && p.x < 1.0f && p.y > 0.0f && p.y < 1.0f);
                std::array<glm::vec3, 3> p{};
                for (int k = 0; k < 3; ++k) {
                    const glm::vec4 world = instance.toWorld * glm::vec4(mesh.positions[t[k]], 1.0f);
                    p[static_cast<std::size_t>(k)] = exporter.lit.scene->toScene((*scene)->toFile(glm::vec3(world)));
                }
                const glm::vec3 n = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
                for (const glm::dvec3 w : spreadWeights()) {
                    const glm::vec3 here = p[0] * float(w.x) + p[1] * float(w.y) + p[2] * float(w.z);
                    glm::vec3 expected;
                    if (!exporter.bake.field->lookup(here, n, expected)) continue;
                    const glm::dvec3 error(bilinear(*lux, uvAt(uv, w)) - expected);
                    squares += glm::dot(error, error);
                    mean += glm::length(glm::dvec3(expected));
                    ++count;
                }
            }
        }
        QVERIFY2(count > 1000, qPrintable(QString::number(count)));
        const double error = std::sqrt(squares / count) / (mean / count);
        QVERIFY2(error <= 0.05, qPrintable(QString::number(error))); // an eighth of these points lie on borders
    }

    void eightBitsHoldTheSamePicture()
    {
        FloatImage lux(3, 1);
        lux.pixels = {{0.0f, 10.0f, 200.0f}, {400.0f, 1.0f, 50.0f}, {0.0f, 0.0f, 0.0f}};
        const EncodedLightmap encoded = encodeLightmap(lux);
        QCOMPARE(encoded.intensity, 400.0f);
        for (std::size_t i = 0; i < 3; ++i) {
            for (int c = 0; c < 3; ++c) {
                const float back = float(encoded.image.rgba[4 * i + std::size_t(c)]) / 255.0f * encoded.intensity;
                QVERIFY(std::abs(back - lux.pixels[i][c]) <= 0.5f / 255.0f * encoded.intensity * 1.001f);
            }
            QCOMPARE(int(encoded.image.rgba[4 * i + 3]), 255);
        }
        const EncodedLightmap black = encodeLightmap(FloatImage(2, 2));
        QCOMPARE(black.intensity, 1.0f);
        QVERIFY(std::ranges::count(black.image.rgba, 255) == 4);
    }

    void materialsNameTheLightmap()
    {
        const Exporter exporter(*sampleScene("cornell"));
        ExportRequest request;
        request.gltf = at("named.glb");
        request.lightmap = at("other name.exr");
        request.atlas.size = 256;
        const auto report = exporter.run(request);
        QVERIFY2(report, report ? "" : report.error().message.c_str());
        const nlohmann::json json = jsonOf(bytesOf(request.gltf));
        for (const auto& material : json.at("materials")) {
            const auto& lightmap = material.at("extensions").at("MOZ_lightmap");
            QCOMPARE(lightmap.at("texCoord").get<int>(), 1);
            QCOMPARE(lightmap.at("intensity").get<float>(), report->brightest);
            const auto& texture = json.at("textures").at(lightmap.at("index").get<std::size_t>());
            QCOMPARE(texture.at("source").get<std::size_t>(), json.at("images").size() - 1);
            const auto& sampler = json.at("samplers").at(texture.at("sampler").get<std::size_t>());
            QCOMPARE(sampler.at("minFilter").get<int>(), 9729);
        }
        QVERIFY(std::ranges::count(json.at("extensionsUsed"), nlohmann::json("MOZ_lightmap")) == 1);
        const auto& extras = json.at("scenes").at(0).at("extras").at("lightloom").at("lightmap");
        QCOMPARE(QString::fromStdString(extras.at("file").get<std::string>()), QString("other name.exr"));
        QCOMPARE(QString::fromStdString(extras.at("light").get<std::string>()), QString("indirect"));
        QVERIFY(!std::filesystem::exists(at("named.exr")));
        const auto picture = readExr(request.lightmap);
        QVERIFY2(picture, picture ? "" : picture.error().message.c_str());
        std::map<std::string, std::string> notes(picture->notes.begin(), picture->notes.end());
        QVERIFY(notes["lightloom.unit"] == "lux" && notes["lightloom.light"] == "indirect");
        QVERIFY(notes["lightloom.method"] == "light-octree" && notes["lightloom.photons"] == "20000");
        QVERIFY(notes["lightloom.scene"] == toHex(exporter.info.sceneHash));
    }

    void sidesWithPlacesOfTheirOwnComeTwice()
    {
        const Exporter exporter(sheetInRoom());
        ExportRequest request;
        request.gltf = at("sheet.glb");
        request.atlas.size = 256;
        const auto report = exporter.run(request);
        QVERIFY2(report, report ? "" : report.error().message.c_str());
        const auto scene = readScene(request.gltf);
        QVERIFY2(scene, scene ? "" : scene.error().message.c_str());
        std::set<std::pair<float, float>> corners;
        int up = 0, down = 0;
        for (const Instance& instance : (*scene)->instances) {
            const Mesh& mesh = (*scene)->meshes[static_cast<std::size_t>(instance.mesh)];
            const Material& material = (*scene)->materials[static_cast<std::size_t>(mesh.material)];
            if (material.name != "paper") continue;
            QVERIFY(!material.doubleSided);
            for (const glm::uvec3 t : mesh.triangles) {
                const glm::vec3 a = mesh.positions[t.x];
                ++(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a).y > 0.0f ? up : down);
            }
            for (const glm::vec2 p : mesh.uv[1]) corners.emplace(p.x, p.y);
        }
        QCOMPARE(up, 2);
        QCOMPARE(down, 2);
        QCOMPARE(corners.size(), std::size_t(8)); // two quads in the atlas
    }

    void directLightLeavesTheLampsOut()
    {
        const Exporter exporter(sheetInRoom());
        ExportRequest request;
        request.gltf = at("direct.glb");
        request.atlas.size = 128;
        const auto indirect = exporter.run(request);
        QVERIFY(indirect && jsonOf(bytesOf(request.gltf)).contains("extensions"));
        request.withDirect = true;
        const auto both = exporter.run(request);
        QVERIFY2(both, both ? "" : both.error().message.c_str());
        QVERIFY(!jsonOf(bytesOf(request.gltf)).contains("extensions"));
        QVERIFY(both->brightest > 2.0f * indirect->brightest); // the lamp hangs .5 m from the ceiling
    }

    void secondUvSetsOfTexturesMove()
    {
        SceneBuilder builder("uv");
        Image image{"checker", 2, 2, std::vector<std::uint8_t>(16, 200)};
        Material material;
        material.metallic = 0.0f;
        material.baseColorTexture.image = builder.addImage(image);
        material.baseColorTexture.uvSet = 1;
        Mesh quad = texturedQuadMesh({-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
        for (const glm::vec2 p : quad.uv[0]) quad.uv[1].push_back(0.5f * p);
        builder.add("Quad", quad, builder.addMaterial(material));
        builder.addPoint("Lamp", {0, 1, 0}, glm::vec3(10.0f));
        const Exporter exporter(builder.finish());
        ExportRequest request;
        request.gltf = at("uv.glb");
        request.atlas.size = 64;
        const auto report = exporter.run(request);
        QVERIFY2(report, report ? "" : report.error().message.c_str());
        const nlohmann::json json = jsonOf(bytesOf(request.gltf));
        const auto& texture = json.at("materials").at(0).at("pbrMetallicRoughness").at("baseColorTexture");
        QCOMPARE(texture.at("texCoord").get<int>(), 2);
        const auto& attributes = json.at("meshes").at(0).at("primitives").at(0).at("attributes");
        QVERIFY(attributes.contains("TEXCOORD_0") && attributes.contains("TEXCOORD_1") &&
                attributes.contains("TEXCOORD_2"));
        // or the set itself is the atlas
        request.atlas.useSceneUv = true;
        const auto own = exporter.run(request);
        QVERIFY2(own, own ? "" : own.error().message.c_str());
        QVERIFY(std::abs(own->atlas->report.utilisation - 0.25) < 0.02);
    }

    void volumeIsPlainOpenVdb()
    {
        const Exporter exporter(*sampleScene("cornell"));
        ExportRequest request;
        request.volume = at("octree.vdb");
        const auto report = exporter.run(request);
        QVERIFY2(report, report ? "" : report.error().message.c_str());
        QVERIFY(!report->atlas && report->files.size() == 1);
        const std::vector<std::uint8_t> bytes = bytesOf(request.volume);
        QVERIFY(!openSeal(bytes)); // no trailer
        const VdbFile file(std::string(bytes.begin(), bytes.end()));
        const auto octree = exporter.bake.octree();
        const OctreeGeometry& geometry = octree->geometry();
        std::vector<glm::ivec3> cells = file.cells("irradiance");
        QCOMPARE(cells.size(), geometry.cells.size()); // dark ones too
        QVERIFY(file.contains("illuminance") && file.contains("area") && file.contains("normal"));
        QVERIFY(file.contains("vdl0_colour") && file.contains("vdl0_direction"));
        QVERIFY(file.text("lightloom.unit") == "lux");

        cells.clear();
        for (const std::uint64_t code : geometry.cells) cells.emplace_back(mortonCell(code));
        const std::vector<glm::vec3> lux = file.vectors("irradiance", cells), normals = file.vectors("normal", cells);
        const std::vector<float> area = file.numbers("area", cells);
        double power = 0.0, expected = 0.0; // lm: area times lux, over all entries
        for (std::size_t i = 0; i < cells.size(); ++i) {
            power += double(area[i]) * double(lux[i].y);
            QVERIFY(std::abs(glm::length(normals[i]) - 1.0f) < 1e-5f);
            for (std::uint32_t e = geometry.firstEntry[i]; e < geometry.firstEntry[i + 1]; ++e) {
                for (const auto& layer : octree->layers()) {
                    if (layer) expected += double(geometry.entries[e].area) * double(layer->scalar[e].y);
                }
            }
        }
        QVERIFY(expected > 0.0);
        QVERIFY2(std::abs(power / expected - 1.0) < 1e-5, qPrintable(QString::number(power / expected)));
    }

    void darkLeavesAreActive() // equal to the grid's background
    {
        BakeParams none = quick();
        none.photonCount = 0;
        const Exporter exporter(*sampleScene("cornell"), none);
        ExportRequest request;
        request.volume = at("dark.vdb");
        QVERIFY(exporter.run(request));
        const std::vector<std::uint8_t> bytes = bytesOf(request.volume);
        const VdbFile file(std::string(bytes.begin(), bytes.end()));
        QCOMPARE(file.cells("irradiance").size(), exporter.bake.octree()->geometry().cells.size());
    }

    void gridVolumeHoldsWhatSurfacesGet() // named vectors of the open vertices, and which those are
    {
        BakeParams params = quick();
        params.gridSize = 8;
        const Exporter exporter(*sampleScene("two_rooms"), params, Method::irradianceGrid);
        ExportRequest request;
        request.volume = at("grid.vdb");
        const auto report = exporter.run(request);
        QVERIFY2(report, report ? "" : report.error().message.c_str());
        const std::vector<std::uint8_t> bytes = bytesOf(request.volume);
        const VdbFile file(std::string(bytes.begin(), bytes.end()));
        QVERIFY(file.text("lightloom.method") == "irradiance-grid" && file.text("lightloom.unit") == "lux");
        const auto& grid = dynamic_cast<const IrradianceGrid&>(*exporter.bake.field);
        const GridLattice& lattice = grid.geometry().lattice;
        const std::vector<glm::ivec3> cells = file.cells("irradiance_plus_y");
        const auto isOpen = grid.geometry().openness.isOpen;
        QCOMPARE(cells.size(), std::size_t(std::ranges::count(isOpen, std::uint8_t{1})));
        const auto up = file.vectors("irradiance_plus_y", cells), shares = file.vectors("open", cells);
        const std::array along{file.vectors("irradiance_vector_r_plus_y", cells),
                               file.vectors("irradiance_vector_g_plus_y", cells),
                               file.vectors("irradiance_vector_b_plus_y", cells)};
        double sum = 0.0;
        for (std::size_t k = 0; k < cells.size(); ++k) {
            const IrradianceVectors& both = grid.layers()[0]->vectors[lattice.index(cells[k])];
            const IrradianceVectors& rest = grid.layers()[1]->vectors[lattice.index(cells[k])];
            for (int c = 0; c < 3; ++c) {
                QCOMPARE(along[std::size_t(c)][k], both[3][c] + rest[3][c]); // 3: +y
                QCOMPARE(up[k][c], along[std::size_t(c)][k].y);
            }
            QCOMPARE(shares[k], grid.geometry().openness.faceShare[lattice.index(cells[k])]);
            sum += double(up[k].y);
        }
        QVERIFY(sum > 0.0);
        std::vector<glm::ivec3> all;
        for (std::size_t i = 0; i < lattice.vertexCount(); ++i) all.push_back(lattice.vertex(i));
        const std::vector<float> valid = file.numbers("valid", all);
        for (std::size_t i = 0; i < all.size(); ++i) QCOMPARE(valid[i], isOpen[i] != 0 ? 1.0f : 0.0f);
    }

    void otherProgramsOpenTheGrid()
    {
        const QString printer = QStandardPaths::findExecutable("vdb_print");
        if (printer.isEmpty()) QSKIP("vdb_print (Debian: libopenvdb-tools) is not installed");
        BakeParams params = quick();
        params.gridSize = 6;
        const Exporter exporter(*sampleScene("cornell"), params, Method::irradianceGrid);
        ExportRequest request;
        request.volume = at("seen.vdb");
        QVERIFY(exporter.run(request));
        QProcess process;
        process.start(printer, {"-l", QString::fromStdString(request.volume.string())});
        QVERIFY(process.waitForFinished() && process.exitCode() == 0);
        const QString text = process.readAllStandardOutput();
        QVERIFY2(text.contains("valid") && text.contains("float"), qPrintable(text));
        for (const QString side : {"minus_x", "plus_x", "minus_y", "plus_y", "minus_z", "plus_z"}) {
            for (const QString grid : {"irradiance_", "irradiance_vector_r_", "irradiance_vector_g_"})
                QVERIFY2(text.contains(grid + side), qPrintable(text));
        }
        QVERIFY2(text.contains("vec3s"), qPrintable(text));
    }

    void sameBytesOnAnyNumberOfThreads()
    {
        const Exporter exporter(*sampleScene("cornell"));
        for (const int threads : {1, 5}) {
            ExportRequest request;
            request.lightmap = at("same.exr"), request.gltf = at("same.glb"), request.volume = at("same.vdb");
            request.atlas.size = 128;
            request.withDirect = true;
            QVERIFY(exporter.run(request, threads));
            for (const auto& path : {request.lightmap, request.gltf, request.volume}) {
                auto& before = files_[path.string()];
                const std::vector<std::uint8_t> now = bytesOf(path);
                QVERIFY(!now.empty());
                if (threads == 1) before = now;
                QVERIFY2(before == now, path.c_str());
            }
        }
    }

    void stopsLeaveNothing()
    {
        const Exporter exporter(*sampleScene("cornell"));
        ExportRequest request;
        request.lightmap = at("stop.exr"), request.gltf = at("stop.glb"), request.volume = at("stop.vdb");
        for (const double when : {0.0, 0.3, 0.6, 0.85}) {
            std::stop_source source;
            std::mutex mutex;
            double last = 0.0;
            const auto report = exporter.run(request, 2, source.get_token(), [&](double f) {
                std::lock_guard lock(mutex);
                last = std::max(last, f);
                if (f >= when) source.request_stop();
            });
            QVERIFY(!report && report.error().kind == Error::Kind::cancelled);
            QVERIFY(last >= when && last < 1.0);
            for (const auto& path : {request.lightmap, request.gltf, request.volume}) {
                QVERIFY(!std::filesystem::exists(path));
            }
        }
    }

    void wrongWishes()
    {
        const auto refused = [](ExportRequest request, const char* part, Method method = Method::lightOctree) {
            const Result<Done> checked = checkExport(request, method);
            return !checked && checked.error().message.find(part) != std::string::npos;
        };
        QVERIFY(refused({}, "say what to export"));
        ExportRequest request;
        request.lightmap = "a.png";
        QVERIFY(refused(request, "should end in .exr"));
        request = {};
        request.gltf = "a.gltf";
        QVERIFY(refused(request, "should end in .glb"));
        request = {};
        request.volume = "A.VDB";
        for (const Method method : {Method::lightOctree, Method::irradianceGrid, Method::voxelLightcuts})
            QVERIFY(checkExport(request, method));
        QVERIFY(refused(request, "photon-map", Method::photonMap));
    }

private:
    std::map<std::string, std::vector<std::uint8_t>> files_;
};

QTEST_APPLESS_MAIN(ExportTest)
#include "tst_export.moc"
