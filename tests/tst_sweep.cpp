// SPDX-License-Identifier: Apache-2.0
// Claim: a sweep bakes every row once, reuses what it can and still tells what each row would cost alone; its figures
// are those of a bake by itself; noise and bias are told apart; it stops at once and keeps what it finished.
#include "core/base/rng.h"
#include "core/base/statistics.h"
#include "core/compare/field_probe.h"
#include "core/compare/pareto.h"
#include "core/compare/sweep.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/sample_scenes.h"
#include "tests/bake_helpers.h"
#include <QtTest>
#include <cmath>
#include <thread>

using namespace lightloom;
using namespace lightloom::test;

namespace {

BakeParams quick()
{
    BakeParams params;
    params.photonCount = 20'000;
    params.gatherCount = 40;
    params.octreeDepth = params.octreeFirstDepth = 4;
    return params;
}

SweepAxis axis(const char* text) { return *parseSweepAxis(text, Method::lightOctree); }

/// Standard normal numbers, by Box and Muller.
double normal(Rng& rng)
{
    const double u = 1.0 - static_cast<double>(rng.uniform()), v = static_cast<double>(rng.uniform());
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::acos(-1.0) * v);
}

/// The Cornell box, a reference at few points, and what sweeps of it need.
struct Fixture {
    std::shared_ptr<const Scene> scene = share(*sampleScene("cornell"));
    Workers workers{2};
    BakeProducts products;
    SweepPlan plan{scene, Method::lightOctree, Isa::automatic, quick(), {}, "test"};
    Judge judge;

    Fixture()
    {
        BakeControl control(workers, {});
        const Result<SceneProducts> at = sceneProducts({scene, {}, {}}, products, control);
        ReferenceJob job;
        job.paths = 128;
        judge = *traceJudge(*at, probeRows(*at, 60, 1), job, ReferenceStore(), workers, {});
    }
    std::vector<SweepRow> sweep(const std::vector<SweepRow>& known = {})
    {
        std::vector<SweepRow> rows;
        BakeControl control(workers, {});
        const Result<Done> done =
            runSweep(plan, judge, known, products, control, [&](SweepRow row) { rows.push_back(std::move(row)); });
        if (!done) qWarning("%s", done.error().message.c_str());
        return rows;
    }
};

} // namespace

class SweepTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void axesAreRead_data()
    {
        QTest::addColumn<QString>("text");
        QTest::addColumn<QList<double>>("values");
        QTest::newRow("list") << "gather.count=50,100,250" << QList<double>{50, 100, 250};
        QTest::newRow("range") << "octree.depth=4..6:1" << QList<double>{4, 5, 6};
        QTest::newRow("range that overshoots") << "octree.depth=4..7:2" << QList<double>{4, 6};
        QTest::newRow("range of fractions") << "grid.shift=0..0.75:0.25" << QList<double>{0, 0.25, 0.5, 0.75};
        QTest::newRow("tenths land on their end")
            << "gather.radius=0..1:0.1" << QList<double>{0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1};
        QTest::newRow("geometric") << "photons=150000..1200000*2" << QList<double>{150000, 300000, 600000, 1200000};
        QTest::newRow("geometric, rounded") << "gather.count=10..40*1.5" << QList<double>{10, 15, 23, 34};
        QTest::newRow("mixed, doubles dropped") << "gather.count=50, 10..50:20, 50" << QList<double>{50, 10, 30};
        QTest::newRow("choices") << "gather.kernel=ellipsoid,sphere" << QList<double>{1, 0};
    }
    void axesAreRead()
    {
        QFETCH(QString, text);
        QFETCH(QList<double>, values);
        const Result<SweepAxis> read = parseSweepAxis(text.toStdString(), Method::lightOctree);
        QVERIFY2(static_cast<bool>(read), read ? "" : read.error().message.c_str());
        QCOMPARE(read->values.size(), static_cast<std::size_t>(values.size()));
        for (std::size_t i = 0; i < read->values.size(); ++i) // floats hold seven digits
            QVERIFY(std::abs(read->values[i] - values[static_cast<qsizetype>(i)]) <= 1e-6);
    }

    void wrongAxesNameWhatIsWrong_data()
    {
        QTest::addColumn<QString>("text");
        QTest::addColumn<QString>("mention");
        QTest::newRow("no values") << "photons"
                                   << "NAME=";
        QTest::newRow("empty") << "photons="
                               << "photons=";
        QTest::newRow("unknown") << "phtons=1,2"
                                 << "phtons";
        QTest::newRow("other method") << "reference.samples=64,128"
                                      << "does nothing for light-octree";
        QTest::newRow("out of range") << "octree.depth=4,99"
                                      << "octree.depth=99";
        QTest::newRow("no number") << "photons=many"
                                   << "photons=many";
        QTest::newRow("no choice") << "gather.kernel=cube"
                                   << "sphere, ellipsoid";
        QTest::newRow("no step") << "photons=1..9"
                                 << "a..b:step";
        QTest::newRow("step of nothing") << "photons=1..9:0"
                                         << "above 0";
        QTest::newRow("factor of one") << "photons=1..9*1"
                                       << "above 1";
        QTest::newRow("from nothing") << "photons=0..9*2"
                                      << "above 0";
        QTest::newRow("backwards") << "photons=9..1:1"
                                   << "before it begins";
        QTest::newRow("endless") << "photons=1..1e9:1"
                                 << "more than 1000";
        QTest::newRow("half a photon") << "photons=1..3:0.5"
                                       << "photons=1.5";
        QTest::newRow("not finite") << "gather.radius=nan"
                                    << "gather.radius=nan";
    }
    void wrongAxesNameWhatIsWrong()
    {
        QFETCH(QString, text);
        QFETCH(QString, mention);
        const Result<SweepAxis> read = parseSweepAxis(text.toStdString(), Method::lightOctree);
        QVERIFY(!read);
        QVERIFY2(QString::fromStdString(read.error().message).contains(mention), read.error().message.c_str());
    }

    void rowsAreAllCombinations()
    {
        const auto rows = sweepRows(quick(), {axis("gather.count=50,100"), axis("photons=1000,2000,3000")});
        QVERIFY(rows && rows->size() == 6);
        QCOMPARE((*rows)[1].gatherCount, 50);
        QCOMPARE((*rows)[1].photonCount, 2000);
        QCOMPARE((*rows)[3].gatherCount, 100);
        QVERIFY(sweepRows(quick(), {})->size() == 1);
        QVERIFY(!sweepRows(quick(), {axis("photons=1,2"), axis("photons=3,4")}));
        QVERIFY(!sweepRows(quick(), {axis("octree.depth=3,4")})); // first depth is 4
        const auto many = sweepRows(quick(), {axis("photons=1..1000:1"), axis("gather.count=1..11:1")});
        QVERIFY(!many && many.error().message.find("10000") != std::string::npos);
        // photons turn slowest whatever the order of the axes, and every row comes once
        const std::vector<std::size_t> order = sweepOrder(*rows);
        QVERIFY((order == std::vector<std::size_t>{0, 3, 1, 4, 2, 5}));
    }

    void paretoFrontByBruteForce()
    {
        Rng rng(3, 0, 0);
        for (int round = 0; round < 50; ++round) {
            std::vector<Trade> trades;
            for (int i = 0; i < 40; ++i) // few values, so that many are equal
                trades.push_back({std::floor(8.0 * static_cast<double>(rng.uniform())),
                                  std::floor(8.0 * static_cast<double>(rng.uniform()))});
            const std::vector<bool> front = paretoFront(trades);
            for (std::size_t i = 0; i < trades.size(); ++i) {
                bool isBeaten = false;
                for (const Trade& t : trades) {
                    const bool noWorse = t.cost <= trades[i].cost && t.error <= trades[i].error;
                    isBeaten = isBeaten || (noWorse && (t.cost < trades[i].cost || t.error < trades[i].error));
                }
                QCOMPARE(front[i], !isBeaten);
            }
        }
        const double nan = std::nan("");
        QVERIFY((paretoFront(std::vector<Trade>{{1, nan}, {nan, 1}, {2, 2}}) == std::vector<bool>{false, false, true}));
        QVERIFY(paretoFront({}).empty());
    }

    void noiseAndBiasAreToldApart()
    {
        // known truth: noise .1, local bias .2 of changing sign, reference noise .15, all of the mean
        constexpr std::size_t n = 40'000;
        Rng rng(11, 0, 0);
        Judge judge;
        judge.reference.resize(n), judge.standardError.assign(n, 0.15);
        judge.mean = 1.0, judge.noise = 0.15;
        std::vector<double> e1(n), e2(n);
        for (std::size_t i = 0; i < n; ++i) {
            const double truth = 1.0, bias = i % 2 ? 0.2 : -0.2;
            judge.reference[i] = truth + 0.15 * normal(rng);
            e1[i] = truth + bias + 0.1 * normal(rng);
            e2[i] = truth + bias + 0.1 * normal(rng);
        }
        const ErrorSplit split = splitError(e1, e2, judge);
        // five standard errors: of the noise .1 / sqrt(2 n), of the bias about (.0425 + .01) / sqrt(n) / (2 * .2)
        QVERIFY2(std::abs(split.noise - 0.1) <= 5 * 0.1 / std::sqrt(2.0 * n), qPrintable(QString::number(split.noise)));
        QVERIFY2(std::abs(split.systematic - 0.2) <= 5 * 0.0525 / std::sqrt(double(n)) / 0.4,
                 qPrintable(QString::number(split.systematic)));
    }

    void squaresKnowTheirOwnErrors() // pulls of many small measurements of a known truth have a spread of one
    {
        constexpr std::size_t n = 100, rounds = 400;
        const double bias = 0.2, noise = 0.1, rough = 0.15;
        Rng rng(12, 0, 0);
        RunningMean ofNoise, ofBias;
        for (std::size_t round = 0; round < rounds; ++round) {
            Judge judge;
            judge.reference.resize(n), judge.standardError.assign(n, rough);
            judge.mean = 1.0, judge.noise = rough;
            std::vector<double> e1(n), e2(n);
            for (std::size_t i = 0; i < n; ++i) {
                judge.reference[i] = 1.0 + rough * normal(rng);
                e1[i] = 1.0 + bias + noise * normal(rng);
                e2[i] = 1.0 + bias + noise * normal(rng);
            }
            const SplitSquares squares = splitSquares(e1, e2, judge);
            ofNoise.add((squares.noise.value - noise * noise) / squares.noise.sigma);
            ofBias.add((squares.systematic.value - bias * bias) / squares.systematic.sigma);
            QVERIFY(std::abs(squares.systematicSpread / squares.systematic.sigma - 1.0) < 0.6);
        }
        for (const RunningMean& pulls : {ofNoise, ofBias}) {
            const double spread = std::sqrt(pulls.variance());
            QVERIFY2(spread > 0.8 && spread < 1.3, qPrintable(QString::number(spread)));
            QVERIFY2(std::abs(pulls.mean()) < 0.3, qPrintable(QString::number(pulls.mean()))); // skewed, but little
        }
    }

    void rowsAreWhatABakeAloneGives()
    {
        Fixture f;
        f.plan.axes = {axis("gather.count=20,40"), axis("photons=10000,20000")};
        const std::vector<SweepRow> rows = f.sweep();
        QCOMPARE(rows.size(), std::size_t{4});
        for (const SweepRow& row : rows) {
            BakeProducts fresh;
            OctreeSolver solver;
            const Baked alone = runSolver(solver, {f.scene, row.params, {}}, fresh);
            BakeControl control(f.workers, {});
            const Result<SceneProducts> at = sceneProducts({f.scene, row.params, {}}, fresh, control);
            const FieldProbe probe(*at->rays, *at->lights, alone.field.get(), row.params);
            const auto light = probe.indirect(f.judge.points, f.workers, {});
            const Result<ErrorMetrics> error = measureError(luminances(*light), f.judge.reference);
            QCOMPARE(row.error.relRmse, error->relRmse);
            QCOMPARE(row.error.perPoint, error->perPoint);
            // every part of a bake alone is paid for, kept or not, and costs about as much
            const double prepare = row.parts[static_cast<std::size_t>(SweepPart::prepare)].cpuSeconds;
            QVERIFY2(prepare > 0.0 && row.cpuSeconds() > prepare, "a part is missing");
            const double ratio = row.cpuSeconds() / allCpuSeconds(alone.counters.stages);
            QVERIFY2(ratio > 0.4 && ratio < 2.5, qPrintable(QString("%1 of a bake alone").arg(ratio)));
            QVERIFY(row.split.noise > 0.0 && row.referenceNoise == f.judge.noise && row.processPeakMiB > 1.0);
        }
        // same photons, other K: what shooting cost is carried along to the bit
        const auto shoot = [](const SweepRow& r) {
            return r.parts[static_cast<std::size_t>(SweepPart::shoot)].cpuSeconds;
        };
        QCOMPARE(rows[0].params.photonCount, rows[1].params.photonCount);
        QVERIFY(rows[0].params.gatherCount != rows[1].params.gatherCount);
        QVERIFY(shoot(rows[0]) > 0.0 && shoot(rows[0]) == shoot(rows[1]));
    }

    void knownRowsAreNotMadeAgain()
    {
        Fixture f;
        f.plan.axes = {axis("gather.count=20,40")};
        const std::vector<SweepRow> first = f.sweep();
        QCOMPARE(first.size(), std::size_t{2});
        f.plan.axes = {axis("gather.count=20,30,40")};
        const std::vector<SweepRow> second = f.sweep(first);
        QCOMPARE(second.size(), std::size_t{1});
        QCOMPARE(second[0].params.gatherCount, 30);
        // any other judge, program, scene or method is another row
        const SweepKeys keys(f.plan, f.judge);
        QCOMPARE(first[0].key, keys.of(first[0].params));
        SweepPlan other = f.plan;
        other.program = "another";
        QVERIFY(SweepKeys(other, f.judge).of(first[0].params) != first[0].key);
        Judge stranger = f.judge;
        stranger.digest[0] = stranger.digest[0] == 'a' ? 'b' : 'a';
        QVERIFY(SweepKeys(f.plan, stranger).of(first[0].params) != first[0].key);
    }

    void progressRisesAndEnds()
    {
        Fixture f;
        f.plan.axes = {axis("gather.count=20,40"), axis("photons=10000,20000")};
        std::vector<double> told;
        std::mutex mutex;
        BakeControl control(f.workers, {{}, [&](const Progress& p) {
                                            std::lock_guard lock(mutex);
                                            told.push_back(p.fraction);
                                        }});
        QVERIFY(static_cast<bool>(runSweep(f.plan, f.judge, {}, f.products, control, [](const SweepRow&) {})));
        QVERIFY(told.size() >= 2 && std::ranges::is_sorted(told) && told.back() == 1.0);
    }

    void cancelKeepsFinishedRowsAndPauseHolds()
    {
        Fixture f;
        f.plan.axes = {axis("photons=10000..40000:10000")};
        std::stop_source stop;
        BakeControl control(f.workers, {}, stop.get_token());
        std::vector<SweepRow> rows;
        control.setPaused(true);
        std::atomic<bool> ended = false;
        Result<Done> outcome = Done{};
        std::jthread sweeping([&] {
            outcome = runSweep(f.plan, f.judge, {}, f.products, control, [&](SweepRow row) {
                rows.push_back(std::move(row));
                if (rows.size() == 2) stop.request_stop();
            });
            ended = true;
        });
        QTest::qSleep(100);
        QVERIFY(!ended);
        control.setPaused(false);
        sweeping.join();
        QVERIFY(!outcome && outcome.error().kind == Error::Kind::cancelled);
        QCOMPARE(rows.size(), std::size_t{2});
        QVERIFY(rows[1].error.relRmse > 0.0);
    }

    void whatCannotBeSweptIsRefused()
    {
        Fixture f;
        BakeControl control(f.workers, {});
        f.plan.method = Method::direct;
        const Result<Done> direct = runSweep(f.plan, f.judge, {}, f.products, control, [](const SweepRow&) {});
        QVERIFY(!direct && direct.error().message.find("direct") != std::string::npos);
        // said before the first row, not after hours: the last row would need more memory than any machine has
        f.plan.method = Method::lightOctree;
        f.plan.axes = {axis("photons=10000,1000000000")};
        int rows = 0;
        const Result<Done> large = runSweep(f.plan, f.judge, {}, f.products, control, [&](const SweepRow&) { ++rows; });
        QVERIFY(!large && large.error().kind == Error::Kind::outOfMemory && rows == 0);
        QVERIFY(large.error().message.find("photons=1000000000") != std::string::npos);
    }
};

QTEST_APPLESS_MAIN(SweepTest)
#include "tst_sweep.moc"
