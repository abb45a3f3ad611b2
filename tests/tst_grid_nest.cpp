// SPDX-License-Identifier: Apache-2.0
// Claims: a finer grid inside answers within its box and fades into the outer one without an edge; a furnace stays even
// across it; it lies where light bends most and takes no more vertices than the outer grid; it brings light nearer to a
// reference there; it comes back from files; settled sizes and photon counts follow walls and wanted noise.
#include "bake_helpers.h"
#include "core/bake/bake_file.h"
#include "core/base/units.h"
#include "core/ivg/grid_advice.h"
#include "core/ivg/grid_nest.h"
#include "core/ivg/ivg_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/trace/reference.h"
#include "grid_helpers.h"
#include "light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

BakeParams params(int size, int photons, GridNest nest = GridNest::automatic)
{
    BakeParams p = gridParams(size, photons);
    p.gridNest = nest;
    return p;
}

Baked bakeGrid(const std::shared_ptr<const Scene>& scene, const BakeParams& p, int threads = 2)
{
    IvgSolver solver;
    BakeProducts products;
    return runSolver(solver, {scene, p, {}}, products, threads);
}

const IrradianceGrid& gridOf(const Baked& baked) { return dynamic_cast<const IrradianceGrid&>(*baked.field); }

/// A grid that knows the same light from everywhere.
std::shared_ptr<const IrradianceGrid> constantGrid(const GridLattice& lattice, float lux)
{
    auto layer = std::make_shared<GridLayer>();
    layer->vectors.resize(lattice.vertexCount(), IrradianceVectors{});
    layer->variance.resize(lattice.vertexCount(), {});
    for (IrradianceVectors& vectors : layer->vectors) {
        for (std::size_t d = 0; d < 6; ++d) {
            glm::vec3 along(0.0f);
            along[int(d / 2)] = d % 2 == 0 ? -lux : lux;
            vectors[d] = glm::mat3(along, along, along);
        }
    }
    const auto geometry =
        std::make_shared<const GridGeometry>(GridGeometry{lattice, GridOpenness::everything(lattice)});
    return std::make_shared<const IrradianceGrid>(geometry, std::vector<std::shared_ptr<const GridLayer>>{layer},
                                                  GridEstimator::crossings, Mix{},
                                                  GridShow{GridRemap::flux, GridFilter::trilinear, 0.5f});
}

} // namespace

class GridNestTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void fadesWithoutAnEdge() // from 1 lx outside to 2 lx inside, no step along any line
    {
        const GridLattice coarse{{-2, -2, -2}, {0.5f, 0.5f, 0.5f}, {8, 8, 8}};
        const GridLattice fine{{-1.25f, -1.25f, -1.25f}, {0.25f, 0.25f, 0.25f}, {10, 10, 10}};
        const Bounds box{glm::vec3(-1), glm::vec3(1)}, scene{glm::vec3(-2), glm::vec3(2)};
        const auto nested =
            constantGrid(coarse, 1.0f)->withInside(joinNest(constantGrid(fine, 2.0f), scene, coarse, box));
        float before = 1.0f, least = 9.0f, most = 0.0f;
        for (int i = 0; i <= 3000; ++i) {
            const float t = float(i) / 3000.0f;
            const glm::vec3 p = glm::mix(glm::vec3(-1.6f, -0.3f, 0.2f), glm::vec3(1.6f, 0.4f, -0.1f), t);
            glm::vec3 lux;
            QVERIFY(nested->lookup(p, {0, 1, 0}, lux));
            if (i > 0) QVERIFY(std::abs(lux.x - before) <= 0.01f);
            before = lux.x, least = std::min(least, lux.x), most = std::max(most, lux.x);
        }
        QVERIFY(std::abs(least - 1.0f) <= 1e-5f && std::abs(most - 2.0f) <= 1e-5f);
        glm::vec3 lux;
        QVERIFY(nested->lookup({0, 0, 0}, {1, 0, 0}, lux) && std::abs(lux.x - 2.0f) <= 1e-5f);
        QVERIFY(nested->lookup({1.01f, 0, 0}, {1, 0, 0}, lux) && std::abs(lux.x - 1.0f) <= 1e-5f);
        const auto dimmed = nested->withMix({glm::vec3(0.5f)});
        QVERIFY(dimmed->lookup({0, 0, 0}, {1, 0, 0}, lux) && std::abs(lux.x - 1.0f) <= 1e-5f);
    }

    void furnaceStaysEvenAcrossTheSeam()
    {
        const auto scene = share(furnaceBox(0.5f, 1.0f, {2.0f, 1.7f, 2.3f}));
        BakeParams p = params(4, 4'000'000, GridNest::box);
        p.gridNestLowX = p.gridNestLowY = p.gridNestLowZ = -3.0f; // a corner: three faces at the walls, three within
        p.gridNestHighX = p.gridNestHighY = p.gridNestHighZ = 0.4f;
        const Baked baked = bakeGrid(scene, p);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        QVERIFY(gridOf(baked).inside().grid != nullptr);
        Rng rng(1, hashName("normals"), 0);
        double worst = 0.0;
        int inside = 0;
        for (const FacePoint& point : facePoints(*scene, 3000, 1)) {
            const auto [u1, u2] = rng.uniformPair();
            const glm::vec3 n = Frame(point.normal).toWorld(sampleCone(u1, u2, 0.17f));
            glm::vec3 lux;
            if (!baked.field->lookup(point.position, n, lux)) continue; // tilted into a corner (tst_grid_field)
            inside += gridOf(baked).inside().weight(point.position) > 0.0f ? 1 : 0;
            worst = std::max(worst, std::abs(double(lux.x) - 1.0));
        }
        qInfo("worst off by %.4f, %d inside", worst, inside);
        QVERIFY2(worst <= 0.03 && inside > 300, qPrintable(QString::number(worst)));
    }

    void liesWhereLightBendsMost_data()
    {
        QTest::addColumn<int>("fit");
        QTest::addColumn<double>("most"); // RMS off, of the mean light; a plain grid has .171 and .149
        QTest::newRow("of the air alone") << 0 << 0.157;
        QTest::newRow("fitted to surface, which leaves less to gain") << 1 << 0.143;
    }
    void liesWhereLightBendsMost() // and brings it nearer to the reference there
    {
        QFETCH(int, fit);
        QFETCH(double, most);
        const auto scene = share(*sampleScene("atrium"));
        BakeParams p = params(32, 600'000), without = params(32, 600'000, GridNest::off);
        p.gridFit = without.gridFit = Switch(fit);
        const Baked nested = bakeGrid(scene, p), plain = bakeGrid(scene, without);
        QVERIFY2(nested.error.empty(), nested.error.c_str());
        const GridInside& inside = gridOf(nested).inside();
        QVERIFY(inside.grid != nullptr);
        QVERIFY(inside.grid->geometry().lattice.vertexCount() <= gridOf(plain).geometry().lattice.vertexCount());
        const glm::vec3 planter(10.0f, 0.5f, 6.0f); // in the sun that falls through the roof
        QVERIFY2(inside.weight(planter - glm::vec3(scene->origin)) > 0.0f, "the box misses the sunlit planter");

        Workers workers(2);
        BakeProducts products;
        BakeControl control(workers, {});
        const auto at = sceneProducts({scene, p, {}}, products, control);
        QVERIFY(at);
        std::vector<ProbePoint> probes;
        for (const SurfacePoint& s : samplePoints(*at->rays, *at->lights, *at->reach, 2000, 1)) {
            if (inside.weight(s.position) > 0.3f) probes.push_back({s.position, s.normal, probes.size()});
        }
        ReferenceJob job;
        job.paths = 256;
        const auto reference = referenceIlluminance(*at->rays, *at->lights, {}, probes, job, workers, {});
        double offNested = 0.0, offPlain = 0.0, all = 0.0;
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const double truth = double(luminance(reference.probes[i].indirect));
            const auto off = [&](const Baked& baked) {
                const glm::vec3 lux = baked.field->irradiance(probes[i].position, probes[i].normal);
                return std::pow(double(luminance(lux)) - truth, 2.0);
            };
            offNested += off(nested), offPlain += off(plain), all += truth;
        }
        const double mean = all / double(probes.size()), count = double(probes.size());
        qInfo("%zu points, rms %.4f of their light, plain %.4f, %.3f of that", probes.size(),
              std::sqrt(offNested / count) / mean, std::sqrt(offPlain / count) / mean, std::sqrt(offNested / offPlain));
        QVERIFY(probes.size() > 40 && offNested < 0.95 * offPlain);
        QVERIFY(std::sqrt(offNested / count) <= most * mean);
    }

    void outerLayersAreNotMadeAgain() // and another box is filled from kept ways
    {
        const auto scene = share(*sampleScene("cornell"));
        IvgSolver solver;
        BakeProducts products;
        const Baked plain = runSolver(solver, {scene, params(10, 100'000, GridNest::off), {}}, products);
        const Baked nested = runSolver(solver, {scene, params(10, 100'000), {}}, products);
        QCOMPARE(nested.counters.photonsShot, std::uint64_t(0));
        QVERIFY(gridOf(nested).layers()[0] == gridOf(plain).layers()[0]);
        const Baked alone = bakeGrid(scene, params(10, 100'000), 5);
        QVERIFY(gridOf(alone).inside().grid->layers()[0]->vectors ==
                gridOf(nested).inside().grid->layers()[0]->vectors);
    }

    void filesGiveItBack()
    {
        const auto scene = share(*sampleScene("two_rooms"));
        const BakeParams p = params(8, 50'000);
        const Baked baked = bakeGrid(scene, p);
        BakeInfo info;
        info.method = Method::irradianceGrid;
        info.params = p;
        info.sceneHash = sceneHash(*scene);
        for (const LightGroup& group : scene->groups) info.groups.push_back(group.id);
        const auto bytes = bakeBytes(*baked.field, info, *scene);
        QVERIFY2(static_cast<bool>(bytes), bytes ? "" : bytes.error().message.c_str());
        const Result<BakeFile> file = bakeFromBytes(*bytes, *scene);
        QVERIFY2(static_cast<bool>(file) && file->grid, file ? "" : file.error().message.c_str());
        QVERIFY(file->grid->inside().grid != nullptr);
        int within = 0;
        for (const FacePoint& point : facePoints(*scene, 500, 2)) {
            glm::vec3 x, y;
            QCOMPARE(baked.field->lookup(point.position, point.normal, x),
                     file->grid->lookup(point.position, point.normal, y));
            QVERIFY(x == y);
            within += gridOf(baked).inside().weight(point.position) > 0.0f ? 1 : 0;
        }
        QVERIFY(within > 20);
    }

    void boxesThatAreNone()
    {
        BakeParams p = params(8, 1000, GridNest::box);
        QVERIFY(!bakeGrid(share(cavityCube(0.5f)), p).error.empty()); // low is not below high
        p.gridNestLowX = p.gridNestLowY = p.gridNestLowZ = 100.0f;    // outside the scene: no finer grid
        p.gridNestHighX = p.gridNestHighY = p.gridNestHighZ = 101.0f;
        const Baked baked = bakeGrid(share(cavityCube(0.5f)), p);
        QVERIFY2(baked.error.empty() && !gridOf(baked).inside().grid, baked.error.c_str());
        const Baked dark = bakeGrid(share(cavityCube(0.5f)), params(8, 0)); // nothing bends
        QVERIFY2(dark.error.empty() && !gridOf(dark).inside().grid, dark.error.c_str());
    }

    void sizesFollowWalls()
    {
        const auto adviceOf = [](const char* name) {
            const auto scene = share(*sampleScene(name));
            Workers workers(2);
            BakeProducts products;
            BakeControl control(workers, {});
            const auto at = sceneProducts({scene, {}, {}}, products, control);
            if (!at) qFatal("no scene");
            return adviseGridSize(*at, {}, 0.0f);
        };
        for (const char* name : {"cornell", "two_rooms", "atrium", "gallery"}) {
            const GridAdvice advice = adviceOf(name);
            qInfo("%s: %d cells, walls %.2f m apart%s", name, advice.size, double(advice.wallSpacing),
                  advice.isCut ? ", cut" : "");
            QVERIFY(advice.size >= 16 && advice.size <= 128 && advice.size % 4 == 0);
        }
        BakeParams p = params(0, 20'000, GridNest::off);
        const Baked baked = bakeGrid(share(*sampleScene("cornell")), p);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        const glm::ivec3 cells = gridOf(baked).geometry().lattice.cells;
        const GridAdvice advice = adviceOf("cornell");
        QCOMPARE(std::max({cells.x, cells.y, cells.z}), advice.size);
    }

    void photonsBringTheWantedNoise()
    {
        const auto scene = share(*sampleScene("cornell"));
        BakeParams p = params(16, 1000, GridNest::off);
        p.gridNoise = 0.015f;
        const Baked baked = bakeGrid(scene, p);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        QVERIFY(baked.counters.photonsShot > 131072 && baked.counters.photonsPerGroup == baked.counters.photonsShot);
        double square = 0.0, mean = 0.0;
        const auto points = facePoints(*scene, 1000, 5);
        for (const FacePoint& f : points) {
            square += std::pow(double(baked.field->noise(f.position, f.normal).value_or(0.0f)), 2.0);
            mean += double(luminance(baked.field->irradiance(f.position, f.normal)));
        }
        const double noise = std::sqrt(square / double(points.size())) / (mean / double(points.size()));
        qInfo("noise %.4f from %llu photons", noise, static_cast<unsigned long long>(baked.counters.photonsShot));
        QVERIFY2(std::abs(noise - 0.015) <= 0.0015, qPrintable(QString::number(noise)));
    }
};

QTEST_APPLESS_MAIN(GridNestTest)
#include "tst_grid_nest.moc"
