// SPDX-License-Identifier: Apache-2.0
// Claims: leaves hold exactly the reached surface; the light octree's mean and furnace values are the analytic ones,
// whatever k; light groups add up; a progressive bake ends in the bits of a direct one, on any number of threads.
#include "core/base/units.h"
#include "core/octree/layer_fit.h"
#include "core/octree/octree_build.h"
#include "core/octree/octree_solver.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "tests/bake_helpers.h"
#include <QtTest>
#include <cmath>
#include <cstring>

using namespace lightloom;

using test::share;

namespace {

struct Baked {
    std::shared_ptr<const LightOctree> octree;
    std::vector<int> levels;
    WorkCounters counters;
    std::string error;
};

Baked bake(std::shared_ptr<const Scene> scene, const BakeParams& params, int threads = 2, Mix mix = {},
           BakeProducts* kept = nullptr)
{
    OctreeSolver solver;
    BakeProducts own;
    const test::Baked all =
        test::runSolver(solver, {std::move(scene), params, std::move(mix)}, kept ? *kept : own, threads);
    Baked result{all.octree(), {}, all.counters, all.error};
    for (const Snapshot& snapshot : all.snapshots) result.levels.push_back(snapshot.level);
    return result;
}

/// Area-weighted mean over entries of the light on their own normals.
double meanIlluminance(const LightOctree& octree)
{
    double sum = 0.0, area = 0.0;
    for (const OctreeEntry& e : octree.geometry().entries) {
        sum += static_cast<double>(e.area * luminance(octree.irradiance(e.centroid, e.normal)));
        area += static_cast<double>(e.area);
    }
    return sum / area;
}

bool sameBits(const LightOctree& a, const LightOctree& b)
{
    if (a.geometry().entries.size() != b.geometry().entries.size()) return false;
    for (std::size_t g = 0; g < a.layers().size(); ++g) {
        const auto &x = a.layers()[g], &y = b.layers()[g];
        if (static_cast<bool>(x) != static_cast<bool>(y)) return false;
        if (x && std::memcmp(x->vdls.data(), y->vdls.data(), x->vdls.size() * sizeof(Vdl)) != 0) return false;
    }
    return true;
}

} // namespace

class OctreeTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void leavesHoldTheReachedSurface_data()
    {
        QTest::addColumn<int>("depth");
        QTest::addColumn<double>("shift");
        for (const int d : {1, 4, 6}) {
            for (const double shift : {0.0, 0.25, 0.75}) QTest::addRow("d%d shift %g", d, shift) << d << shift;
        }
    }
    void leavesHoldTheReachedSurface()
    {
        QFETCH(int, depth);
        QFETCH(double, shift);
        const auto rays = *RayScene::build(share(cornellBox()));
        const LightSampler lights(rays);
        Workers workers(2);
        const auto reach = LightReach::find(*rays, lights, workers, {});
        const std::shared_ptr<const SurfaceArea> area = SurfaceArea::build(*reach);
        const auto octree = buildOctree(rays->scene().bounds, *reach, depth, static_cast<float>(shift), workers, {});
        double sum = 0.0;
        for (std::size_t i = 0; i < octree->cells.size(); ++i) {
            const glm::vec3 low = octree->lowest + glm::vec3(mortonCell(octree->cells[i])) * octree->cellSize();
            for (std::uint32_t e = octree->firstEntry[i]; e < octree->firstEntry[i + 1]; ++e) {
                const OctreeEntry& entry = octree->entries[e];
                sum += static_cast<double>(entry.area);
                const float slack = 1e-4f * octree->cellSize();
                for (int a = 0; a < 3; ++a) {
                    QVERIFY(entry.centroid[a] >= low[a] - slack &&
                            entry.centroid[a] <= low[a] + octree->cellSize() + slack);
                }
                QVERIFY(std::abs(glm::length(entry.normal) - 1.0f) <= 1e-5f && entry.area > 0.0f);
            }
            QCOMPARE(octree->leafAt(glm::ivec3(mortonCell(octree->cells[i]))), static_cast<std::int64_t>(i));
        }
        QVERIFY2(std::abs(sum / area->total() - 1.0) <= 1e-5,
                 qPrintable(QString("%1 of %2").arg(sum).arg(area->total())));
        QCOMPARE(octree->leafAt({-1, 0, 0}), std::int64_t(-1));
        QCOMPARE(octree->leafAt({1 << depth, 0, 0}), std::int64_t(-1));
    }

    void closedCubeHasItsMean_data()
    {
        QTest::addColumn<double>("rho");
        for (const double rho : {0.2, 0.5, 0.8}) QTest::addRow("rho %g", rho) << rho;
    }
    void closedCubeHasItsMean() // A6: Phi rho / (A (1 - rho))
    {
        QFETCH(double, rho);
        const Baked baked = bake(share(cavityCube(static_cast<float>(rho))), BakeParams{});
        QVERIFY2(baked.octree, baked.error.c_str());
        const double mean = meanIlluminance(*baked.octree), truth = 1000.0 * rho / (96.0 * (1.0 - rho));
        QVERIFY2(std::abs(mean / truth - 1.0) <= 0.02,
                 qPrintable(QString("%1 of %2: %3").arg(mean).arg(truth).arg(mean / truth)));
        const Ledger& ledger = baked.counters.ledger;
        QVERIFY2(std::abs(ledger.missing().x / ledger.emitted.x) <= 1e-9,
                 qPrintable(QString::number(ledger.missing().x)));
        QVERIFY2(ledger.escaped.x <= 1e-5 * ledger.emitted.x, "light leaks out of a closed cube");
    }

    void furnaceDoesNotDependOnK() // A8: indirect E = M rho / (1 - rho) at every point
    {
        const double rho = 0.5, truth = 1.0;
        const auto scene = share(furnaceBox(static_cast<float>(rho)));
        BakeProducts kept;
        double first = 0.0;
        for (int k = 1; k <= 8; ++k) {
            BakeParams params;
            params.octreeFirstDepth = params.octreeDepth = 4;
            params.vdlCount = k;
            const Baked baked = bake(scene, params, 2, {}, &kept);
            QVERIFY2(baked.octree, baked.error.c_str());
            const double mean = meanIlluminance(*baked.octree);
            if (k == 1) first = mean;
            QVERIFY2(std::abs(mean / first - 1.0) <= 0.01,
                     qPrintable(QString("k=%1: %2 of %3").arg(k).arg(mean).arg(first)));
            QVERIFY2(std::abs(mean / truth - 1.0) <= 0.02, qPrintable(QString("k=%1: %2").arg(k).arg(mean)));
            if (k > 1) QCOMPARE(baked.counters.photonsShot, std::uint64_t(0)); // k never shoots again
        }
    }

    void onlyWhatFacesTheSameWayAnswers() // within 72 degrees; nothing does from behind
    {
        BakeParams params;
        params.photonCount = 20'000;
        params.octreeDepth = params.octreeFirstDepth = 4;
        const Baked baked = bake(share(cavityCube(0.5f)), params);
        for (const float x : {-0.7f, 0.1f, 0.6f}) {
            for (const auto& [degrees, answers] :
                 {std::pair(0.0f, true), {60.0f, true}, {80.0f, false}, {180.0f, false}}) {
                const float t = glm::radians(degrees);
                glm::vec3 lux(0.0f);
                QCOMPARE(baked.octree->lookup({x, -2.0f, 0.3f}, {std::sin(t), std::cos(t), 0.0f}, lux), answers);
                QCOMPARE(lux.x > 0.0f, answers);
            }
        }
    }

    void groupsAddUp()
    {
        SceneBuilder two("two lamps");
        const Scene room = cavityCube(0.6f);
        Scene both = room;
        PunctualLight second = both.lights[0];
        second.position += glm::vec3(-1.0f, -1.0f, 0.5f);
        second.intensity = {5.0f, 50.0f, 20.0f};
        second.node = "Second";
        both.lights.push_back(second);
        finishScene(both, {});
        const auto scene = share(both);
        BakeParams params;
        params.photonCount = 50'000;
        params.octreeDepth = 5;
        const Baked all = bake(scene, params);
        const glm::vec3 on(1.0f), off(0.0f);
        const Baked a = bake(scene, params, 2, {on, off}), b = bake(scene, params, 2, {off, on});
        QVERIFY(all.octree && a.octree && b.octree);
        QVERIFY(!a.octree->layers()[1] && !b.octree->layers()[0]); // a lamp that is off has no layer
        QCOMPARE(a.counters.photonsShot, std::uint64_t(50'000));
        QCOMPARE(a.counters.groupsOff, std::uint64_t(1));
        for (const OctreeEntry& e : all.octree->geometry().entries) {
            const glm::vec3 sum =
                a.octree->irradiance(e.centroid, e.normal) + b.octree->irradiance(e.centroid, e.normal);
            const glm::vec3 whole = all.octree->irradiance(e.centroid, e.normal);
            for (int c = 0; c < 3; ++c) QVERIFY(std::abs(sum[c] - whole[c]) <= 1e-5f * whole[c]);
        }
        // the mixer: gains are linear, without a new bake
        const auto mixed = all.octree->withMix({{0.5f, 0.5f, 0.5f}, {0.0f, 2.0f, 0.0f}});
        const OctreeEntry& e = all.octree->geometry().entries[7];
        const glm::vec3 ea = a.octree->irradiance(e.centroid, e.normal),
                        eb = b.octree->irradiance(e.centroid, e.normal);
        const glm::vec3 wanted = 0.5f * ea + glm::vec3(0.0f, 2.0f, 0.0f) * eb;
        QVERIFY(glm::length(mixed->irradiance(e.centroid, e.normal) - wanted) <= 1e-5f * glm::length(wanted));
    }

    void doubleLightIsDoubleToTheBit()
    {
        BakeParams params;
        params.photonCount = 20'000;
        params.octreeDepth = 5;
        const Baked once = bake(share(cavityCube(0.5f, 1000.0f)), params);
        const Baked twice = bake(share(cavityCube(0.5f, 2000.0f)), params);
        for (const OctreeEntry& e : once.octree->geometry().entries) {
            const glm::vec3 a = once.octree->irradiance(e.centroid, e.normal),
                            b = twice.octree->irradiance(e.centroid, e.normal);
            QVERIFY(2.0f * a == b);
        }
    }

    void progressiveEndsInTheDirectBake()
    {
        BakeParams params;
        params.photonCount = 50'000;
        const auto scene = share(cornellBox());
        const Baked progressive = bake(scene, params, 2);
        QCOMPARE(progressive.levels, (std::vector<int>{4, 5, 6}));
        params.octreeFirstDepth = 6;
        const Baked direct = bake(scene, params, 5);
        QCOMPARE(direct.levels, (std::vector<int>{6}));
        QVERIFY(sameBits(*progressive.octree, *direct.octree));
        QVERIFY(sameBits(*direct.octree, *bake(scene, params, 1).octree));
    }

    void redBleedsOffTheRedWall()
    {
        BakeParams params;
        params.photonCount = 100'000;
        const Baked baked = bake(share(cornellBox()), params);
        QVERIFY(baked.octree);
        QCOMPARE(baked.counters.causticPhotons, std::uint64_t(0)); // no specular material
        QVERIFY(baked.counters.photonsStored > 50'000);
        // floor half-way back, a twentieth of the width off each side wall; +x is the red side
        const Bounds b = cornellBox().bounds;
        const glm::vec3 up(0.0f, 1.0f, 0.0f), size = b.size();
        const glm::vec3 nearRed = b.low + size * glm::vec3(0.95f, 0.0f, 0.5f),
                        nearGreen = b.low + size * glm::vec3(0.05f, 0.0f, 0.5f);
        const glm::vec3 red = baked.octree->irradiance(nearRed, up), green = baked.octree->irradiance(nearGreen, up);
        QVERIFY2(red.x / red.y > 1.3f * green.x / green.y,
                 qPrintable(QString("R/G %1 at the red wall, %2 at the green one")
                                .arg(double(red.x / red.y))
                                .arg(double(green.x / green.y))));
    }

    void photonMapKnowsTheCubeToo()
    {
        const auto scene = share(cavityCube(0.5f));
        Workers workers(2);
        BakeProducts products;
        std::shared_ptr<const IndirectField> field;
        BakeControl control(workers, {[&](Snapshot s) { field = s.field; }, {}});
        QVERIFY(static_cast<bool>(PhotonMapSolver().bake({scene, BakeParams{}, {}}, products, control)));
        const auto points = samplePoints(*sceneProducts({scene, {}, {}}, products, control)->rays,
                                         *sceneProducts({scene, {}, {}}, products, control)->lights,
                                         *sceneProducts({scene, {}, {}}, products, control)->reach, 1000, 1);
        double sum = 0.0;
        for (const SurfacePoint& p : points) sum += static_cast<double>(field->irradiance(p.position, p.normal).x);
        const double mean = sum / 1000.0, truth = 1000.0 * 0.5 / (96.0 * 0.5);
        QVERIFY2(std::abs(mean / truth - 1.0) <= 0.02, qPrintable(QString("%1 of %2").arg(mean).arg(truth)));
        glm::vec3 lux;
        QVERIFY(!field->lookup(scene->bounds.centre(), {0, 1, 0}, lux)); // mid-air: no answer
    }

    void someLeavesAnswerAsAllOfThem() // what pilots of a bake rely on
    {
        const auto scene = share(twoRooms()); // a wall within reach of both sides' probes
        BakeParams params;
        params.photonCount = 20'000, params.gatherCount = 30;
        params.octreeDepth = params.octreeFirstDepth = 5;
        params.octreeDetail = 0; // pilots leave deeper leaves out
        BakeProducts products;
        const Baked whole = bake(scene, params, 2, {}, &products);
        Workers workers(2);
        BakeControl control(workers, {});
        const Result<PhotonProducts> photons = photonProducts({scene, params, {}}, products, control, 1.0);
        QVERIFY(whole.octree && photons);
        std::vector<ProbePoint> points;
        const SceneProducts& at = photons->scene;
        for (const SurfacePoint& p : samplePoints(*at.rays, *at.lights, *at.reach, 60, 5))
            points.push_back({p.position, p.normal, 0});
        points.push_back({{1e9f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, 0}); // reads nothing

        const auto part = std::make_shared<const OctreeGeometry>(leavesRead(whole.octree->geometry(), points));
        QVERIFY(!part->entries.empty() && part->entries.size() < whole.octree->geometry().entries.size() / 4);
        std::vector<std::shared_ptr<const VdlLayer>> layers(scene->groups.size());
        for (std::size_t g = 0; g < layers.size(); ++g) {
            const auto layer = emptyLayer(*part, static_cast<int>(g), params);
            const LayerFit fit(*part, *photons->maps[g], *photons->area, params, *layer);
            FitScratch scratch;
            for (std::uint32_t e = 0; e < part->entries.size(); ++e) static_cast<void>(fit.fit(e, scratch));
            layers[g] = layer;
        }
        const LightOctree some(part, std::move(layers), params.vdlForm, {});
        for (const ProbePoint& p : points) {
            glm::vec3 a, b;
            QCOMPARE(some.lookup(p.position, p.normal, a), whole.octree->lookup(p.position, p.normal, b));
            QVERIFY(a == b);
        }
    }
};

QTEST_APPLESS_MAIN(OctreeTest)
#include "tst_octree.moc"
