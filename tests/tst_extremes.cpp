// SPDX-License-Identifier: Apache-2.0
// Claims, line by line after the list of extremes: whatever the scene and parameters, results are finite and not
// negative, energy is right, nothing hangs. Photon methods: light-octree, photon-map and irradiance-grid; and
// voxel-lightcuts, by its field and by lightcuts.
#include "core/bake/packed_octree.h"
#include "core/base/units.h"
#include "core/ivg/ivg_solver.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/voxel/voxel_cuts.h"
#include "core/voxel/voxel_solver.h"
#include "tests/bake_helpers.h"
#include "tests/light_helpers.h"
#include <QtTest>
#include <cmath>

using namespace lightloom;
using test::share;

namespace {

BakeParams quick()
{
    BakeParams params;
    params.photonCount = 20'000;
    params.gatherCount = 50;
    params.octreeDepth = 5;
    return params;
}

void checkLedger(const Ledger& ledger)
{
    for (int c = 0; c < 3; ++c) {
        QVERIFY2(std::abs(ledger.missing()[c]) <= 1e-9 * ledger.emitted[c],
                 qPrintable(QString::number(ledger.missing()[c])));
    }
}

/// Every VDL and every lookup finite and not negative; the GPU form can be made.
void checkSound(const test::Baked& baked)
{
    QVERIFY2(baked.error.empty(), baked.error.c_str());
    const auto octree = baked.octree();
    QVERIFY(octree);
    for (const auto& layer : octree->layers()) {
        if (!layer) continue;
        for (const Vdl& v : layer->vdls) {
            for (int c = 0; c < 3; ++c) QVERIFY(std::isfinite(v.colour[c]) && v.colour[c] >= 0.0f);
            QVERIFY(std::abs(glm::length(v.toLight) - 1.0f) <= 1e-4f);
        }
    }
    for (const OctreeEntry& e : octree->geometry().entries) {
        const glm::vec3 lux = octree->irradiance(e.centroid, e.normal);
        for (int c = 0; c < 3; ++c) QVERIFY(std::isfinite(lux[c]) && lux[c] >= 0.0f);
    }
    for (const OctreeShow show : {OctreeShow::lights, OctreeShow::colour}) { // looked up as pixels do
        const auto packed = PackedOctree::make(octree->showing(show));
        QVERIFY2(static_cast<bool>(packed), packed ? "" : packed.error().message.c_str());
        for (const OctreeEntry& e : octree->geometry().entries) {
            const glm::vec3 lux = (*packed)->irradiance(e.centroid, e.normal);
            for (int c = 0; c < 3; ++c) QVERIFY(std::isfinite(lux[c]) && lux[c] >= 0.0f);
        }
    }
    checkLedger(baked.counters.ledger);
}

/// A grid of the scene whose vectors are all finite, and whose lookups, through every remap and filter, are neither
/// negative nor infinite. Gives it back.
test::Baked soundGrid(const std::shared_ptr<const Scene>& scene, BakeParams params, Mix mix = {})
{
    params.gridSize = 8;
    IvgSolver solver;
    BakeProducts products;
    test::Baked baked = test::runSolver(solver, {scene, params, std::move(mix)}, products);
    if (!baked.field) return qWarning("%s", baked.error.c_str()), baked;
    bool isSound = true;
    const auto& grid = dynamic_cast<const IrradianceGrid&>(*baked.field);
    for (const auto& layer : grid.layers()) {
        if (!layer) continue;
        for (const IrradianceVectors& vectors : layer->vectors) {
            for (const glm::mat3& one : vectors) {
                for (int c = 0; c < 3; ++c) isSound = isSound && isFinite(one[c]);
            }
        }
        for (const auto& each : layer->variance) {
            for (const float v : each) isSound = isSound && std::isfinite(v) && v >= 0.0f;
        }
    }
    for (int remap = 0; remap < 4; ++remap) {
        for (int filter = 0; filter < 3; ++filter) {
            const auto shown = grid.withShow({GridRemap(remap), GridFilter(filter), 0.5f});
            for (const test::FacePoint& p : test::facePoints(*scene, 100, 1)) {
                const glm::vec3 lux = shown->irradiance(p.position, p.normal);
                isSound = isSound && isFinite(lux) && glm::all(glm::greaterThanEqual(lux, glm::vec3(0.0f)));
            }
        }
    }
    if (!isSound) baked.error = "the grid is not sound";
    checkLedger(baked.counters.ledger);
    return baked;
}

bool isLight(glm::vec3 lux) { return isFinite(lux) && glm::all(glm::greaterThanEqual(lux, glm::vec3(0.0f))); }

/// Voxels of the scene whose light is finite and not negative, as they hold it, by the field and by lightcuts. Gives
/// the bake back.
test::Baked soundVoxels(const std::shared_ptr<const Scene>& scene, Mix mix = {}, int size = 16)
{
    BakeParams params;
    params.voxelSize = size;
    params.voxelDirections = 256;
    params.voxelRays = 8;
    VoxelSolver solver;
    BakeProducts products;
    test::Baked baked = test::runSolver(solver, {scene, params, std::move(mix)}, products);
    if (!baked.field) return qWarning("%s", baked.error.c_str()), baked;
    const auto field = std::dynamic_pointer_cast<const VoxelField>(baked.field);
    bool isSound = true;
    for (std::size_t e = 0; e < field->surface().leaves->entries.size(); ++e)
        isSound = isSound && isLight(field->direct(e)) && isLight(field->illuminance(e)) && isLight(field->exitance(e));
    const auto lights = std::make_shared<const LightSampler>(*RayScene::build(scene));
    const VoxelCuts cuts(field, lights, voxelShow(params));
    const std::vector<OctreeEntry>& entries = field->surface().leaves->entries;
    for (std::size_t e = 0; e < entries.size(); e += 1 + entries.size() / 50) {
        isSound = isSound && isLight(field->irradiance(entries[e].centroid, entries[e].normal)) &&
                  isLight(cuts.irradiance(entries[e].centroid, entries[e].normal));
    }
    const glm::vec3 nan(std::numeric_limits<float>::quiet_NaN()), up(0.0f, 1.0f, 0.0f);
    for (const IndirectField* each :
         {static_cast<const IndirectField*>(field.get()), static_cast<const IndirectField*>(&cuts)})
        isSound = isSound && isLight(each->irradiance(nan, up)) && isLight(each->irradiance(glm::vec3(0.0f), nan));
    if (!isSound) baked.error = "the voxels are not sound";
    return baked;
}

/// Mean over the faces, lux.
double meanLux(const test::Baked& grid, const Scene& scene)
{
    RunningMean mean;
    for (const test::FacePoint& p : test::facePoints(scene, 2000, 1))
        mean.add(double(luminance(grid.field->irradiance(p.position, p.normal))));
    return mean.mean();
}

double meanLux(const test::Baked& baked)
{
    const auto octree = baked.octree();
    double sum = 0.0, area = 0.0;
    for (const OctreeEntry& e : octree->geometry().entries) {
        sum += static_cast<double>(e.area) * static_cast<double>(luminance(octree->irradiance(e.centroid, e.normal)));
        area += static_cast<double>(e.area);
    }
    return area > 0.0 ? sum / area : 0.0;
}

Scene scaled(Scene scene, float factor)
{
    for (Instance& instance : scene.instances) {
        for (int c = 0; c < 4; ++c)
            instance.toWorld[c] = glm::vec4(glm::vec3(instance.toWorld[c]) * factor, instance.toWorld[c].w);
    }
    for (PunctualLight& light : scene.lights) light.position *= factor;
    finishScene(scene, {});
    return scene;
}

} // namespace

class ExtremesTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void noLights()
    {
        Scene scene = cornellBox();
        for (Material& m : scene.materials) m.emission = glm::vec3(0.0f);
        finishScene(scene, {});
        const test::Baked baked = test::bakeOctree(share(scene), quick());
        checkSound(baked);
        QCOMPARE(baked.counters.photonsShot, std::uint64_t(0));
        QCOMPARE(baked.counters.raysTraced, std::uint64_t(0));
        QCOMPARE(meanLux(baked), 0.0);
        const test::Baked grid = soundGrid(share(scene), quick());
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QCOMPARE(grid.counters.photonsShot + grid.counters.raysTraced + grid.counters.deposits, std::uint64_t(0));
        QCOMPARE(meanLux(grid, scene), 0.0);
        const test::Baked voxels = soundVoxels(share(scene));
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
        QCOMPARE(voxels.counters.groupsBaked + voxels.counters.bounces, std::uint64_t(0));
        QCOMPARE(meanLux(voxels, scene), 0.0);
    }

    void everyLampOff()
    {
        const test::Baked baked = test::bakeOctree(share(cornellBox()), quick(), 2, {glm::vec3(0.0f)});
        checkSound(baked);
        QCOMPARE(baked.counters.photonsShot, std::uint64_t(0));
        QCOMPARE(baked.counters.groupsOff, std::uint64_t(1));
        QCOMPARE(baked.counters.gathers, std::uint64_t(0));
        const test::Baked grid = soundGrid(share(cornellBox()), quick(), {glm::vec3(0.0f)});
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QCOMPARE(grid.counters.photonsShot + grid.counters.deposits, std::uint64_t(0));
        QCOMPARE(grid.counters.groupsOff, std::uint64_t(1));
        const test::Baked voxels = soundVoxels(share(cornellBox()), {glm::vec3(0.0f)});
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
        QCOMPARE(voxels.counters.groupsOff, std::uint64_t(1));
        QCOMPARE(voxels.counters.bounces, std::uint64_t(0));
    }

    void fewPhotons_data()
    {
        QTest::addColumn<int>("photons");
        QTest::addColumn<int>("k");
        QTest::newRow("none") << 0 << 50;
        QTest::newRow("one") << 1 << 50;
        QTest::newRow("K - 1") << 49 << 50;
        QTest::newRow("K far above the count") << 1000 << 100'000;
        QTest::newRow("K = 1") << 20'000 << 1;
    }
    void fewPhotons()
    {
        QFETCH(int, photons);
        QFETCH(int, k);
        BakeParams params = quick();
        params.photonCount = photons;
        params.gatherCount = k;
        const test::Baked baked = test::bakeOctree(share(cavityCube(0.5f)), params);
        checkSound(baked);
        QCOMPARE(baked.counters.photonsShot, static_cast<std::uint64_t>(photons));
        PhotonMapSolver solver;
        BakeProducts products;
        const test::Baked map = test::runSolver(solver, {share(cavityCube(0.5f)), params, {}}, products);
        const glm::vec3 lux = map.field->irradiance({0.0f, -2.0f, 0.0f}, {0, 1, 0});
        QVERIFY(std::isfinite(lux.x) && lux.x >= 0.0f);
        const test::Baked grid = soundGrid(share(cavityCube(0.5f)), params);
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QCOMPARE(grid.counters.photonsShot, static_cast<std::uint64_t>(photons));
    }

    void everyPhotonOnOnePoint() // a needle-thin spot onto a floor under a black roof: all second hits in one place
    {
        SceneBuilder builder("needle");
        const int white = builder.addMaterial("white", glm::vec3(0.8f));
        builder.add("Box", boxMesh(glm::vec3(-1.0f), glm::vec3(1.0f), Facing::in), white);
        builder.addSpot("Needle", {0, 0.9f, 0}, {0, -1.0f, 0}, glm::vec3(1000.0f), 0.0f, 1e-4f);
        const auto scene = share(builder.finish());
        checkSound(test::bakeOctree(scene, quick()));
        const test::Baked grid = soundGrid(scene, quick()), voxels = soundVoxels(scene);
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
    }

    void oppositeDirections() // two lamps face to face light a sheet edge on from both sides
    {
        SceneBuilder builder("opposite");
        const int white = builder.addMaterial("white", glm::vec3(0.8f));
        builder.add("Box", boxMesh(glm::vec3(-1.0f), glm::vec3(1.0f), Facing::in), white);
        builder.add("Sheet", quadMesh({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 0, 1}), white);
        builder.addPoint("A", {-0.9f, 0, 0}, glm::vec3(10.0f), "both");
        builder.addPoint("B", {0.9f, 0, 0}, glm::vec3(10.0f), "both");
        const auto scene = share(builder.finish());
        for (const int k : {1, 8}) {
            BakeParams params = quick();
            params.vdlCount = k;
            checkSound(test::bakeOctree(scene, params));
        }
        const test::Baked grid = soundGrid(scene, quick()), voxels = soundVoxels(scene);
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
    }

    void albedos_data()
    {
        QTest::addColumn<double>("rho");
        for (const double rho : {0.0, 0.98, 1.0}) QTest::addRow("rho %g", rho) << rho;
    }
    void albedos()
    {
        QFETCH(double, rho);
        BakeParams params = quick();
        params.pathDepth = 100'000;
        const auto scene = share(cavityCube(static_cast<float>(rho)));
        const test::Baked baked = test::bakeOctree(scene, params);
        checkSound(baked);
        // 1 is taken as .99, and said so
        QCOMPARE(scene->warnings.empty(), rho < 1.0);
        const double used = std::min(rho, 0.99), truth = 1000.0 * used / (96.0 * (1.0 - used));
        // 20,000 paths of geometric length: relative sigma sqrt(rho / n), 5 sigma
        QVERIFY2(std::abs(meanLux(baked) - truth) <= truth * (0.02 + 5.0 * std::sqrt(used / 20'000.0)),
                 qPrintable(QString("%1 of %2").arg(meanLux(baked)).arg(truth)));
        const test::Baked grid = soundGrid(scene, params);
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QVERIFY2(std::abs(meanLux(grid, *scene) - truth) <= truth * (0.02 + 5.0 * std::sqrt(used / 20'000.0)),
                 qPrintable(QString("%1 of %2").arg(meanLux(grid, *scene)).arg(truth)));
        // .1 % a bounce, 2 % at rho = .95 (tst_voxel_bounces)
        const test::Baked voxels = soundVoxels(scene, {}, 32);
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
        const double mean = meanLux(voxels, *scene), most = 0.001 * used / (1.0 - used) + 0.005;
        qInfo("voxels: off by %.2f %%, %.2f %% allowed", 100.0 * (mean / truth - 1.0), 100.0 * most);
        QVERIFY2(std::abs(mean - truth) <= most * truth, qPrintable(QString("voxels %1 of %2").arg(mean).arg(truth)));
    }

    void brokenTriangles() // without area, needles, doubled vertices and coplanar sheets
    {
        Scene scene = cavityCube(0.5f);
        Mesh& mesh = scene.meshes[0];
        const auto first = static_cast<unsigned>(mesh.positions.size());
        for (const glm::vec3 p : {glm::vec3(0.0f), glm::vec3(0.0f), glm::vec3(1.0f), glm::vec3(1.0f, 1e-7f, 0.0f),
                                  glm::vec3(-1.0f, 1e-7f, 0.0f), glm::vec3(0.5f, 0.5f, 0.5f)}) {
            mesh.positions.push_back(p);
            if (!mesh.normals.empty()) mesh.normals.push_back({0, 1, 0});
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        mesh.triangles.push_back({first, first, first});
        mesh.triangles.push_back({first + 3, first + 4, first});
        const std::vector<glm::uvec3> copy = mesh.triangles; // every sheet twice
        mesh.triangles.insert(mesh.triangles.end(), copy.begin(), copy.end());
        finishScene(scene, {});
        checkSound(test::bakeOctree(share(scene), quick()));
        const test::Baked grid = soundGrid(share(scene), quick()), voxels = soundVoxels(share(scene));
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
    }

    void hardlyAnyScene() // voxels of nothing, of one triangle, of one that is as small as it gets
    {
        for (const float size : {0.0f, 1.0f, 1e-18f}) {
            SceneBuilder builder("triangle");
            const int white = builder.addMaterial("white", glm::vec3(0.5f));
            builder.addPoint("Lamp", {0, 1, 0}, glm::vec3(100.0f));
            Mesh mesh;
            mesh.positions = {{0, 0, 0}, {0, 0, size}, {size, 0, 0}};
            mesh.triangles = {{0, 1, 2}};
            if (size > 0.0f) builder.add("Triangle", mesh, white);
            const test::Baked voxels = soundVoxels(share(builder.finish()));
            QVERIFY2(voxels.error.empty(), voxels.error.c_str());
        }
    }

    void thinWall() // far thinner than a cell: both sides keep their own light
    {
        SceneBuilder builder("thin wall");
        const int white = builder.addMaterial("white", glm::vec3(0.5f));
        builder.add("Box", boxMesh(glm::vec3(-1.0f), glm::vec3(1.0f), Facing::in), white);
        builder.add("Wall", boxMesh({-0.001f, -1.0f, -1.0f}, {0.001f, 1.0f, 1.0f}, Facing::out), white);
        builder.addPoint("Lamp", {0.5f, 0, 0}, glm::vec3(100.0f));
        const auto scene = share(builder.finish());
        const test::Baked baked = test::bakeOctree(scene, quick()), grid = soundGrid(scene, quick()),
                          voxels = soundVoxels(scene);
        checkSound(baked);
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
        for (const auto& field : {baked.field, grid.field, voxels.field}) {
            const glm::vec3 lit = field->irradiance({0.001f, 0, 0}, {1, 0, 0});
            const glm::vec3 dark = field->irradiance({-0.001f, 0, 0}, {-1, 0, 0});
            QVERIFY2(lit.x > 10.0f && dark.x <= 1e-3f * lit.x,
                     qPrintable(QString("%1 | %2").arg(double(lit.x)).arg(double(dark.x))));
        }
    }

    void flatScene()
    {
        SceneBuilder builder("flat");
        builder.add("Floor", quadMesh({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}),
                    builder.addMaterial("white", glm::vec3(0.5f)));
        builder.addPoint("Lamp", {0, 1, 0}, glm::vec3(100.0f));
        const auto scene = share(builder.finish());
        const test::Baked baked = test::bakeOctree(scene, quick()), grid = soundGrid(scene, quick());
        checkSound(baked);
        QCOMPARE(meanLux(baked), 0.0); // nothing to bounce to
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QCOMPARE(meanLux(grid, *scene), 0.0);
        const test::Baked voxels = soundVoxels(scene);
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
        QCOMPARE(meanLux(voxels, *scene), 0.0);
    }

    void sizes_data()
    {
        QTest::addColumn<double>("factor");
        for (const double f : {1e-4, 1e-2, 1e3, 2.5e4}) QTest::addRow("x %g", f) << f;
    }
    void sizes() // E scales with 1 / factor^2 at equal flux
    {
        QFETCH(double, factor);
        const double small = meanLux(test::bakeOctree(share(cavityCube(0.5f)), quick()));
        const test::Baked baked =
            test::bakeOctree(share(scaled(cavityCube(0.5f), static_cast<float>(factor))), quick());
        checkSound(baked);
        const double ratio = meanLux(baked) * factor * factor / small;
        QVERIFY2(std::abs(ratio - 1.0) <= 0.01, qPrintable(QString::number(ratio)));
        const auto unit = share(cavityCube(0.5f)), other = share(scaled(cavityCube(0.5f), static_cast<float>(factor)));
        const test::Baked grid = soundGrid(other, quick());
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        const double grids = meanLux(grid, *other) * factor * factor / meanLux(soundGrid(unit, quick()), *unit);
        QVERIFY2(std::abs(grids - 1.0) <= 0.01, qPrintable(QString::number(grids)));
        const test::Baked voxels = soundVoxels(other);
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
        const double fields = meanLux(voxels, *other) * factor * factor / meanLux(soundVoxels(unit), *unit);
        QVERIFY2(std::abs(fields - 1.0) <= 0.01, qPrintable(QString::number(fields)));
    }

    void lampsOfAllStrengths() // 1e-6 and 1e9 cd side by side, in one group and in two
    {
        for (const bool joined : {false, true}) {
            Scene scene = cavityCube(0.5f, 1.0f);
            PunctualLight strong = scene.lights[0], weak = scene.lights[0];
            strong.intensity = glm::vec3(1e9f);
            strong.position.x += 0.5f;
            strong.node = "Strong";
            weak.intensity = glm::vec3(1e-6f, 0.0f, 0.0f);
            weak.node = "Weak";
            scene.lights = {strong, weak};
            std::vector<std::string> names(scene.instances.size(), "");
            for (int i = 0; i < 2; ++i) names.emplace_back(joined ? "lamps" : "");
            finishScene(scene, names);
            const test::Baked baked = test::bakeOctree(share(scene), quick()), grid = soundGrid(share(scene), quick()),
                              voxels = soundVoxels(share(scene));
            checkSound(baked);
            QVERIFY2(grid.error.empty(), grid.error.c_str());
            QVERIFY2(voxels.error.empty(), voxels.error.c_str());
            for (const auto& field : {baked.field, grid.field, voxels.field}) {
                if (joined) continue;
                const auto weakOnly = field->withMix({glm::vec3(0.0f), glm::vec3(1.0f)});
                const glm::vec3 lux = weakOnly->irradiance(scene.bounds.low + glm::vec3(2.0f, 0.0f, 2.0f), {0, 1, 0});
                const double truth = 4.0 * M_PI * 1e-6 * 0.5 / (96.0 * 0.5);
                QVERIFY2(std::abs(static_cast<double>(lux.x) / truth - 1.0) <= 0.5,
                         qPrintable(QString::number(static_cast<double>(lux.x) / truth)));
                QCOMPARE(lux.y, 0.0f);
            }
        }
    }

    void deepAndSingleCells()
    {
        for (const int depth : {1, 8}) {
            BakeParams params = quick();
            params.octreeFirstDepth = params.octreeDepth = depth;
            params.photonCount = 5000;
            params.gatherCount = 20;
            checkSound(test::bakeOctree(share(cornellBox()), params));
        }
        for (const int size : {1, 2, 128}) {
            const test::Baked voxels = soundVoxels(share(cornellBox()), {}, size);
            QVERIFY2(voxels.error.empty(), voxels.error.c_str());
        }
    }

    void manyLamps() // a thousand in one light group, and a hundred groups of one
    {
        for (const bool joined : {true, false}) {
            SceneBuilder builder("lamps");
            const int white = builder.addMaterial("white", glm::vec3(0.5f));
            builder.add("Box", boxMesh(glm::vec3(-1.0f), glm::vec3(1.0f), Facing::in), white);
            const int count = joined ? 1000 : 100;
            for (int i = 0; i < count; ++i) {
                const float turn = 0.1f * float(i);
                builder.addPoint("Lamp" + std::to_string(i), {0.4f * std::cos(turn), 0.2f, 0.4f * std::sin(turn)},
                                 glm::vec3(1.0f), joined ? "all" : "");
            }
            const auto scene = share(builder.finish());
            const test::Baked voxels = soundVoxels(scene);
            QVERIFY2(voxels.error.empty(), voxels.error.c_str());
            QCOMPARE(voxels.counters.groupsBaked, std::uint64_t(joined ? 1 : count));
            const double truth = 4.0 * M_PI * count * 0.5 / (24.0 * 0.5), mean = meanLux(voxels, *scene);
            // so coarse a lattice is 3.8 % too bright here, whatever the number of lamps
            QVERIFY2(std::abs(mean - truth) <= 0.05 * truth, qPrintable(QString("%1 of %2").arg(mean).arg(truth)));
        }
    }

    void lampInsideAWallAndInABox()
    {
        SceneBuilder builder("closed lamp");
        const int white = builder.addMaterial("white", glm::vec3(0.5f));
        builder.add("Room", boxMesh(glm::vec3(-1.0f), glm::vec3(1.0f), Facing::in), white);
        builder.add("Case", boxMesh(glm::vec3(-0.1f), glm::vec3(0.1f), Facing::out), white);
        builder.addPoint("In the case", {0, 0, 0}, glm::vec3(100.0f));
        builder.addPoint("In the wall", {1.0f, 0, 0}, glm::vec3(100.0f));
        const auto scene = share(builder.finish());
        const Mix inner{glm::vec3(1.0f), glm::vec3(0.0f)};
        const test::Baked baked = test::bakeOctree(scene, quick(), 2, inner), grid = soundGrid(scene, quick(), inner),
                          voxels = soundVoxels(scene, inner);
        checkSound(baked);
        QVERIFY2(grid.error.empty(), grid.error.c_str());
        QVERIFY2(voxels.error.empty(), voxels.error.c_str());
        for (const auto& field : {baked.field, grid.field, voxels.field}) {
            const glm::vec3 floor = field->irradiance({0.5f, -1.0f, 0.5f}, {0, 1, 0});
            QCOMPARE(floor, glm::vec3(0.0f)); // a closed lamp lights nothing outside its case
        }
        checkSound(test::bakeOctree(share(cavityCube(0.5f)), quick()));
    }

    void tooManyPhotonsAreRefusedBeforeShooting()
    {
        BakeParams params;
        params.photonCount = 1'000'000'000;
        QElapsedTimer timer;
        timer.start();
        const test::Baked baked = test::bakeOctree(share(cavityCube(0.5f)), params);
        QVERIFY2(QString::fromStdString(baked.error).contains("GiB"), baked.error.c_str());
        QVERIFY(timer.elapsed() < 5000);
        QCOMPARE(baked.counters.photonsShot, std::uint64_t(0));
    }
};

QTEST_APPLESS_MAIN(ExtremesTest)
#include "tst_extremes.moc"
