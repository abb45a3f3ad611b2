// SPDX-License-Identifier: Apache-2.0
// Claims: a grid's light is shown after 2^i photons and its noise falls with each; what is published last is the same
// bits with snapshots or without, with ways kept or traced anew; another size of grid is filled from kept ways; a lamp
// that moves is retraced alone; a bake that is cancelled leaves its picture and its ways; memory is as computed before.
#include "bake_helpers.h"
#include "core/base/memory_use.h"
#include "core/base/units.h"
#include "core/ivg/grid_batches.h"
#include "core/ivg/grid_memory.h"
#include "core/ivg/ivg_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/sample_scenes.h"
#include "grid_helpers.h"
#include "light_helpers.h"
#include <malloc.h>

using namespace lightloom;
using namespace lightloom::test;

namespace {

const IrradianceGrid& gridOf(const std::shared_ptr<const IndirectField>& field)
{
    return dynamic_cast<const IrradianceGrid&>(*field);
}

bool sameLight(const std::shared_ptr<const IndirectField>& a, const std::shared_ptr<const IndirectField>& b)
{
    const auto &x = gridOf(a).layers(), &y = gridOf(b).layers();
    if (x.size() != y.size()) return false;
    for (std::size_t g = 0; g < x.size(); ++g) {
        if (x[g]->vectors != y[g]->vectors || x[g]->variance != y[g]->variance || x[g]->onSurface != y[g]->onSurface)
            return false;
    }
    return true;
}

double noiseAt(const IndirectField& field, std::span<const FacePoint> points)
{
    double sum = 0.0;
    for (const FacePoint& p : points) sum += std::pow(double(field.noise(p.position, p.normal).value_or(0.0f)), 2.0);
    return std::sqrt(sum);
}

} // namespace

class GridProgressTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    // first: what other tests freed would be used again, and of that the most does not tell
    void memoryIsAsComputedBefore_data()
    {
        QTest::addColumn<QString>("scene");
        QTest::addColumn<int>("size");
        QTest::addColumn<int>("paths");
        QTest::newRow("two_rooms 40, ways kept") << "two_rooms" << 40 << 512;
        QTest::newRow("cornell 56, none kept") << "cornell" << 56 << 0;
    }
    void memoryIsAsComputedBefore()
    {
        QFETCH(QString, scene);
        QFETCH(int, size);
        QFETCH(int, paths);
        const auto made = share(*sampleScene(scene.toStdString()));
        BakeParams p = gridParams(size, 1'000'000);
        p.gridPathMemory = paths;
        IvgSolver solver;
        BakeProducts products;
        (void)runSolver(solver, {made, gridParams(2, 100), {}}, products); // what the scene itself takes is there
        malloc_trim(0); // what earlier tests freed would be used again unseen
        if (!resetPeakMemory()) QSKIP("this system does not tell the most memory");
        const double before = double(peakMemoryBytes());
        const Baked baked = runSolver(solver, {made, p, {}}, products);
        const double most = double(peakMemoryBytes()) - before;
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        const double kept = double(baked.field->memoryBytes()) / baked.counters.keptBytes;
        const double found = most / baked.counters.mostBytes;
        qInfo("field %.3f of what was computed, %.1f MiB; most %.3f, %.1f MiB", kept,
              baked.counters.keptBytes / (1 << 20), found, baked.counters.mostBytes / (1 << 20));
        QVERIFY(std::abs(kept - 1.0) <= 0.001);
        QVERIFY2(std::abs(found - 1.0) <= 0.05, qPrintable(QString::number(found)));
    }

    void batchesCoverAllOnce()
    {
        for (const std::uint64_t all : {0u, 1u, 15u, 16u, 17u, 100u, 128u, 1000u, 977u}) {
            std::uint64_t first = 0, previous = 0;
            while (first < all) {
                const std::uint64_t end = gridBatchEnd(first, all);
                QVERIFY(end > first && end <= all && end - first <= kGridBatch);
                QVERIFY(end == all || end - first >= previous);
                previous = end - first, first = end;
            }
            QCOMPARE(first, all);
        }
    }

    void noiseFallsFromSnapshotToSnapshot()
    {
        const auto scene = share(*sampleScene("two_rooms"));
        const BakeParams p = gridParams(12, 64 * 4096 + 1000);
        IvgSolver solver;
        BakeProducts one, other;
        BakeJob job{scene, p, {}};
        const Baked plain = runSolver(solver, job, one);
        QCOMPARE(plain.snapshots.size(), std::size_t(1));
        job.roughFirst = true;
        const Baked shown = runSolver(solver, job, other);
        QCOMPARE(shown.snapshots.size(), std::size_t(4)); // 16, 32, 64 blocks; all
        QVERIFY(sameLight(plain.field, shown.field));
        const auto points = facePoints(*scene, 500, 1);
        double before = 0.0;
        for (std::size_t i = 0; i < shown.snapshots.size(); ++i) {
            const Snapshot& s = shown.snapshots[i];
            const bool isLast = i + 1 == shown.snapshots.size();
            QVERIFY(s.isFinal == isLast && s.isRough == !isLast);
            if (i > 0) QVERIFY(s.level > shown.snapshots[i - 1].level);
            const double noise = noiseAt(*s.field, points);
            if (i > 0 && !isLast) { // twice the photons
                const double ratio = noise / before;
                QVERIFY2(std::abs(ratio - std::sqrt(0.5)) <= 0.05, qPrintable(QString::number(ratio)));
            }
            before = noise;
            // brightness is right from the first
            RunningMean off;
            double mean = 0.0;
            for (const FacePoint& point : points) {
                glm::vec3 lux, all;
                if (!s.field->lookup(point.position, point.normal, lux)) continue;
                if (!shown.field->lookup(point.position, point.normal, all)) continue;
                off.add(double(luminance(lux) - luminance(all)));
                mean += double(luminance(all)) / double(points.size());
            }
            QVERIFY2(std::abs(off.mean()) <= 0.02 * mean, qPrintable(QString::number(off.mean() / mean)));
        }
    }

    void anotherSizeIsFilledFromKeptWays()
    {
        const auto scene = share(*sampleScene("two_rooms"));
        IvgSolver solver;
        BakeProducts products;
        (void)runSolver(solver, {scene, gridParams(10, 200'000), {}}, products);
        const Baked again = runSolver(solver, {scene, gridParams(14, 200'000), {}}, products);
        QCOMPARE(again.counters.photonsShot, std::uint64_t(0));
        QCOMPARE(again.counters.photonsReused, std::uint64_t(400'000)); // of two lamps
        BakeParams none = gridParams(14, 200'000);
        none.gridPathMemory = 0;
        BakeProducts fresh;
        const Baked alone = runSolver(solver, {scene, none, {}}, fresh);
        QCOMPARE(alone.counters.photonsShot, std::uint64_t(400'000));
        QVERIFY(sameLight(again.field, alone.field));
        QVERIFY(again.counters.deposits == alone.counters.deposits);
        const Baked other = runSolver(solver, {scene, gridParams(9, 200'000), {}}, fresh); // nothing was kept
        QCOMPARE(other.counters.photonsShot, std::uint64_t(400'000));
    }

    void waysAreKeptWithinTheirMemory()
    {
        const auto scene = share(*sampleScene("cornell"));
        IvgSolver solver;
        BakeProducts products;
        BakeParams p = gridParams(8, 400'000);
        p.gridPathMemory = 8; // not enough for all
        (void)runSolver(solver, {scene, p, {}}, products);
        p.gridSize = 12;
        const Baked part = runSolver(solver, {scene, p, {}}, products);
        QVERIFY(part.counters.photonsReused > 50'000 && part.counters.photonsShot > 50'000);
        QCOMPARE(part.counters.photonsReused + part.counters.photonsShot, std::uint64_t(400'000));
        p.gridPathMemory = 0;
        BakeProducts fresh;
        QVERIFY(sameLight(part.field, runSolver(solver, {scene, p, {}}, fresh).field));
    }

    void aMovedLampIsRetracedAlone()
    {
        const auto scene = share(*sampleScene("two_rooms"));
        auto moved = std::make_shared<Scene>(*scene);
        moved->lights.at(0).position += glm::vec3(0.1f, 0.0f, 0.05f);
        const BakeParams p = gridParams(10, 100'000);
        IvgSolver solver;
        BakeProducts products, fresh;
        (void)runSolver(solver, {scene, p, {}}, products);
        const Baked edited = runSolver(solver, {moved, p, {}}, products);
        QCOMPARE(edited.counters.photonsShot, std::uint64_t(100'000));
        QCOMPARE(edited.counters.photonsReused, std::uint64_t(100'000));
        QCOMPARE(edited.counters.groupsReused, std::uint64_t(1));
        QVERIFY(sameLight(edited.field, runSolver(solver, {moved, p, {}}, fresh).field));
    }

    void aCancelledBakeLeavesPictureAndWays()
    {
        const auto scene = share(*sampleScene("cornell"));
        const BakeParams p = gridParams(10, 2'000'000);
        Workers workers(2);
        BakeProducts products;
        std::stop_source stop;
        std::vector<Snapshot> shown;
        BakeControl control(workers,
                            {[&](const Snapshot& s) {
                                 shown.push_back(s);
                                 if (shown.size() == 3) stop.request_stop();
                             },
                             {}},
                            stop.get_token());
        BakeJob job{scene, p, {}};
        job.roughFirst = true;
        products.beginRound();
        const Result<Done> done = IvgSolver().bake(job, products, control);
        QVERIFY(!done && done.error().kind == Error::Kind::cancelled);
        QCOMPARE(shown.size(), std::size_t(3));
        QVERIFY(shown.back().field->irradiance({0.0f, 0.0f, 0.0f}, {0, 1, 0}).y > 0.0f || !shown.back().isFinal);
        IvgSolver solver;
        const Baked on = runSolver(solver, {scene, p, {}}, products);
        QVERIFY2(on.counters.photonsReused >= 64 * 4096, qPrintable(QString::number(on.counters.photonsReused)));
        QCOMPARE(on.counters.photonsReused + on.counters.photonsShot, std::uint64_t(2'000'000));
    }
};

QTEST_APPLESS_MAIN(GridProgressTest)
#include "tst_grid_progress.moc"
