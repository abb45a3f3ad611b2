// SPDX-License-Identifier: Apache-2.0
// Claims: the models behind budgets recover what made their samples, and foretell far beyond them; picks keep to the
// budget, never get worse when it grows, and none of many others is much better; what is set stays.
#include "core/base/rng.h"
#include "core/compare/budget_pick.h"
#include <QtTest>
#include <cmath>

using namespace lightloom;

namespace {

constexpr double kPilotPhotons = 40'000;

ErrorModel truth()
{
    ErrorModel model;
    model.noise = 1.1, model.overlap = 0.8;
    model.kernelBias = 0.006, model.kernelPower = 0.6;
    model.cellBias = 0.004, model.cellPower = 1.5;
    return model;
}

/// What a pilot would measure if the model were true; `relative` is the standard error of each square.
std::vector<ErrorSample> samplesOf(const ErrorModel& model, double relative, std::uint64_t seed)
{
    Rng rng(seed, 0, 0);
    const auto factor = [&] { return 1.0 + relative * std::sqrt(12.0) * (rng.uniformDouble() - 0.5); };
    std::vector<ErrorSample> samples;
    for (const int depth : {0, 4, 5, 6}) {
        for (const double k : {20.0, 50.0, 120.0, 320.0}) {
            const double noise2 = model.noise2(depth, k, kPilotPhotons), bias2 = model.bias2(depth, k, kPilotPhotons);
            const double sigma = std::max(relative, 1e-3);
            samples.push_back({depth, k, kPilotPhotons, noise2 * factor(), sigma * noise2, bias2 * factor(),
                               sigma * (bias2 + 0.1 * noise2)});
        }
    }
    return samples;
}

BudgetModels models()
{
    BudgetModels m;
    m.error = truth();
    m.costs.fixedSeconds = 0.13, m.costs.groups = 2;
    m.costs.shootPerPhoton = 4e-7, m.costs.storedPerPhoton = 1.5, m.costs.treePerNLogN = 9e-9;
    m.costs.gatherBase = 1.2e-6, m.costs.gatherPerPhoton = 7e-8, m.costs.areaBase = 1e-6, m.costs.areaPerRatio = 6e-4;
    m.costs.depths = {{4, 0.005, 1700}, {5, 0.01, 6800}, {6, 0.02, 26'000}};
    m.mostPhotons = 3e7;
    return m;
}

} // namespace

class BudgetModelsTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void costIsTheSumOfItsStages()
    {
        CostModel costs;
        std::vector<GatherSample> samples;
        for (const double k : {16.0, 120.0, 500.0})
            samples.push_back({k, kPilotPhotons, 1.2e-6 + 7e-8 * k, 2e-6 + 3e-3 * k / kPilotPhotons});
        costs.fitGather(samples);
        QVERIFY(std::abs(costs.gatherBase / 1.2e-6 - 1.0) <= 1e-6 &&
                std::abs(costs.gatherPerPhoton / 7e-8 - 1.0) <= 1e-6);
        QVERIFY(std::abs(costs.areaBase / 2e-6 - 1.0) <= 1e-6 && std::abs(costs.areaPerRatio / 3e-3 - 1.0) <= 1e-6);
        costs.fixedSeconds = 0.5, costs.groups = 3, costs.shootPerPhoton = 1e-6;
        costs.storedPerPhoton = 2, costs.treePerNLogN = 1e-8;
        costs.depths = {{4, 0.1, 1000}, {5, 0.2, 4000}};
        const double stored = 2e5, gather = 4000 * (1.2e-6 + 7e-8 * 100 + 2e-6 + 3e-3 * 100 / 1e5);
        const double wanted = 0.5 + 0.2 + 3 * (1e-6 * 1e5 + 1e-8 * stored * std::log2(stored) + gather);
        QVERIFY2(std::abs(costs.seconds(5, 100, 1e5) / wanted - 1.0) <= 1e-6,
                 qPrintable(QString("%1 of %2").arg(costs.seconds(5, 100, 1e5)).arg(wanted)));
        costs.measuredWith = stored / 8; // photons of larger maps are waited for
        const double more = costs.seconds(5, 100, 1e5) - wanted, photonsShare = 3 * 4000 * 7e-8 * 100;
        QVERIFY2(more > 0.1 * photonsShare && more < 0.4 * photonsShare, qPrintable(QString::number(more)));
        // a line that would begin below nothing goes through nothing
        costs.fitGather(std::vector<GatherSample>{{10, 1000, 1e-6, 0}, {20, 1000, 4e-6, 0}});
        QVERIFY(costs.gatherBase == 0.0 && costs.gatherPerPhoton > 0.0 && costs.areaPerRatio == 0.0);
        // nor is a photon to be had for nothing because noise made the larger gather look quicker
        costs.fitGather(std::vector<GatherSample>{{10, 1000, 4e-6, 0}, {20, 1000, 3e-6, 0}});
        QVERIFY(costs.gatherBase == 0.0 && costs.gatherPerPhoton > 1e-7 && costs.gatherPerPhoton < 4e-7);
    }

    void errorIsRecovered_data()
    {
        QTest::addColumn<double>("relative");
        QTest::addColumn<double>("most");
        QTest::newRow("exact samples") << 0.0 << 0.05;
        QTest::newRow("samples good to a tenth") << 0.1 << 0.15;
    }
    void errorIsRecovered() // at ten and forty times a pilot's photons
    {
        QFETCH(double, relative);
        QFETCH(double, most);
        for (const std::uint64_t seed : {1u, 2u, 3u}) {
            const ErrorModel model = ErrorModel::fit(samplesOf(truth(), relative, seed));
            for (const int depth : {4, 5, 6}) {
                for (const auto& [k, n] : {std::pair(50.0, 4e5), std::pair(200.0, 4e5), std::pair(800.0, 1.6e6)}) {
                    const double off = model.error(depth, k, n) / truth().error(depth, k, n) - 1.0;
                    QVERIFY2(std::abs(off) <= most, qPrintable(QString("d%1 K%2: %3").arg(depth).arg(k).arg(off)));
                }
            }
        }
    }

    void noSamplesGiveUsualValues()
    {
        const ErrorModel model = ErrorModel::fit({}), usual;
        QVERIFY(std::isfinite(model.error(6, 200, 4e5)));
        QVERIFY(std::abs(model.error(6, 200, 4e5) / usual.error(6, 200, 4e5) - 1.0) <= 0.5);
    }

    void moreTimeIsNeverWorse()
    {
        const BudgetModels m = models();
        double last = 1e300;
        QVERIFY(!m.bestFor(0.5 * m.cheapest().cpuSeconds));
        for (double seconds = 1.01 * m.cheapest().cpuSeconds; seconds < 20.0; seconds *= 1.13) {
            const auto pick = m.bestFor(seconds);
            QVERIFY(pick && pick->cpuSeconds <= seconds && pick->error <= last);
            QVERIFY2(seconds < 0.2 || pick->cpuSeconds >= 0.9 * seconds, // time that is there is used
                     qPrintable(QString("%1 of %2 s").arg(pick->cpuSeconds).arg(seconds)));
            last = pick->error;
        }
    }

    void lessErrorIsNeverCheaper()
    {
        const BudgetModels m = models();
        const double floor = m.floor().error;
        double last = 0.0;
        for (double error = 0.5; error > floor; error *= 0.9) {
            const auto pick = m.cheapestFor(error);
            QVERIFY(pick && pick->error <= error && pick->cpuSeconds >= last);
            last = pick->cpuSeconds;
        }
        QVERIFY(m.cheapestFor(floor) && !m.cheapestFor(0.999 * floor));
    }

    void noOtherChoiceIsMuchBetter()
    {
        const BudgetModels m = models();
        Rng rng(5, 0, 0);
        for (int i = 0; i < 300; ++i) {
            const int depth = 4 + static_cast<int>(3.0 * rng.uniformDouble());
            const double n = 3000.0 * std::pow(10.0, 3.5 * rng.uniformDouble());
            const double k = std::min(10.0 * std::pow(10.0, 2.5 * rng.uniformDouble()), 0.02 * n);
            if (k < 10.0) continue;
            const double cost = m.costs.seconds(depth, k, n), error = m.error.error(depth, k, n);
            const auto best = m.bestFor(cost);
            const auto cheapest = m.cheapestFor(error);
            QVERIFY(best && best->error <= 1.03 * error);
            QVERIFY(cheapest && cheapest->cpuSeconds <= 1.06 * cost);
        }
    }

    void whatIsSetStays()
    {
        BudgetModels m = models();
        m.count = 333;
        QCOMPARE(m.bestFor(2.0)->count, 333);
        QVERIFY(m.cheapestFor(0.1)->count == 333);
        m.photons = 77'777;
        QVERIFY(m.bestFor(2.0)->photons == 77'777 && m.bestFor(2.0)->count == 333);
        QCOMPARE(m.floor().photons, 77'777);
        m.count.reset();
        m.costs.depths = {{5, 0.01, 6800}};
        QVERIFY(m.bestFor(2.0)->photons == 77'777 && m.bestFor(2.0)->depth == 5);
        m.costs.depths.clear(); // photon-map: no octree, nothing to gather
        QVERIFY(m.floor().depth == 0 && m.costs.seconds(0, 10, 1e5) == m.costs.seconds(0, 1000, 1e5));
    }

    void memoryBoundsPhotons()
    {
        BudgetModels m = models();
        m.mostPhotons = 1e5;
        QVERIFY(m.floor().photons <= 100'000 && m.bestFor(100.0)->photons <= 100'000);
        m.count = 50'000; // more than a fiftieth of what there is room for
        QVERIFY(!m.bestFor(100.0) && m.floor().count == 0);
    }
};

QTEST_APPLESS_MAIN(BudgetModelsTest)
#include "tst_budget_models.moc"
