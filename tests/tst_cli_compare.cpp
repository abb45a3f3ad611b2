// SPDX-License-Identifier: Apache-2.0
// Claim: `lightloom-cli compare` takes a bake itself against a reference and gives what probe or render and compare
// give in two steps; heatmaps show what was asked for; a bake's
// noise and the sizes of lightcuts are shown as maps; sides that do not go together are refused in one line.
#include "core/base/image_file.h"
#include "core/compare/legend.h"
#include "tests/cli_helpers.h"
#include <QTemporaryDir>
#include <QtTest>
#include <nlohmann/json.hpp>

using namespace lightloom;
using namespace lightloom::test;

namespace {

const QString kScene = LIGHTLOOM_SOURCE_DIR "/sample_scenes/cornell.glb";
const QString kOtherScene = LIGHTLOOM_SOURCE_DIR "/sample_scenes/two_rooms.glb";

} // namespace

class CliCompareTest : public QObject {
    Q_OBJECT
    QTemporaryDir folder_;
    QString at(const QString& name) const { return folder_.filePath(name); }

    static nlohmann::json json(const QStringList& words)
    {
        const Ran ran = run(words + QStringList{"--json"});
        return ran.code == 0 ? nlohmann::json::parse(ran.out.toStdString()) : nlohmann::json(ran.text().toStdString());
    }

private Q_SLOTS:
    void initTestCase()
    {
        const auto make = [](const QStringList& words) {
            const Ran ran = run(words);
            if (ran.code != 0) qWarning("%s", qPrintable(ran.text()));
            return ran.code == 0;
        };
        const QStringList view{"render", kScene, "--size", "48x36", "--set", "render.samples=4"};
        const QStringList bake{
            "bake",  kScene,           "--method", "light-octree",    "--set", "photons=4000",
            "--set", "octree.depth=3", "--set",    "gather.count=50", "--set", "octree.first-depth=3"};
        QVERIFY(make(bake + QStringList{"--set", "render.samples=4", "-o", at("bake.vdb")}));
        QVERIFY(make({"points", kScene, "--count", "30", "-o", at("points.csv")}));
        const QStringList reference{"--method", "reference", "--set", "reference.samples=128"};
        QVERIFY(
            make(QStringList{"probe", kScene, "--points", at("points.csv"), "-o", at("reference.csv")} + reference));
        QVERIFY(make(view + reference + QStringList{"-o", at("reference.exr")}));
        QVERIFY(make({"probe", kScene, "--bake", at("bake.vdb"), "--points", at("points.csv"), "-o", at("bake.csv")}));
        QVERIFY(make(view + QStringList{"--bake", at("bake.vdb"), "-o", at("bake.exr")}));
        QVERIFY(make(view + QStringList{"--bake", at("bake.vdb"), "-o", at("bake.png")}));
    }

    void aBakeAgainstATable()
    {
        const auto twoSteps = json({"compare", at("bake.csv"), at("reference.csv")});
        const auto oneStep = json({"compare", at("bake.vdb"), at("reference.csv"), "--scene", kScene});
        QVERIFY2(oneStep == twoSteps, qPrintable(QString::fromStdString(oneStep.dump() + twoSteps.dump())));
        QVERIFY(oneStep["relrmse"].get<double>() > 0.0 && oneStep["reference_noise"].get<double>() > 0.0);
    }

    void aBakeAgainstAPicture()
    {
        for (const QStringList& metric : {QStringList(), QStringList{"--metric", "flip"}}) {
            const auto twoSteps = json(QStringList{"compare", at("bake.exr"), at("reference.exr")} + metric);
            const auto oneStep =
                json(QStringList{"compare", at("bake.vdb"), at("reference.exr"), "--scene", kScene} + metric);
            QVERIFY2(oneStep == twoSteps, qPrintable(QString::fromStdString(oneStep.dump() + twoSteps.dump())));
            const auto reference = *readExr(at("reference.exr").toStdString());
            const double noise =
                relativeNoise(reference.find("stderr")->pixels, oneStep["mean_reference"].get<double>());
            QVERIFY(noise > 0.0);
            QCOMPARE(oneStep["reference_noise"].get<double>(), noise);
        }
    }

    void heatmapsShowWhatWasAsked()
    {
        std::map<QString, QByteArray> pictures;
        for (const QString& kind : {QString("relative"), QString("absolute"), QString("signed")}) {
            const Ran ran =
                run({"compare", at("bake.exr"), at("reference.exr"), "--heatmap", at(kind + ".png"), "--map", kind});
            QVERIFY2(ran.code == 0, qPrintable(ran.text()));
            pictures[kind] = contents(at(kind + ".png"));
            QVERIFY(pictures[kind].startsWith("\x89PNG"));
        }
        QVERIFY(pictures["relative"] != pictures["absolute"]);
    }

    void signedHeatmapsAreBlueWhereTooDark()
    {
        const QStringList words{"compare", at("bake.exr"), at("reference.exr"), "--heatmap", at("s.png")};
        QCOMPARE(run(words + QStringList{"--map", "signed"}).code, 0);
        const Result<ByteImage> map = readPng(at("s.png").toStdString());
        const Result<LayeredImage> a = readExr(at("bake.exr").toStdString()),
                                   b = readExr(at("reference.exr").toStdString());
        QVERIFY(map && a && b);
        const FloatImage &seen = *a->find("indirect"), &wanted = *b->find("indirect");
        const ScalarImage difference = errorMap(seen, wanted, 1.0, ErrorKind::difference);
        const float top = legendTop(difference);
        int clear = 0;
        for (int y = 0; y < seen.height; ++y) {
            for (int x = 0; x < seen.width; ++x) {
                const float d = difference.values[static_cast<std::size_t>(y * seen.width + x)];
                if (!(std::abs(d) > 0.1f * top)) continue;
                const std::uint8_t* p = map->rgb.data() + 3 * (y * map->width + x);
                QVERIFY2(d < 0.0f ? p[2] > p[0] : p[0] > p[2], qPrintable(QString("pixel %1 %2").arg(x).arg(y)));
                ++clear;
            }
        }
        QVERIFY2(clear > 50, qPrintable(QString("%1 pixels that are clearly off").arg(clear)));
    }

    void aBakeShowsItsNoise()
    {
        const QStringList words{"render", kScene, "--size", "48x36", "-o", at("n.png"), "--noise-map"};
        const Ran ran = run(words + QStringList{at("noise.png"), "--bake", at("bake.vdb")});
        QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        const Result<ByteImage> map = readPng(at("noise.png").toStdString());
        QVERIFY(map && map->height == 36 + kLegendHeight);
        for (const QString& method : {QString("reference"), QString("direct")}) {
            const Ran refused = run(words + QStringList{at("none.png"), "--method", method});
            QVERIFY2(refused.code == 2 && refused.failedWithOneLine() && refused.err.contains("--noise-map"),
                     qPrintable(refused.text()));
            QVERIFY(!QFile::exists(at("none.png")));
        }
    }

    void lightcutsShowTheirSizes()
    {
        const QStringList words{"render", kScene, "--size", "48x36", "--spp", "1", "-o", at("cuts.png"), "--cut-map"};
        const QStringList voxels{"--method", "voxel-lightcuts", "--set", "voxel.size=16"};
        const nlohmann::json told = json(words + QStringList{at("sizes.png")} + voxels);
        QVERIFY2(told.is_object() && told.contains("cut_sizes"), qPrintable(QString::fromStdString(told.dump())));
        const double average = told["cut_sizes"]["mean"];
        const int p99 = told["cut_sizes"]["p99"], most = told["cut_sizes"]["max"];
        QVERIFY(1.0 <= average && average <= p99 && p99 <= most && most <= 2000);
        const Result<ByteImage> map = readPng(at("sizes.png").toStdString());
        QVERIFY(map && map->height == 36 + kLegendHeight);
        const QStringList none = words + QStringList{at("none.png")};
        for (const QStringList& other :
             {QStringList{"--method", "reference"}, QStringList{"--method", "light-octree"},
              voxels + QStringList{"--set", "voxel.lookup=field"}, voxels + QStringList{"--final-gather"},
              QStringList{"--bake", at("bake.vdb")}}) {
            const Ran refused = run(none + other);
            const int wanted = other.contains("--bake") ? 3 : 2; // a file has to be read first
            QVERIFY2(refused.code == wanted && refused.failedWithOneLine() && refused.err.contains("--cut-map"),
                     qPrintable(refused.text()));
            QVERIFY(!QFile::exists(at("none.png")));
        }
    }

    void wrongSidesAreRefused_data()
    {
        QTest::addColumn<QStringList>("words");
        QTest::addColumn<QString>("mention");
        const auto add = [](const char* name, const QStringList& words, const char* mention) {
            QTest::newRow(name) << (QStringList{"compare"} + words) << QString(mention);
        };
        add("no scene", {at("bake.vdb"), at("reference.csv")}, "--scene");
        add("bake as a reference", {at("bake.csv"), at("bake.vdb")}, "is a bake");
        add("picture without light", {at("bake.vdb"), at("bake.png"), "--scene", kScene}, ".csv or .exr");
        add("another scene", {at("bake.vdb"), at("reference.csv"), "--scene", kOtherScene}, "another scene");
        add("another scene's picture", {at("bake.vdb"), at("reference.exr"), "--scene", kOtherScene}, "another scene");
        add("no such camera", {at("bake.vdb"), at("reference.exr"), "--scene", kScene, "--camera", "moon"}, "moon");
        add("another bake", {at("bake.vdb"), at("reference.csv"), "--scene", kScene, "--set", "photons=5"},
            "photons=5");
        add("heatmap of a table", {at("bake.csv"), at("reference.csv"), "--heatmap", at("h.png")}, "need pictures");
        add("a table's heatmap by bake",
            {at("bake.vdb"), at("reference.csv"), "--scene", kScene, "--heatmap", at("h.png")}, "need pictures");
    }
    void wrongSidesAreRefused()
    {
        QFETCH(QStringList, words);
        QFETCH(QString, mention);
        const Ran ran = run(words);
        QVERIFY2(ran.code == 3 && ran.failedWithOneLine() && ran.err.contains(mention), qPrintable(ran.text()));
    }
};

QTEST_APPLESS_MAIN(CliCompareTest)
#include "tst_cli_compare.moc"
