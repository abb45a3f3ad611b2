// SPDX-License-Identifier: Apache-2.0
// Claim: lightloom-cli export keeps the contract: three kinds of files, exit codes, one line per failure, figures as
// JSON, the same bytes on any number of threads, a clean stop on Ctrl-C that leaves no file.
#include "tests/cli_helpers.h"
#include <QTemporaryDir>
#include <QtTest>
#include <map>
#include <nlohmann/json.hpp>

using namespace lightloom::test;

namespace {
const QString kScene = LIGHTLOOM_SOURCE_DIR "/sample_scenes/cornell.glb";
const QString kOther = LIGHTLOOM_SOURCE_DIR "/sample_scenes/two_rooms.glb";
} // namespace

class CliExportTest : public QObject {
    Q_OBJECT
    QTemporaryDir folder_;

    QString at(const QString& name) const { return folder_.filePath(name); }

private Q_SLOTS:
    void initTestCase()
    {
        for (const QString method : {"light-octree", "photon-map"}) {
            const Ran ran = run(
                {"bake", kScene, "--method", method, "--set", "photons=4000", "--quiet", "-o", at(method + ".vdb")});
            QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        }
    }

    void writesWhatIsAskedFor()
    {
        for (const QString threads : {"1", "3"}) {
            const Ran ran = run({"export", at("light-octree.vdb"), "--scene", kScene, "--lightmap", at("map.exr"),
                                 "--gltf", at("scene.glb"), "--volume", at("volume.vdb"), "--atlas-size", "256",
                                 "--json", "--threads", threads});
            QVERIFY2(ran.code == 0, qPrintable(ran.text()));
            const auto json = nlohmann::json::parse(ran.out.toStdString());
            QCOMPARE(json.at("files").size(), std::size_t(3));
            QCOMPARE(json.at("atlas").at("size").get<int>(), 256);
            QCOMPARE(json.at("atlas").at("overlapping_texels").get<int>(), 0);
            QVERIFY(json.at("atlas").at("stretch_mean").get<double>() >= 1.0);
            QVERIFY(json.at("atlas").at("utilisation").get<double>() > 0.4);
            QVERIFY(json.at("brightest_lux").get<double>() > 0.0);
            for (const QString name : {"map.exr", "scene.glb", "volume.vdb"}) {
                const QByteArray bytes = contents(at(name));
                QVERIFY(!bytes.isEmpty());
                if (threads == "1") files_[name] = bytes;
                QVERIFY2(bytes == files_[name], qPrintable(name));
            }
            QVERIFY(!QFile::exists(at("scene.exr")));
        }
        // the scene that was written is a scene
        const Ran info = run({"info", at("scene.glb"), "--quiet"});
        QVERIFY2(info.code == 0, qPrintable(info.text()));
    }

    void otherMethodsHaveLightmapsToo()
    {
        const Ran ran = run({"export", at("photon-map.vdb"), "--scene", kScene, "--lightmap", at("photons.exr"),
                             "--texels-per-metre", "50", "--with-direct"});
        QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        QVERIFY(ran.out.contains("50 per metre") && ran.out.contains("photons.exr"));
        const Ran volume = run({"export", at("photon-map.vdb"), "--scene", kScene, "--volume", at("none.vdb")});
        QVERIFY2(volume.code == 3 && volume.failedWithOneLine(), qPrintable(volume.text()));
        QVERIFY(!QFile::exists(at("none.vdb")));
    }

    void voxelsAreExportedAsCutsAndAsVoxels() // a lightmap by the lookup that was asked for, a volume of the voxels
    {
        const Ran baked = run({"bake", kScene, "--method", "voxel-lightcuts", "--set", "voxel.size=16", "--set",
                               "voxel.directions=64", "--quiet", "-o", at("voxels.vdb")});
        QVERIFY2(baked.code == 0, qPrintable(baked.text()));
        const QStringList words{"export",        at("voxels.vdb"), "--scene",      kScene,  "--volume",
                                at("cells.vdb"), "--lightmap",     at("cuts.exr"), "--set", "voxel.threshold=0.1",
                                "--set",         "voxel.near=8",   "--atlas-size", "64"};
        const Ran ran = run(words);
        QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        const QByteArray volume = contents(at("cells.vdb")), cuts = contents(at("cuts.exr"));
        QVERIFY(!volume.isEmpty() && !cuts.isEmpty());
        const Ran plain = run(words + QStringList{"--set", "voxel.lookup=field"});
        QVERIFY2(plain.code == 0, qPrintable(plain.text()));
        QVERIFY(contents(at("cuts.exr")) != cuts);
    }

    void failures_data()
    {
        QTest::addColumn<QStringList>("words");
        QTest::addColumn<int>("code");
        const QStringList good{at("light-octree.vdb"), "--scene", kScene};
        QTest::newRow("nothing asked for") << good << 2;
        QTest::newRow("no scene") << QStringList{at("light-octree.vdb"), "--lightmap", at("x.exr")} << 2;
        QTest::newRow("a picture for people") << good + QStringList{"--lightmap", at("x.png")} << 2;
        QTest::newRow("not a glb") << good + QStringList{"--gltf", at("x.gltf")} << 2;
        QTest::newRow("odd size") << good + QStringList{"--lightmap", at("x.exr"), "--atlas-size", "1001"} << 2;
        QTest::newRow("both sizes") << good + QStringList{"--lightmap", at("x.exr"),          "--atlas-size",
                                                          "256",        "--texels-per-metre", "10"}
                                    << 2;
        QTest::newRow("no density") << good + QStringList{"--lightmap", at("x.exr"), "--texels-per-metre", "0"} << 2;
        QTest::newRow("no folder") << good + QStringList{"--lightmap", at("nowhere/x.exr")} << 1;
        QTest::newRow("no such bake") << QStringList{at("gone.vdb"), "--scene", kScene, "--lightmap", at("x.exr")} << 3;
        QTest::newRow("another scene") << QStringList{at("light-octree.vdb"), "--scene", kOther, "--lightmap",
                                                      at("x.exr")}
                                       << 3;
        QTest::newRow("too fine") << good + QStringList{"--lightmap", at("x.exr"), "--texels-per-metre", "1e6"} << 3;
        QTest::newRow("no second UV set") << good + QStringList{"--lightmap", at("x.exr"), "--scene-uv"} << 3;
        QTest::newRow("baked otherwise") << good + QStringList{"--lightmap", at("x.exr"), "--set", "photons=5"} << 3;
    }
    void failures()
    {
        QFETCH(QStringList, words);
        QFETCH(int, code);
        const Ran ran = run(QStringList{"export"} + words);
        QVERIFY2(ran.code == code && ran.failedWithOneLine(), qPrintable(ran.text()));
        QVERIFY(!QFile::exists(at("x.exr")));
    }

    void interruptLeavesNothing()
    {
        qint64 took = 0;
        const Ran ran =
            interrupted({"export", at("light-octree.vdb"), "--scene", kScene, "--gltf", at("stop.glb"), "--volume",
                         at("stop.vdb"), "--with-direct", "--set", "direct.samples=4096", "--atlas-size", "4096"},
                        took);
        QVERIFY2(ran.code == 130, qPrintable(ran.text()));
        QVERIFY2(ran.err.contains("nothing was written"), qPrintable(ran.text()));
        QVERIFY2(took < 2000, qPrintable(QString::number(took)));
        for (const QString name : {"stop.glb", "stop.exr", "stop.vdb"}) QVERIFY(!QFile::exists(at(name)));
    }

private:
    std::map<QString, QByteArray> files_;
};

QTEST_APPLESS_MAIN(CliExportTest)
#include "tst_cli_export.moc"
