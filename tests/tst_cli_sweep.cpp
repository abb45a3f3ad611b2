// SPDX-License-Identifier: Apache-2.0
// Claim: `lightloom-cli sweep` fills its table row by row, goes on where it was stopped, draws what the table holds,
// and its figures are those that probe and compare give in three steps.
#include "tests/cli_helpers.h"
#include "tests/svg_reader.h"
#include <QTemporaryDir>
#include <QtTest>
#include <nlohmann/json.hpp>

using namespace lightloom::test;

namespace {

/// A table as text: column name to cell, row by row.
std::vector<std::map<QString, QString>> tableOf(const QByteArray& csv)
{
    const QStringList lines = QString::fromUtf8(csv).split('\n', Qt::SkipEmptyParts);
    std::vector<std::map<QString, QString>> rows;
    if (lines.isEmpty()) return rows;
    const QStringList names = lines.at(0).split(',');
    for (qsizetype i = 1; i < lines.size(); ++i) {
        if (lines.at(i).startsWith('#')) continue;
        const QStringList cells = lines.at(i).split(',');
        rows.emplace_back();
        for (qsizetype c = 0; c < names.size(); ++c) rows.back()[names.at(c)] = cells.value(c);
    }
    return rows;
}

} // namespace

class CliSweepTest : public QObject {
    Q_OBJECT
    QTemporaryDir folder_;
    QString at(const QString& name) const { return folder_.filePath(name); }
    QString scene() const { return at("figure.glb"); }

    QStringList words(const QString& output) const
    {
        return {"sweep",       scene(),     "--method", "light-octree",       "--set",  "octree.depth=4",
                "--reference", at("r.csv"), "--vary",   "gather.count=20,40", "--vary", "photons=5000,10000,20000",
                "-o",          output};
    }

private Q_SLOTS:
    void initTestCase()
    {
        QCOMPARE(run({"make-scene", "figure", "--triangles", "2000", "-o", scene()}).code, 0);
        QCOMPARE(run({"points", scene(), "--count", "40", "-o", at("p.csv")}).code, 0);
        const QStringList reference{"--method", "reference", "--set", "reference.samples=128"};
        QCOMPARE(run(QStringList{"probe", scene(), "--points", at("p.csv"), "-o", at("r.csv")} + reference).code, 0);
    }

    void tableAndPlotAgree()
    {
        const Ran ran = run(words(at("a.csv")) + QStringList{"--plot", at("a.svg"), "--json"});
        QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        const auto json = nlohmann::json::parse(ran.out.toStdString());
        QVERIFY(json["rows"] == 6 && json["baked"] == 6 && json["kept"] == 0);
        const auto rows = tableOf(contents(at("a.csv")));
        const SvgPlot plot = readSvg(contents(at("a.svg")).toStdString());
        QVERIFY2(plot.error.isEmpty(), qPrintable(plot.error));
        QCOMPARE(rows.size(), std::size_t{6});
        QCOMPARE(plot.points.size(), rows.size());
        std::size_t marked = 0;
        for (const auto& row : rows) {
            const double cpu = row.at("cpu_s").toDouble(), error = row.at("relrmse").toDouble();
            const auto point = std::ranges::find(plot.points, cpu, &SvgPlot::Point::x);
            QVERIFY2(point != plot.points.end() && point->y == error, qPrintable(row.at("cpu_s")));
            QVERIFY(std::abs(std::log(plot.xAt(point->place.x()) / cpu)) <= 1e-4);
            QVERIFY(std::abs(std::log(plot.yAt(point->place.y()) / error)) <= 1e-4);
            marked += point->isMarked;
        }
        QCOMPARE(json["front"].size(), marked);
        QVERIFY(marked >= 1);
    }

    void figuresAreThoseOfProbeAndCompare()
    {
        const auto rows = tableOf(contents(at("a.csv")));
        const auto row = std::ranges::find_if(
            rows, [](const auto& r) { return r.at("gather.count") == "40" && r.at("photons") == "10000"; });
        QVERIFY(row != rows.end());
        const Ran probe =
            run({"probe", scene(), "--method", "light-octree", "--set", "octree.depth=4", "--set", "gather.count=40",
                 "--set", "photons=10000", "--points", at("p.csv"), "-o", at("o.csv")});
        QVERIFY2(probe.code == 0, qPrintable(probe.text()));
        const Ran compare = run({"compare", at("o.csv"), at("r.csv"), "--json"});
        const auto json = nlohmann::json::parse(compare.out.toStdString());
        for (const char* figure : {"relrmse", "bias", "mae", "p95", "max", "perpoint"}) {
            const double a = row->at(figure).toDouble(), b = json[figure].get<double>();
            QVERIFY2(std::abs(a - b) <= 1e-6 * std::abs(b), figure);
        }
    }

    void aSecondRunMakesNothingAgain()
    {
        const QByteArray before = contents(at("a.csv"));
        const Ran again = run(words(at("a.csv")) + QStringList{"--json"});
        QVERIFY2(again.code == 0, qPrintable(again.text()));
        QCOMPARE(nlohmann::json::parse(again.out.toStdString())["baked"].get<int>(), 0);
        QCOMPARE(contents(at("a.csv")), before);
        // broken off inside the last line: that row alone is made again, the others keep their times
        QVERIFY(write(at("a.csv"), before.left(before.size() - 9)));
        const Ran mended = run(words(at("a.csv")) + QStringList{"--json"});
        QVERIFY2(mended.code == 0 && mended.err.contains("broken off"), qPrintable(mended.text()));
        QCOMPARE(nlohmann::json::parse(mended.out.toStdString())["baked"].get<int>(), 1);
        const QByteArray after = contents(at("a.csv"));
        const auto shared = before.lastIndexOf('\n', before.size() - 2) + 1;
        QCOMPARE(after.left(shared), before.left(shared));
    }

    void interruptedGoesOn()
    {
        QStringList many = words(at("i.csv"));
        many.replaceInStrings("photons=5000,10000,20000", "photons=5000..200000*1.5");
        QProcess process;
        process.start(LIGHTLOOM_CLI, many);
        QElapsedTimer waiting;
        waiting.start();
        while (!contents(at("i.csv")).contains("# incomplete") && waiting.elapsed() < 60'000) QTest::qSleep(5);
        ::kill(static_cast<pid_t>(process.processId()), SIGINT);
        QVERIFY(process.waitForFinished(20'000));
        QCOMPARE(process.exitCode(), 130);
        QVERIFY(process.readAllStandardError().contains("the same command goes on"));
        const auto first = tableOf(contents(at("i.csv")));
        QVERIFY(!first.empty() && contents(at("i.csv")).contains("# incomplete: 20 rows wanted"));
        const Ran rest = run(many + QStringList{"--json"});
        QVERIFY2(rest.code == 0, qPrintable(rest.text()));
        const auto json = nlohmann::json::parse(rest.out.toStdString());
        QCOMPARE(json["kept"].get<std::size_t>(), first.size());
        const auto all = tableOf(contents(at("i.csv")));
        QVERIFY(all.size() == 20 && !contents(at("i.csv")).contains("# incomplete"));
        for (const auto& row : first)
            QVERIFY(std::ranges::find(all, row) != all.end()); // kept as they were, times and all
    }

    void referencesAreTracedAndKept()
    {
        const QStringList automatic{"sweep",       scene(),
                                    "--method",    "photon-map",
                                    "--set",       "photons=5000",
                                    "--reference", "auto",
                                    "--probes",    "50",
                                    "--set",       "reference.samples=128",
                                    "--vary",      "gather.count=20,40",
                                    "-o",          at("t.csv")};
        const Ran ran = run(automatic);
        QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        QVERIFY(ran.out.contains("noise of the reference") && ran.err.contains("50 points"));
        QVERIFY(QFileInfo::exists(scene() + ".lightloom-cache"));
        QCOMPARE(tableOf(contents(at("t.csv"))).size(), std::size_t{2});
    }

    void wrongWordsAreUsage_data()
    {
        QTest::addColumn<QStringList>("change");
        QTest::addColumn<int>("code");
        QTest::addColumn<QString>("mention");
        QTest::newRow("method") << QStringList{"--method", "direct"} << 2 << "nothing to sweep";
        QTest::newRow("axis") << QStringList{"--vary", "photons=9..1:1"} << 2 << "before it begins";
        QTest::newRow("twice") << QStringList{"--vary", "gather.count=7"} << 2 << "varied twice";
        QTest::newRow("clash") << QStringList{"--vary", "octree.first-depth=5"} << 2 << "octree.first-depth=5";
        QTest::newRow("no reference") << QStringList{"--reference", at("none.csv")} << 3 << "none.csv";
        QTest::newRow("reference without points") << QStringList{"--reference", at("bare.csv")} << 3 << "x,y,z";
        QTest::newRow("foreign output") << QStringList{"-o", at("p.csv")} << 3 << "name another file";
        QTest::newRow("no folder") << QStringList{"-o", at("none/x.csv")} << 1 << "no folder";
        QTest::newRow("no folder for the plot") << QStringList{"--plot", at("none/x.svg")} << 1 << "no folder";
    }
    void wrongWordsAreUsage()
    {
        QFETCH(QStringList, change);
        QFETCH(int, code);
        QFETCH(QString, mention);
        QVERIFY(write(at("bare.csv"), "direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b\n1,1,1,1,1,1\n"));
        QStringList line = words(at("w.csv"));
        for (qsizetype i = 0; i + 1 < change.size(); i += 2) { // options that may come once are replaced
            const qsizetype place = line.indexOf(change.at(i));
            if (place >= 0 && change.at(i) != "--vary" && change.at(i) != "--set")
                line[place + 1] = change.at(i + 1);
            else
                line += {change.at(i), change.at(i + 1)};
        }
        const Ran ran = run(line);
        QVERIFY2(ran.code == code && ran.err.contains(mention), qPrintable(ran.text()));
    }
};

QTEST_APPLESS_MAIN(CliSweepTest)
#include "tst_cli_sweep.moc"
