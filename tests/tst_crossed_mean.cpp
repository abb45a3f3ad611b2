// SPDX-License-Identifier: Apache-2.0
// Claim: a mean whose length is decided by the other chain's spread is unbiased, even for an integrand that is nearly
// always dark and rarely very bright; the plain rule, to stop once one's own spread looks small, is not.
#include "core/base/crossed_mean.h"
#include "core/base/rng.h"
#include "tests/light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// Two values, mean 1: 1/p with chance p, else 0.
double twoValued(Rng& rng, double p) { return rng.uniformDouble() < p ? 1.0 / p : 0.0; }

struct Stopped {
    RunningMean estimate, claimedVariance, length;
};

Stopped crossed(double p, double goal, int repeats)
{
    Stopped s;
    for (int i = 0; i < repeats; ++i) {
        Rng rng(1, 2, std::uint64_t(i));
        CrossedMean<1> mean;
        while (!mean.isEnded() && mean.batches() < 1 << 16) {
            mean.add({twoValued(rng, p)});
            mean.look([goal](const auto& errors) { return errors[0] <= goal; });
        }
        s.estimate.add(mean.mean(0));
        s.claimedVariance.add(mean.standardError(0) * mean.standardError(0));
        s.length.add(double(mean.batches()));
    }
    return s;
}

/// The plain rule, with the same least number of batches.
Stopped plain(double p, double goal, int repeats)
{
    Stopped s;
    for (int i = 0; i < repeats; ++i) {
        Rng rng(1, 3, std::uint64_t(i));
        RunningMean mean;
        while (mean.count() < 16 || !(mean.standardError() <= goal)) mean.add(twoValued(rng, p));
        s.estimate.add(mean.mean());
        s.length.add(double(mean.count()));
    }
    return s;
}

} // namespace

class CrossedMeanTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void stoppedEstimatesAreUnbiased_data()
    {
        QTest::addColumn<double>("p");
        QTest::addColumn<double>("goal");
        QTest::addRow("even") << 0.5 << 0.1;
        QTest::addRow("one in ten") << 0.1 << 0.3;
        QTest::addRow("one in fifty") << 0.02 << 0.5;
        QTest::addRow("rarer than the first look sees") << 0.005 << 1.0;
    }
    void stoppedEstimatesAreUnbiased()
    {
        QFETCH(double, p);
        QFETCH(double, goal);
        const Stopped s = crossed(p, goal, 40'000);
        VERIFY_MEAN(s.estimate, 1.0, sidakLimit(4), "mean of stopped estimates");
        QVERIFY2(s.estimate.standardError() <= 0.02, qPrintable(QString::number(s.estimate.standardError())));
        // what they claim of themselves is what they scatter; the two chains are a little alike in when they end, which
        // the claim leaves out: a tenth, for the worst of these
        const double claimed = std::sqrt(s.claimedVariance.mean()), found = std::sqrt(s.estimate.variance());
        QVERIFY2(claimed >= 0.89 * found && claimed <= 1.05 * found,
                 qPrintable(QString("%1 and %2").arg(claimed).arg(found)));
    }

    void thePlainRuleIsBiased() // so the test above can fail
    {
        const Stopped s = plain(0.02, 0.5, 40'000);
        QVERIFY2(s.estimate.mean() <= 1.0 - 20.0 * s.estimate.standardError(),
                 qPrintable(QString("%1 +- %2").arg(s.estimate.mean()).arg(s.estimate.standardError())));
    }

    void theLengthFollowsTheGoal() // four times as long for half the error; errors lie at the goal on average
    {
        const Stopped coarse = crossed(0.5, 0.1, 4000), fine = crossed(0.5, 0.05, 4000);
        QVERIFY2(std::abs(fine.length.mean() / coarse.length.mean() - 4.0) <= 1.0, // looks are a quarter apart
                 qPrintable(QString("%1 to %2").arg(fine.length.mean()).arg(coarse.length.mean())));
        for (const auto& [s, goal] : {std::pair(&coarse, 0.1), std::pair(&fine, 0.05)}) {
            const double rms = std::sqrt(s->claimedVariance.mean());
            QVERIFY2(rms <= 1.05 * goal && rms >= 0.8 * goal, qPrintable(QString("%1 for %2").arg(rms).arg(goal)));
        }
    }

    void withoutLooksEveryBatchCounts() // the plain mean and its error, also of an odd number
    {
        Rng rng(4, 5, 6);
        CrossedMean<1> mean;
        RunningMean straight;
        for (int i = 0; i < 1001; ++i) {
            const double x = rng.uniformDouble();
            mean.add({x});
            straight.add(x);
        }
        QVERIFY(std::abs(mean.mean(0) - straight.mean()) <= 1e-14);
        QVERIFY(std::abs(mean.standardError(0) / straight.standardError() - 1.0) <= 1e-12);
        QCOMPARE(mean.batches(), std::uint64_t(1001));
        QVERIFY(!mean.isEnded());
    }

    void aConstantEndsAtTheFirstLook()
    {
        CrossedMean<2> mean;
        for (int i = 0; i < 16; ++i) {
            QVERIFY(!mean.isEnded());
            mean.add({3.0, 0.0});
            mean.look([](const auto& errors) { return errors[0] <= 0.0 && errors[1] <= 0.0; });
        }
        QVERIFY(mean.isEnded() && mean.mean(0) == 3.0 && mean.mean(1) == 0.0 && mean.standardError(0) == 0.0);
    }
};

QTEST_APPLESS_MAIN(CrossedMeanTest)
#include "tst_crossed_mean.moc"
