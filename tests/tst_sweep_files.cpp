// SPDX-License-Identifier: Apache-2.0
// Claim: a sweep's table reads back to the same bits, forgives a broken last line and nothing else; the plot shows the
// table's numbers where its axes say they are.
#include "core/base/atomic_file.h"
#include "core/base/rng.h"
#include "core/compare/svg_plot.h"
#include "core/compare/sweep_plot.h"
#include "core/compare/sweep_table.h"
#include "core/scene/sample_scenes.h"
#include "tests/svg_reader.h"
#include <QTemporaryDir>
#include <QtTest>
#include <cmath>

using namespace lightloom;
using namespace lightloom::test;

namespace {

std::vector<SweepRow> someRows(std::size_t count)
{
    Rng rng(5, 0, 0);
    const auto any = [&] { return std::ldexp(static_cast<double>(rng.uniform()) + 1e-3, int(rng.bits() % 6) - 3); };
    std::vector<SweepRow> rows(count);
    for (std::size_t i = 0; i < count; ++i) {
        SweepRow& row = rows[i];
        row.params.photonCount = 1000 << (i / 3);
        row.params.gatherCount = 50 + 50 * static_cast<int>(i % 3);
        row.params.gridShift = 0.1f;
        row.params.vdlForm = VdlForm::paper;
        row.threads = 2;
        for (PartCost& part : row.parts) part = {any(), any()};
        row.error = {2000, any(), any(), -any(), any(), any(), any(), any()};
        row.split = {any(), any()};
        row.processPeakMiB = any(), row.fieldMiB = any(), row.referenceNoise = 0.0123;
        row.key = "k" + std::to_string(i);
    }
    return rows;
}

bool isSame(const SweepRow& a, const SweepRow& b)
{
    bool same = a.params == b.params && a.threads == b.threads && a.key == b.key &&
                a.processPeakMiB == b.processPeakMiB && a.fieldMiB == b.fieldMiB &&
                a.referenceNoise == b.referenceNoise && a.split.noise == b.split.noise &&
                a.split.systematic == b.split.systematic && a.error.count == b.error.count;
    for (const auto member : {&ErrorMetrics::meanReference, &ErrorMetrics::relRmse, &ErrorMetrics::bias,
                              &ErrorMetrics::mae, &ErrorMetrics::p95, &ErrorMetrics::max, &ErrorMetrics::perPoint})
        same = same && a.error.*member == b.error.*member;
    for (std::size_t p = 0; p < a.parts.size(); ++p)
        same =
            same && a.parts[p].wallSeconds == b.parts[p].wallSeconds && a.parts[p].cpuSeconds == b.parts[p].cpuSeconds;
    return same;
}

} // namespace

class SweepFilesTest : public QObject {
    Q_OBJECT
    QTemporaryDir folder_;

private Q_SLOTS:
    void tablesSurviveARoundTrip()
    {
        const std::vector<SweepRow> rows = someRows(7);
        for (const auto& wanted : {std::optional<std::size_t>(), std::optional<std::size_t>(9)}) {
            const Result<SweepTable> read =
                parseSweep(sweepText(rows, Method::lightOctree, wanted), Method::lightOctree);
            QVERIFY2(static_cast<bool>(read), read ? "" : read.error().message.c_str());
            QVERIFY(!read->isDamaged);
            QCOMPARE(read->rows.size(), rows.size());
            for (std::size_t i = 0; i < rows.size(); ++i) QVERIFY(isSame(read->rows[i], rows[i]));
        }
    }

    void sumsOfTheTableAreItsColumns()
    {
        const std::vector<SweepRow> rows = someRows(1);
        const auto columns = sweepColumns(Method::lightOctree);
        const QStringList cells =
            QString::fromStdString(sweepText(rows, Method::lightOctree)).split('\n').at(1).split(',');
        double sum = 0;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const QString name = QString::fromStdString(columns[i]);
            if (name.endsWith("_cpu_s")) sum += cells.at(static_cast<qsizetype>(i)).toDouble();
        }
        const auto total = std::ranges::find(columns, "cpu_s") - columns.begin();
        QVERIFY(std::abs(sum - cells.at(total).toDouble()) <= 1e-12 * sum);
    }

    void onlyABrokenLastLineIsForgiven()
    {
        const std::string text = sweepText(someRows(3), Method::lightOctree);
        // cut anywhere inside the last line: two rows are left, never a third with wrong numbers
        const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
        for (std::size_t cut = last + 1; cut < text.size(); cut += 7) {
            const Result<SweepTable> read = parseSweep(text.substr(0, cut), Method::lightOctree);
            QVERIFY2(read && read->isDamaged && read->rows.size() == 2, qPrintable(QString("cut at %1").arg(cut)));
        }
        std::string worse = text;
        worse.replace(text.find("k1"), 2, "k1,");
        const Result<SweepTable> broken = parseSweep(worse, Method::lightOctree);
        QVERIFY(!broken);
        QVERIFY2(broken.error().message.starts_with("line 3: expected"), broken.error().message.c_str());
        QVERIFY(!parseSweep("a,b,c\n", Method::lightOctree));
        QVERIFY(!parseSweep("", Method::lightOctree));
        QVERIFY(!parseSweep(text, Method::photonMap));
    }

    void foreignFilesAreLeftAlone()
    {
        SweepPlan plan;
        plan.scene = std::make_shared<const Scene>(*sampleScene("cornell"));
        Judge judge;
        judge.digest = "d";
        const std::filesystem::path file = folder_.filePath("s.csv").toStdString();
        QVERIFY(resumeSweep(file, plan, judge)->rows.empty());
        std::vector<SweepRow> rows = someRows(2);
        const SweepKeys keys(plan, judge);
        for (SweepRow& row : rows) row.key = keys.of(row.params);
        QVERIFY(static_cast<bool>(writeFile(file, sweepText(rows, Method::lightOctree, 5))));
        const Result<SweepTable> read = resumeSweep(file, plan, judge);
        QVERIFY2(read && read->rows.size() == 2, read ? "" : read.error().message.c_str());
        judge.digest = "e";
        const Result<SweepTable> other = resumeSweep(file, plan, judge);
        QVERIFY(!other && other.error().message.find("another scene, reference or program") != std::string::npos);
        QVERIFY(static_cast<bool>(writeFile(file, "x,y,z\n1,2,3\n")));
        const Result<SweepTable> letter = resumeSweep(file, plan, judge);
        QVERIFY(!letter && letter.error().message.find("name another file") != std::string::npos);
    }

    void rowsComeInThePlansOrder()
    {
        std::vector<SweepRow> rows = someRows(4);
        sortLike(rows, {"k2", "k0"});
        QCOMPARE(rows[0].key, std::string("k2"));
        QCOMPARE(rows[1].key, std::string("k0"));
        QCOMPARE(rows[2].key, std::string("k1"));
    }

    void ticksAreRoundAndHoldTheRange_data()
    {
        QTest::addColumn<double>("low");
        QTest::addColumn<double>("high");
        QTest::addColumn<QStringList>("labels");
        QTest::newRow("narrow") << 0.31 << 0.83 << QStringList{"0.2", "0.5", "1"};
        QTest::newRow("on ticks") << 1.0 << 10.0 << QStringList{"1", "2", "5", "10"};
        QTest::newRow("wide") << 0.02 << 300.0 << QStringList{"0.01", "0.1", "1", "10", "100", "1000"};
    }
    void ticksAreRoundAndHoldTheRange()
    {
        QFETCH(double, low);
        QFETCH(double, high);
        QFETCH(QStringList, labels);
        double from = low, to = high;
        QStringList seen;
        for (const Tick& tick : logTicks(from, to)) {
            if (!tick.label.empty()) seen.append(QString::fromStdString(tick.label));
        }
        QCOMPARE(seen, labels);
        QVERIFY(from <= low && to >= high);
    }

    void plotAndTableAgree()
    {
        const std::vector<SweepRow> rows = someRows(12);
        const SvgPlot plot = readSvg(svgPlot(sweepPlot(rows, Method::lightOctree, "a <room> & \"more\"")));
        QVERIFY2(plot.error.isEmpty(), qPrintable(plot.error));
        QVERIFY(plot.title.startsWith("a <room> & \"more\": light-octree"));
        QCOMPARE(plot.points.size(), rows.size());
        const std::vector<bool> front = sweepFront(rows);
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto point = std::ranges::find(plot.points, rows[i].cpuSeconds(), &SvgPlot::Point::x);
            QVERIFY(point != plot.points.end());
            QCOMPARE(point->y, rows[i].error.relRmse);
            QCOMPARE(point->isMarked, bool(front[i]));
            QVERIFY(point->tip.contains(QString("photons=%1").arg(rows[i].params.photonCount)));
            // where the point is drawn says the same number by the axes' ticks, to a hundredth of a pixel or so
            QVERIFY(std::abs(std::log(plot.xAt(point->place.x()) / rows[i].cpuSeconds())) <= 1e-4);
            QVERIFY(std::abs(std::log(plot.yAt(point->place.y()) / rows[i].error.relRmse)) <= 1e-4);
        }
    }

    void emptyAndOddPlotsAreStillFiles()
    {
        std::vector<SweepRow> odd = someRows(2);
        odd[0].error.relRmse = 0.0;
        for (const auto& rows : {std::vector<SweepRow>(), someRows(1), odd}) {
            const SvgPlot plot = readSvg(svgPlot(sweepPlot(rows, Method::lightOctree, "bad \xff\x01 name")));
            QVERIFY2(plot.error.isEmpty(), qPrintable(plot.error));
            QVERIFY(plot.points.size() <= rows.size());
        }
    }
};

QTEST_APPLESS_MAIN(SweepFilesTest)
#include "tst_sweep_files.moc"
