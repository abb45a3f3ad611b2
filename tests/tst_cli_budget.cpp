// SPDX-License-Identifier: Apache-2.0
// Claim: --time-budget and --error-budget of bake, probe and render pick parameters, say what was picked and expected,
// bake with it, and tell what came out; what cannot be is one clear line.
#include "tests/cli_helpers.h"
#include <QTemporaryDir>
#include <QtTest>
#include <nlohmann/json.hpp>

using namespace lightloom::test;

class CliBudgetTest : public QObject {
    Q_OBJECT
    QTemporaryDir folder_;
    QString at(const QString& name) const { return folder_.filePath(name); }
    QStringList bake(const QString& output) const
    {
        return {"bake", at("cornell.glb"), "--method", "light-octree", "-o", at(output)};
    }

private Q_SLOTS:
    void initTestCase() { QCOMPARE(run({"make-scene", "cornell", "-o", at("cornell.glb")}).code, 0); }

    void errorBudgetTellsAll()
    {
        const Ran ran = run(bake("e.vdb") + QStringList{"--error-budget", "0.12", "--json"});
        QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        QVERIFY2(ran.err.contains("picked ") && ran.err.contains("expected: ") && ran.err.contains("came out: "),
                 qPrintable(ran.err));
        const auto json = nlohmann::json::parse(ran.out.toStdString());
        const auto& budget = json["budget"];
        QCOMPARE(budget["asked"]["error"].get<double>(), 0.12);
        QVERIFY(!budget["asked"].contains("cpu_seconds"));
        for (const char* key : {"octree.depth", "gather.count", "photons"}) { // picked is what was baked
            const int baked = QString::fromStdString(json["parameters"][key].get<std::string>()).toInt();
            QCOMPARE(budget["picked"][key].get<int>(), baked);
        }
        QVERIFY(budget["expected"]["error"] <= 0.12 && budget["expected"]["cpu_seconds"] > 0.0);
        QVERIFY(budget["floor"] > 0.0 && budget["floor"] < budget["expected"]["error"]);
        QVERIFY(budget["pilots"]["cpu_seconds"] > 0.0);
        QVERIFY(budget["came_out"]["error"] > 0.04 && budget["came_out"]["error"] < 0.18);
        QCOMPARE(budget["came_out"]["cpu_seconds"].get<double>(), json["cpu_seconds"].get<double>());
        QVERIFY(QFileInfo::exists(at("cornell.glb.lightloom-cache"))); // the pilots' reference
    }

    void aBakeByHandIsTheSame() // nothing of the pilots is in the file
    {
        const Ran ran = run(bake("a.vdb") + QStringList{"--error-budget", "0.15", "--json"});
        QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        const auto json = nlohmann::json::parse(ran.out.toStdString());
        QStringList again = bake("b.vdb");
        for (const auto& [key, value] : json["parameters"].items())
            again += {"--set", QString::fromStdString(key + "=" + value.get<std::string>())};
        const Ran byHand = run(again);
        QVERIFY2(byHand.code == 0, qPrintable(byHand.text()));
        QVERIFY(contents(at("a.vdb")) == contents(at("b.vdb")));
    }

    void timeBudgetKeepsWhatIsSet()
    {
        const Ran ran = run(bake("t.vdb") + QStringList{"--time-budget", "0.6", "--set", "octree.depth=5", "--set",
                                                        "gather.count=90", "--json"});
        QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        const auto json = nlohmann::json::parse(ran.out.toStdString());
        QVERIFY(json["parameters"]["octree.depth"] == "5" && json["parameters"]["gather.count"] == "90");
        const double expected = json["budget"]["expected"]["cpu_seconds"].get<double>();
        QVERIFY2(expected > 0.4 && expected <= 0.6, qPrintable(QString::number(expected)));
    }

    void probeAndRenderTakeThemToo()
    {
        QVERIFY(write(at("p.csv"), "x,y,z,nx,ny,nz\n0,0.5,0,0,1,0\n"));
        const Ran probe = run(
            {"probe", at("cornell.glb"), "--method", "photon-map", "--error-budget", "0.2", "--points", at("p.csv")});
        QVERIFY2(probe.code == 0 && probe.err.contains("picked gather.count="), qPrintable(probe.text()));
        const Ran render = run({"render", at("cornell.glb"), "--method", "light-octree", "--error-budget", "0.2",
                                "--size", "16x12", "-o", at("r.png")});
        QVERIFY2(render.code == 0 && render.err.contains("came out: "), qPrintable(render.text()));
    }

    void nonsenseIsOneLine_data()
    {
        QTest::addColumn<QStringList>("more");
        QTest::addColumn<int>("code");
        QTest::addColumn<QString>("mention");
        QTest::newRow("no time") << QStringList{"--time-budget", "0"} << 2 << "--time-budget 0 is not above 0";
        QTest::newRow("negative") << QStringList{"--error-budget", "-0.1"} << 2 << "--error-budget -0.1";
        QTest::newRow("not a number") << QStringList{"--error-budget", "nan"} << 2 << "--error-budget nan";
        QTest::newRow("endless") << QStringList{"--time-budget", "inf"} << 2 << "--time-budget inf";
        QTest::newRow("no word") << QStringList{"--time-budget", "long"} << 2 << "--time-budget";
        QTest::newRow("below the floor") << QStringList{"--error-budget", "0.0001"} << 3 << "below the floor";
        QTest::newRow("too few") << QStringList{"--time-budget", "0.001"} << 3 << "too few";
    }
    void nonsenseIsOneLine()
    {
        QFETCH(QStringList, more);
        QFETCH(int, code);
        QFETCH(QString, mention);
        const Ran ran = run(bake("n.vdb") + more);
        QVERIFY2(ran.code == code && ran.err.contains(mention), qPrintable(ran.text()));
        QVERIFY2(ran.failedWithOneLine(), qPrintable(ran.text()));
        QVERIFY(!QFileInfo::exists(at("n.vdb")));
    }

    void whatLeavesNothingToPickIsRefused()
    {
        QVERIFY(write(at("p.csv"), "x,y,z,nx,ny,nz\n0,0.5,0,0,1,0\n"));
        const QStringList probe{"probe", at("cornell.glb"), "--points", at("p.csv"), "--time-budget", "1"};
        const Ran reference = run(probe + QStringList{"--method", "reference"});
        QVERIFY2(reference.code == 2 && reference.err.contains("--target-stderr"), qPrintable(reference.text()));
        const Ran baked = run(probe + QStringList{"--bake", at("e.vdb")});
        QVERIFY2(baked.code == 2 && baked.err.contains("baked already"), qPrintable(baked.text()));
    }
};

QTEST_APPLESS_MAIN(CliBudgetTest)
#include "tst_cli_budget.moc"
