// SPDX-License-Identifier: Apache-2.0
// Claims: pilots measure the same on any number of threads and leave what the bake needs; a budget's bake costs and
// errs about as foretold; what is out of reach is refused with what would be in reach; a stop is seen.
#include "core/bake/solver_for.h"
#include "core/compare/budget.h"
#include "core/compare/field_probe.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "tests/bake_helpers.h"
#include "tests/time_limits.h"
#include <QtTest>
#include <cmath>

using namespace lightloom;
using namespace lightloom::test;

namespace {

BakeJob cornell() { return {share(*sampleScene("cornell")), {}, {}}; }

Result<BudgetPlan> plan(const BakeJob& job, Method method, const BudgetAsked& asked, BakeProducts& products)
{
    Workers workers(2);
    BakeControl control(workers, {});
    return planBudget(job, method, asked, {}, products, control);
}
Result<BudgetPlan> plan(const BakeJob& job, Method method, const BudgetAsked& asked)
{
    BakeProducts products;
    return plan(job, method, asked, products);
}

} // namespace

class BudgetTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void pilotsAreTheSameOnAnyThreads()
    {
        PilotSize size;
        size.probes = 40, size.photons = 8000;
        std::vector<PilotFindings> found;
        for (const int threads : {1, 2, 5}) {
            Workers workers(threads);
            BakeControl control(workers, {});
            BakeProducts products;
            Result<PilotFindings> pilot = runPilot(cornell(), Method::lightOctree, size, {}, products, control);
            QVERIFY2(static_cast<bool>(pilot), pilot ? "" : pilot.error().message.c_str());
            found.push_back(*std::move(pilot));
        }
        QCOMPARE(found[0].errors.size(), std::size_t{5 + 2 * 2});
        for (const PilotFindings& f : found) {
            QCOMPARE(f.judge.digest, found[0].judge.digest);
            QCOMPARE(f.judge.mean, found[0].judge.mean);
            for (std::size_t i = 0; i < f.errors.size(); ++i) {
                QCOMPARE(f.errors[i].noise2, found[0].errors[i].noise2);
                QCOMPARE(f.errors[i].bias2, found[0].errors[i].bias2);
            }
            const CostModel& c = f.costs;
            QVERIFY(c.fixedSeconds > 0.0 && c.shootPerPhoton > 0.0 && c.treePerNLogN > 0.0);
            QVERIFY(c.gatherPerPhoton > 0.0 && c.depths.size() == 2 && c.depths[1].entries > c.depths[0].entries);
            QVERIFY(f.cpuSeconds > 0.0);
        }
    }

    void pilotsLeaveWhatTheBakeNeeds()
    {
        BakeProducts products;
        const Result<BudgetPlan> p = plan(cornell(), Method::lightOctree, {{}, 0.15}, products);
        QVERIFY2(static_cast<bool>(p), p ? "" : p.error().message.c_str());
        BakeJob job = cornell();
        job.params = p->params;
        OctreeSolver solver;
        const Baked baked = runSolver(solver, job, products);
        QVERIFY2(baked.field, baked.error.c_str());
        int paid = 0;
        for (const StageCost& s : baked.counters.stages) {
            const bool isShared =
                s.stage == "rays" || s.stage == "reach" || s.stage == "area" || s.stage.starts_with("octree");
            QCOMPARE(s.isKept, isShared || s.stage == "lamps");
            paid += s.isKept ? 0 : 1;
        }
        QCOMPARE(paid, 3); // shoot, tree, gather of the one depth
    }

    void errorComesOutAsForetold()
    {
        for (const Method method : {Method::lightOctree, Method::photonMap}) {
            BakeProducts products;
            const Result<BudgetPlan> p = plan(cornell(), method, {{}, 0.1}, products);
            QVERIFY2(static_cast<bool>(p), p ? "" : p.error().message.c_str());
            QVERIFY(p->expected.error <= 0.1 && p->expected.error > p->floor.error && p->pilotCpuSeconds > 0.0);
            BakeJob job = cornell();
            job.params = p->params;
            const Baked baked = runSolver(*solverFor(method), job, products);
            Workers workers(2);
            BakeControl control(workers, {});
            const Result<SceneProducts> at = sceneProducts(job, products, control);
            // other points than the pilots', and a better reference: noise 3 % or so
            ReferenceJob reference;
            reference.paths = 1024;
            const Result<Judge> judge = traceJudge(*at, probeRows(*at, 300, 1), reference, {}, workers, {});
            const FieldProbe probe(*at->rays, *at->lights, baked.field.get(), job.params);
            const auto values = luminances(*probe.indirect(judge->points, workers, {}));
            const double error = std::sqrt(splitSquares(values, values, *judge).systematic.value);
            QVERIFY2(error <= 1.5 * 0.1 && error >= 0.1 / 2.0, qPrintable(QString::number(error)));
            const auto outcome = budgetOutcome(*p, *at, *baked.field, control);
            QVERIFY(outcome && std::abs(outcome->error - error) <= 4.0 * outcome->spread + 0.02);
            // clocks of a machine that does other work too: only the order of magnitude
            const double ratio = allCpuSeconds(baked.counters.stages) / p->expected.cpuSeconds;
            QVERIFY2(ratio > 0.4 && ratio < 2.5, qPrintable(QString("%1 of the time expected").arg(ratio)));
        }
    }

    void timeIsKeptAndUsed()
    {
        const Result<BudgetPlan> small = plan(cornell(), Method::lightOctree, {0.8, {}});
        const Result<BudgetPlan> large = plan(cornell(), Method::lightOctree, {6.0, {}});
        QVERIFY(small && large);
        QVERIFY(small->expected.cpuSeconds <= 0.8 && small->expected.cpuSeconds >= 0.6);
        QVERIFY(large->expected.cpuSeconds <= 6.0 && large->expected.cpuSeconds >= 4.8);
        QVERIFY(large->params.photonCount > small->params.photonCount);
        QCOMPARE(small->params.octreeFirstDepth, small->params.octreeDepth);
    }

    void whatIsSetStays()
    {
        BakeJob job = cornell();
        job.params.octreeDepth = 6, job.params.gatherCount = 77, job.params.vdlCount = 2;
        BudgetAsked asked{1.5 * kSanitizerSlowdown, {}};
        asked.isDepthSet = asked.isCountSet = true;
        const Result<BudgetPlan> p = plan(job, Method::lightOctree, asked);
        QVERIFY2(static_cast<bool>(p), p ? "" : p.error().message.c_str());
        QVERIFY(p->params.octreeDepth == 6 && p->params.gatherCount == 77 && p->params.vdlCount == 2);
        QVERIFY(p->params.photonCount != job.params.photonCount);
    }

    void outOfReachIsRefusedWithWhatIs_data()
    {
        QTest::addColumn<double>("seconds");
        QTest::addColumn<double>("error");
        QTest::addColumn<QString>("mention");
        QTest::newRow("below the floor") << 0.0 << 1e-4 << "below the floor of light-octree";
        QTest::newRow("no time") << 1e-3 << 0.0 << "too few";
        QTest::newRow("both") << 0.01 << 0.1 << "more than 0.01";
    }
    void outOfReachIsRefusedWithWhatIs()
    {
        QFETCH(double, seconds);
        QFETCH(double, error);
        QFETCH(QString, mention);
        BudgetAsked asked;
        if (seconds > 0.0) asked.cpuSeconds = seconds;
        if (error > 0.0) asked.error = error;
        const Result<BudgetPlan> p = plan(cornell(), Method::lightOctree, asked);
        QVERIFY(!p && p.error().kind == Error::Kind::badInput);
        const QString message = QString::fromStdString(p.error().message);
        QVERIFY2(message.contains(mention), qPrintable(message));
        if (error < 1e-3 && error > 0.0) { // the floor it names is itself in reach
            const double floor = message.section("about ", 1).section(' ', 0, 0).toDouble() / 100.0;
            QVERIFY2(floor > 1e-4 && floor < 0.08, qPrintable(message));
        }
    }

    void nothingToBudgetForIsSaid()
    {
        const Result<BudgetPlan> direct = plan(cornell(), Method::direct, {1.0, {}});
        QVERIFY(!direct && direct.error().message.find("direct") != std::string::npos);
        BakeJob dark = cornell();
        dark.mix.assign(dark.scene->groups.size(), glm::vec3(0.0f));
        const Result<BudgetPlan> none = plan(dark, Method::lightOctree, {1.0, {}});
        QVERIFY(!none && none.error().message.find("indirect light") != std::string::npos);
    }

    void aStopIsSeen()
    {
        std::stop_source stop;
        stop.request_stop();
        Workers workers(2);
        BakeControl control(workers, {}, stop.get_token());
        BakeProducts products;
        const Result<BudgetPlan> p = planBudget(cornell(), Method::lightOctree, {1.0, {}}, {}, products, control);
        QVERIFY(!p && p.error().kind == Error::Kind::cancelled);
    }
};

QTEST_APPLESS_MAIN(BudgetTest)
#include "tst_budget.moc"
