// SPDX-License-Identifier: Apache-2.0
// Claim: a bake says what each of its stages cost in CPU time, its own and no one else's, and products that an earlier
// bake left carry their cost along, so that the sum is what the bake would cost alone.
#include "core/scene/sample_scenes.h"
#include "tests/bake_helpers.h"
#include <QtTest>
#include <atomic>
#include <set>
#include <thread>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// Works until this thread has used so much CPU time.
void burn(double seconds)
{
    const double end = threadWorkSeconds() + seconds;
    while (threadWorkSeconds() < end) {
    }
}

const StageCost* stageOf(const WorkCounters& counters, const std::string& name)
{
    for (const StageCost& s : counters.stages) {
        if (s.stage == name) return &s;
    }
    return nullptr;
}

BakeParams quick()
{
    BakeParams params;
    params.photonCount = 30'000;
    params.gatherCount = 50;
    params.octreeDepth = 5;
    return params;
}

} // namespace

class StageCostTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void poolThreadsWorkForTheirCaller_data()
    {
        QTest::addColumn<int>("threads");
        for (const int threads : {1, 2, 4}) QTest::addRow("%d threads", threads) << threads;
    }
    void poolThreadsWorkForTheirCaller()
    {
        QFETCH(int, threads);
        Workers workers(threads);
        std::stop_source stranger; // someone else's work is not ours
        std::jthread other([&] {
            while (!stranger.stop_requested()) burn(0.001);
        });
        const double before = threadWorkSeconds();
        workers.run(8, {}, [](std::size_t) { burn(0.02); });
        const double spent = threadWorkSeconds() - before;
        stranger.request_stop();
        QVERIFY2(spent >= 0.16 && spent <= 0.2, qPrintable(QString("%1 s for 0.16 s of work").arg(spent)));
    }

    void stagesAddUpToTheBake()
    {
        Workers workers(2);
        BakeProducts products;
        OctreeSolver solver;
        const BakeJob job{share(*sampleScene("cornell")), quick(), {}};
        BakeControl control(workers, {});
        const double before = threadWorkSeconds();
        QVERIFY(static_cast<bool>(solver.bake(job, products, control)));
        const double worked = threadWorkSeconds() - before, told = allCpuSeconds(products.counters.stages);
        // Embree's threads are in the stages and not in `worked`; what lies between stages is in none
        QVERIFY2(told >= 0.95 * worked && told <= 1.1 * worked + 0.05,
                 qPrintable(QString("stages %1 s, all %2 s").arg(told).arg(worked)));
        std::set<std::string> names;
        for (const StageCost& s : products.counters.stages) {
            names.insert(s.stage);
            QVERIFY2(s.cpuMs > 0.0 && s.wallMs > 0.0 && !s.isKept, s.stage.c_str());
        }
        const std::set<std::string> wanted{"rays",      "lamps",     "reach",     "area",      "shoot", "tree",
                                           "octree d4", "gather d4", "octree d5", "gather d5", "detail"};
        QVERIFY(names == wanted);
    }

    void keptProductsCarryTheirCost()
    {
        BakeProducts products;
        OctreeSolver solver;
        const auto scene = share(*sampleScene("cornell"));
        const Baked first = runSolver(solver, {scene, quick(), {}}, products);
        BakeParams other = quick();
        other.gatherCount = 60;
        const Baked second = runSolver(solver, {scene, other, {}}, products);
        QCOMPARE(second.counters.photonsShot, std::uint64_t{0});
        QCOMPARE(second.counters.stages.size(), first.counters.stages.size());
        for (const char* kept : {"rays", "lamps", "reach", "area", "shoot", "tree", "octree d4", "octree d5"}) {
            const StageCost *a = stageOf(first.counters, kept), *b = stageOf(second.counters, kept);
            QVERIFY2(a && b && b->isKept && b->cpuMs == a->cpuMs && b->wallMs == a->wallMs, kept);
        }
        for (const char* made : {"gather d4", "gather d5"}) {
            const StageCost* b = stageOf(second.counters, made);
            QVERIFY2(b && !b->isKept, made);
        }
        // the first layers again: everything is there, and costs what it did
        const Baked third = runSolver(solver, {scene, quick(), {}}, products);
        QCOMPARE(allCpuSeconds(third.counters.stages), allCpuSeconds(first.counters.stages));
    }

    void lampsAddUpInOneStage()
    {
        BakeProducts products;
        OctreeSolver solver;
        const auto scene = share(*sampleScene("two_rooms"));
        QVERIFY(scene->groups.size() > 1);
        const Baked baked = runSolver(solver, {scene, quick(), {}}, products);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        QCOMPARE(std::ranges::count(baked.counters.stages, std::string("shoot"), &StageCost::stage), 1);
        QCOMPARE(std::ranges::count(baked.counters.stages, std::string("gather d4"), &StageCost::stage), 1);
    }

    void anInnerControlPausesWithTheOuter()
    {
        Workers workers(2);
        BakeControl outer(workers, {});
        BakeControl inner(outer, {});
        outer.setPaused(true);
        const double at = inner.elapsedMs();
        std::atomic<bool> ran = false;
        std::jthread worker([&] { inner.forBlocks(1, [&](std::size_t) { ran = true; }); });
        QTest::qSleep(60);
        QVERIFY(!ran);
        QCOMPARE(inner.elapsedMs(), at); // time stands still
        outer.setPaused(false);
        worker.join();
        QVERIFY(ran);
    }
};

QTEST_APPLESS_MAIN(StageCostTest)
#include "tst_stage_cost.moc"
