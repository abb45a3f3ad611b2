// SPDX-License-Identifier: Apache-2.0
// Claims: one bake is probed as lights, as a colour octree and through the textures' arrays without baking anew; a
// photon map's cache comes from its file as it was; what a bake takes in textures is told.
#include "cli_helpers.h"
#include <QTemporaryDir>
#include <QtTest>
#include <nlohmann/json.hpp>

using namespace lightloom::test;

class CliShowTest : public QObject {
    Q_OBJECT

    QTemporaryDir folder_;
    [[nodiscard]] QString path(const char* name) const { return folder_.filePath(QString::fromLatin1(name)); }
    const QString scene_ = QStringLiteral(LIGHTLOOM_SOURCE_DIR "/sample_scenes/cornell.glb");
    const QStringList small_{"--set", "photons=30000", "--set", "gather.count=100", "--set", "octree.depth=4"};

    /// Green channel of the indirect light, by row.
    [[nodiscard]] std::vector<double> probe(const QStringList& words) const
    {
        std::vector<double> values;
        const Ran ran = run(QStringList{"probe", scene_, "--points", path("points.csv")} + words);
        [&] { QVERIFY2(ran.code == 0, qPrintable(ran.text())); }();
        for (const QString& line : ran.out.split('\n', Qt::SkipEmptyParts).mid(1)) {
            values.push_back(line.split(',')[10].toDouble());
        }
        return values;
    }
    static double mean(const std::vector<double>& v)
    {
        double sum = 0.0;
        for (const double x : v) sum += x;
        return sum / static_cast<double>(v.size());
    }
    static double apart(const std::vector<double>& a, const std::vector<double>& b)
    {
        double sum = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
        return sum / static_cast<double>(a.size()) / mean(a);
    }

private Q_SLOTS:
    void initTestCase()
    {
        const Ran points = run({"points", scene_, "--count", "300", "-o", path("points.csv")});
        QVERIFY2(points.code == 0, qPrintable(points.text()));
    }

    void aBakeIsShownInSeveralWays()
    {
        const Ran baked =
            run(QStringList{"bake", scene_, "--method", "light-octree", "--json", "-o", path("octree.vdb")} + small_);
        QVERIFY2(baked.code == 0, qPrintable(baked.text()));
        const auto told = nlohmann::json::parse(baked.out.toStdString())["texture_bytes"];
        const std::uint64_t bricks = told["bricks"], lights = told["lights"], normals = told["normals"];
        QVERIFY(bricks > 0 && lights > 0 && normals > 0);
        QCOMPARE(told["all"].get<std::uint64_t>(), bricks + lights + normals);
        QCOMPARE(bricks % 32, std::uint64_t(0)); // whole bricks of 8 texels

        const QStringList from{"--bake", path("octree.vdb")};
        const auto lit = probe(from), colour = probe(from + QStringList{"--set", "octree.show=colour"}),
                   packed = probe(from + QStringList{"--set", "octree.values=packed"});
        QCOMPARE(lit.size(), std::size_t(300));
        qInfo("colour octree %.4f of the mean apart, packed %.5f", apart(lit, colour), apart(lit, packed));
        QVERIFY(apart(lit, colour) > 0.0 && apart(lit, colour) <= 0.1);
        QVERIFY(apart(lit, packed) > 0.0 && apart(lit, packed) <= 2e-3);
        // the same from a fresh bake
        const auto fresh = probe(QStringList{"--method", "light-octree", "--set", "octree.show=colour"} + small_);
        QVERIFY(apart(colour, fresh) <= 1e-6);
    }

    void aCacheComesFromItsFile()
    {
        const QStringList cached = small_ + QStringList{"--set", "photons.lookup=christensen"};
        const Ran baked = run(QStringList{"bake", scene_, "--method", "photon-map", "-o", path("map.vdb")} + cached);
        QVERIFY2(baked.code == 0, qPrintable(baked.text()));
        const auto stored = probe({"--bake", path("map.vdb")}),
                   fresh = probe(QStringList{"--method", "photon-map"} + cached),
                   direct = probe(QStringList{"--method", "photon-map"} + small_);
        QVERIFY(stored == fresh);
        qInfo("nearest kept irradiance is %.3f of the mean off the density estimate", apart(direct, stored));
        QVERIFY(apart(direct, stored) > 1e-3 && apart(direct, stored) <= 0.15);
        // what the file was not baked with is refused
        const Ran refused = run({"probe", scene_, "--points", path("points.csv"), "--bake", path("map.vdb"), "--set",
                                 "photons.lookup=direct"});
        QVERIFY2(refused.failedWithOneLine(), qPrintable(refused.text()));
        QVERIFY(refused.err.contains("photons.lookup"));
    }
};

QTEST_APPLESS_MAIN(CliShowTest)
#include "tst_cli_show.moc"
