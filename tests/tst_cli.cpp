// SPDX-License-Identifier: Apache-2.0
// Claim: lightloom-cli keeps the contract other programs call it by: exit codes, one line per failure, results on
// stdout or in the file, tables of the promised shape, the same bytes on any number of threads, a clean stop on Ctrl-C.
#include "tests/cli_helpers.h"
#include <QElapsedTimer>
#include <QProcessEnvironment>
#include <QRegularExpression>
#include <QTemporaryDir>
#include <QtTest>
#include <cstdlib>
#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

using namespace lightloom::test;

namespace {

const QString kScene = LIGHTLOOM_SOURCE_DIR "/sample_scenes/cornell.glb";
const QStringList kQuickBake{"--set", "photons=4000",         "--set", "octree.depth=3",
                             "--set", "octree.first-depth=3", "--set", "gather.count=50"};
const QString kHeader = "x,y,z,nx,ny,nz,direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b";

} // namespace

class CliTest : public QObject {
    Q_OBJECT
    QTemporaryDir folder_;

    QString at(const QString& name) const { return folder_.filePath(name); }

    QStringList probeWords(const QString& method, const QString& output) const
    {
        return QStringList{"probe", kScene, "--method", method, "--points", at("points.csv"), "-o", output} +
               (method == "light-octree" || method == "photon-map" ? kQuickBake : QStringList()) +
               (method == "reference" ? QStringList{"--no-cache"} : QStringList());
    }

    /// What the program writes when stderr is a terminal.
    QByteArray onTerminal(const QStringList& words, const QString& noColor)
    {
        const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
        if (terminal < 0 || ::grantpt(terminal) != 0 || ::unlockpt(terminal) != 0) return "no terminal";
        const QString slave = ::ptsname(terminal);
        const int keepOpen = ::open(qPrintable(slave), O_RDWR | O_NOCTTY); // what was written stays readable
        QProcess process;
        QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
        environment.remove("NO_COLOR");
        environment.insert("TERM", "xterm");
        if (!noColor.isEmpty()) environment.insert("NO_COLOR", noColor);
        process.setProcessEnvironment(environment);
        process.setStandardErrorFile(slave);
        process.start(LIGHTLOOM_CLI, words);
        ::fcntl(terminal, F_SETFL, O_NONBLOCK);
        QByteArray seen;
        char buffer[4096];
        for (int i = 0; i < 600 && !process.waitForFinished(100); ++i) {
            for (ssize_t n; (n = ::read(terminal, buffer, sizeof buffer)) > 0;) seen.append(buffer, n);
        }
        for (ssize_t n; (n = ::read(terminal, buffer, sizeof buffer)) > 0;) seen.append(buffer, n);
        ::close(keepOpen);
        ::close(terminal);
        return seen;
    }

private Q_SLOTS:
    void initTestCase()
    {
        const Ran made = run({"points", kScene, "--count", "60", "-o", at("points.csv")});
        QVERIFY2(made.code == 0, qPrintable(made.text()));
        QVERIFY(write(at("hollow.csv"), "x,y,z,nx,ny,nz\n0,0,0,0,1,0\n0,0,0,0,0,0\n"));
        QVERIFY(write(at("text.glb"), "not a scene"));
    }

    void usageErrors_data()
    {
        QTest::addColumn<QStringList>("words");
        QTest::addColumn<QString>("mention");
        const auto add = [](const char* name, const QStringList& words, const char* mention) {
            QTest::newRow(name) << words << QString(mention);
        };
        const QStringList probe{"probe", kScene, "--method", "direct", "--points", at("points.csv")};
        add("nothing", {}, "no command");
        add("unknown command", {"illuminate"}, "illuminate");
        add("unknown option", {"params", "--colour"}, "--colour");
        add("unknown method", {"probe", kScene, "--method", "radiosity", "--points", "p.csv"}, "radiosity");
        add("no method", {"probe", kScene, "--points", "p.csv"}, "--method");
        add("missing argument", {"compare", "a.csv"}, "B is required");
        add("unknown metric", {"compare", "a.csv", "b.csv", "--metric", "psnr"}, "psnr");
        add("threads", {"params", "--threads", "-1"}, "-1");
        add("seed", {"params", "--seed", "-1"}, "-1");
        add("seed of text", {"params", "--seed", "one"}, "one");
        add("unknown parameter", probe + QStringList{"--set", "photon=1"}, "photon");
        add("value out of range", probe + QStringList{"--set", "vdl.count=9"}, "1 to 8");
        add("no value", probe + QStringList{"--set", "photons"}, "NAME=VALUE");
        add("parameters that clash", probe + QStringList{"--set", "octree.depth=3"}, "octree.first-depth");
        add("bake of nothing", {"bake", kScene, "--method", "direct", "-o", "b.vdb"}, "direct");
        add("bake without a file", {"bake", kScene, "--method", "light-octree"}, "--output");
        add("unknown preset", probe + QStringList{"--preset", "best"}, "best");
        add("unknown isa", probe + QStringList{"--isa", "neon"}, "neon");
        add("size", {"render", kScene, "--method", "direct", "--size", "10", "-o", "a.png"}, "WIDTHxHEIGHT");
        add("huge size", {"render", kScene, "--method", "direct", "--size", "99999x2", "-o", "a.png"}, "16384");
        add("picture format", {"render", kScene, "--method", "direct", "-o", "a.jpg"}, ".exr or .png");
        add("no output", {"render", kScene, "--method", "direct"}, "--output is required");
        add("json without a file", probe + QStringList{"--json"}, "-o");
        add("unknown sample", {"make-scene", "sponza", "-o", "a.glb"}, "sponza");
        add("not there yet", probe + QStringList{"--shard", "1"}, "--shard"); // not silently taken
        add("budget of a sweep", {"sweep", kScene, "--method", "light-octree", "--time-budget", "1", "-o", "s.csv"},
            "--time-budget");
        add("resume", probe + QStringList{"--resume"}, "--resume");
    }
    void usageErrors()
    {
        QFETCH(QStringList, words);
        QFETCH(QString, mention);
        const Ran ran = run(words);
        QVERIFY2(ran.code == 2 && ran.failedWithOneLine() && ran.err.contains(mention), qPrintable(ran.text()));
    }

    void badInput_data()
    {
        QTest::addColumn<QStringList>("words");
        QTest::addColumn<QString>("mention");
        const auto add = [](const char* name, const QStringList& words, const char* mention) {
            QTest::newRow(name) << words << QString(mention);
        };
        add("no scene", {"points", at("none.glb"), "--count", "5"}, "none.glb");
        add("scene of text", {"points", at("text.glb"), "--count", "5"}, "text.glb");
        add("folder as a scene", {"points", folder_.path(), "--count", "5"}, "is a folder");
        add("no points", {"probe", kScene, "--method", "direct", "--points", at("none.csv")}, "none.csv");
        add("zero normal", {"probe", kScene, "--method", "direct", "--points", at("hollow.csv")}, "hollow.csv: line 3");
        add("scene as points", {"probe", kScene, "--method", "direct", "--points", kScene}, "line 1");
        add("no camera", {"render", kScene, "--method", "direct", "--camera", "moon", "-o", at("a.png")}, "moon");
        add("points as results", {"compare", at("points.csv"), at("points.csv")}, "direct_r");
        add("unlike kinds", {"compare", at("points.csv"), "b.exr"}, "two of a kind");
        add("unknown kind", {"compare", "a.txt", "b.txt"}, ".csv, .exr, .png and .vdb");
        add("line end in a name", {"points", "a\nb\x1b[31m.glb", "--count", "5"}, "a b [31m.glb");
    }
    void badInput()
    {
        QFETCH(QStringList, words);
        QFETCH(QString, mention);
        const Ran ran = run(words);
        QVERIFY2(ran.code == 3 && ran.failedWithOneLine() && ran.err.contains(mention), qPrintable(ran.text()));
    }

    void whatCannotBeWrittenIsSaidBeforeTheWork()
    {
        QElapsedTimer timer;
        timer.start();
        const Ran ran = run({"probe", kScene, "--method", "reference", "--preset", "final", "--points",
                             at("points.csv"), "-o", at("nowhere/r.csv")});
        QVERIFY2(ran.code == 1 && ran.failedWithOneLine() && ran.err.contains("nowhere"), qPrintable(ran.text()));
        QVERIFY2(timer.elapsed() < 3000, qPrintable(QString("%1 ms").arg(timer.elapsed())));
        QCOMPARE(run({"points", kScene, "--count", "5", "-o", folder_.path()}).code, 1);
    }

    void aFullStdoutIsAFailure()
    {
        QProcess process;
        process.setStandardOutputFile("/dev/full");
        process.start(LIGHTLOOM_CLI, {"params"});
        QVERIFY(process.waitForFinished());
        QCOMPARE(process.exitCode(), 1);
        QVERIFY(process.readAllStandardError().contains("standard output"));
    }

    void whatDoesNotFitIsSaidWithTheFigure()
    {
        const Ran photons = run({"probe", kScene, "--method", "photon-map", "--points", at("points.csv"), "--set",
                                 "photons=1000000000", "-o", at("r.csv")});
        QVERIFY2(photons.code == 4 && photons.failedWithOneLine() && photons.err.contains("GiB"),
                 qPrintable(photons.text()));
        const Ran points = run({"points", kScene, "--count", "9007199254740992", "-o", at("many.csv")});
        QVERIFY2(points.code == 4 && points.failedWithOneLine(), qPrintable(points.text()));
        QVERIFY(!QFile::exists(at("many.csv")));
    }

    void helpAndVersionGoToStdout()
    {
        for (const QStringList& words : {QStringList{"--help"}, {"probe", "--help"}, {"--version"}}) {
            const Ran ran = run(words);
            QVERIFY2(ran.code == 0 && !ran.out.isEmpty() && ran.err.isEmpty(), qPrintable(ran.text()));
        }
    }

    void globalOptionsCountOnBothSides()
    {
        const Ran before = run({"--json", "--threads", "1", "params"}),
                  after = run({"params", "--threads", "1", "--json"});
        QCOMPARE(before.code, 0);
        QCOMPARE(before.out, after.out);
        const auto params = nlohmann::json::parse(before.out.toStdString());
        QVERIFY(params.size() > 10 && params[0].contains("key"));
    }

    void infoTellsAboutTheScene()
    {
        const Ran text = run({"info", kScene}), json = run({"info", kScene, "--json"});
        QVERIFY2(text.code == 0 && text.out.contains("cornell.glb"), qPrintable(text.text()));
        QVERIFY2(json.code == 0 && nlohmann::json::parse(json.out.toStdString()).is_object(), qPrintable(json.text()));
    }

    void pointsKeepTheirContract()
    {
        const Ran five = run({"points", kScene, "--count", "5"}),
                  seeded = run({"points", kScene, "--count", "5", "--seed", "2"});
        QVERIFY2(five.code == 0 && five.out.startsWith("x,y,z,nx,ny,nz\n"), qPrintable(five.text()));
        QCOMPARE(five.out.count('\n'), 6);
        QVERIFY(QString::fromUtf8(contents(at("points.csv"))).startsWith(five.out)); // the first five of sixty
        QVERIFY(seeded.out != five.out);
        const Ran json = run({"points", kScene, "--count", "5", "-o", at("five.csv"), "--json"});
        QCOMPARE(nlohmann::json::parse(json.out.toStdString())["points"].get<int>(), 5);
    }

    void resultsKeepTheirContract_data()
    {
        QTest::addColumn<QString>("method");
        for (const char* method : {"direct", "light-octree", "photon-map", "reference"})
            QTest::newRow(method) << method;
    }
    void resultsKeepTheirContract()
    {
        QFETCH(QString, method);
        const Ran ran =
            run(probeWords(method, at(method + ".csv")) + QStringList{"--json", "--set", "reference.samples=256"});
        QVERIFY2(ran.code == 0, qPrintable(ran.text()));
        const auto json = nlohmann::json::parse(ran.out.toStdString());
        QCOMPARE(json["method"].get<std::string>(), method.toStdString());
        QVERIFY(json["mean_direct_lux"].get<double>() > 0.0);
        QVERIFY((json["mean_indirect_lux"].get<double>() > 0.0) == (method != "direct"));

        const QStringList rows = QString::fromUtf8(contents(at(method + ".csv"))).split('\n');
        const QStringList points = QString::fromUtf8(contents(at("points.csv"))).split('\n');
        QCOMPARE(rows.size(), points.size());
        QCOMPARE(rows[0], method == "reference" ? kHeader + ",stderr_r,stderr_g,stderr_b" : kHeader);
        for (int i = 1; i + 1 < rows.size(); ++i) {
            QVERIFY2(rows[i].startsWith(points[i] + ","), qPrintable(rows[i] + " for " + points[i]));
            const QStringList cells = rows[i].split(',');
            QCOMPARE(cells.size(), method == "reference" ? 15 : 12);
            for (const QString& cell : cells.mid(6)) {
                bool isNumber = false;
                const double value = cell.toDouble(&isNumber);
                QVERIFY2(isNumber && value >= 0.0 && std::isfinite(value), qPrintable(rows[i]));
            }
        }
    }

    void aReferenceIsTracedOnce() // beside the scene; the same bytes from disk, and none of it with --no-cache
    {
        QVERIFY(QFile::copy(kScene, at("own.glb")));
        const QStringList words{"probe", at("own.glb"),           "--method", "reference",
                                "--set", "reference.samples=128", "--points", at("points.csv")};
        const Ran first = run(words), second = run(words), anew = run(words + QStringList{"--no-cache"});
        QVERIFY2(first.code == 0 && second.code == 0 && anew.code == 0, qPrintable(second.text()));
        QVERIFY(first.out == second.out && first.out == anew.out);
        QVERIFY2(first.err.isEmpty() && anew.err.isEmpty(), qPrintable(first.err + anew.err));
        QVERIFY2(second.err.contains("own.glb.lightloom-cache/"), qPrintable(second.text()));
    }

    void aRowDoesNotKnowItsNeighbours()
    {
        // backwards and with a point in mid-air between, where the method gathers
        QStringList points = QString::fromUtf8(contents(at("points.csv"))).trimmed().split('\n');
        const QString header = points.takeFirst(), midAir = "0.25,0.1,0.3,0,2,0";
        points.insert(30, midAir);
        std::reverse(points.begin(), points.end());
        QVERIFY(write(at("back.csv"), (header + '\n' + points.join('\n') + '\n').toUtf8()));
        for (const QString& method : {QString("light-octree"), QString("reference")}) {
            const QStringList more{"--set", "reference.samples=128"};
            QVERIFY(run(probeWords(method, at("forth_r.csv")) + more).code == 0);
            QStringList words = probeWords(method, at("back_r.csv")) + more;
            words[words.indexOf(at("points.csv"))] = at("back.csv");
            QVERIFY(run(words).code == 0);
            QStringList forth = QString::fromUtf8(contents(at("forth_r.csv"))).trimmed().split('\n');
            QStringList back = QString::fromUtf8(contents(at("back_r.csv"))).trimmed().split('\n');
            forth.removeFirst();
            back.removeFirst();
            const QString inAir = back.takeAt(back.size() - 31);
            QVERIFY2(inAir.startsWith(midAir + ","), qPrintable(inAir));
            QVERIFY2(inAir.split(',')[9].toDouble() > 0.0, qPrintable(inAir));
            std::reverse(back.begin(), back.end());
            QCOMPARE(back, forth);
        }
    }

    void sameBytesOnAnyNumberOfThreads()
    {
        QByteArray table, picture;
        for (const QString& threads : {QString("1"), QString("2"), QString("5")}) {
            QVERIFY(run(probeWords("light-octree", at("t.csv")) + QStringList{"--threads", threads}).code == 0);
            const Ran made = run(QStringList{"render", kScene, "--method", "light-octree", "--size", "40x30", "--spp",
                                             "2", "-o", at("t.exr"), "--threads", threads} +
                                 kQuickBake);
            QVERIFY2(made.code == 0, qPrintable(made.text()));
            if (table.isEmpty()) table = contents(at("t.csv")), picture = contents(at("t.exr"));
            QVERIFY(!table.isEmpty() && table == contents(at("t.csv")));
            QVERIFY(!picture.isEmpty() && picture == contents(at("t.exr")));
        }
    }

    void aStoredBakeAnswersLikeAFreshOne()
    {
        const QStringList bake = QStringList{"bake", kScene, "--method", "light-octree"} + kQuickBake;
        const Ran made = run(bake + QStringList{"-o", at("b.vdb"), "--json", "--threads", "1"});
        QVERIFY2(made.code == 0, qPrintable(made.text()));
        const auto json = nlohmann::json::parse(made.out.toStdString());
        QCOMPARE(json["work"]["photons_shot"].get<int>(), 4000);
        QCOMPARE(json["work"]["photons_caustic"].get<int>(), 0); // nothing specular in there
        QVERIFY(run(bake + QStringList{"-o", at("b5.vdb"), "--threads", "5"}).code == 0);
        QVERIFY(!contents(at("b.vdb")).isEmpty() && contents(at("b.vdb")) == contents(at("b5.vdb")));

        const QStringList probe{"probe", kScene, "--points", at("points.csv"), "--bake", at("b.vdb")};
        const Ran stored = run(probe + QStringList{"-o", at("stored.csv")});
        QVERIFY2(stored.code == 0, qPrintable(stored.text()));
        QVERIFY(run(probeWords("light-octree", at("fresh.csv"))).code == 0);
        QCOMPARE(contents(at("stored.csv")), contents(at("fresh.csv")));
        QVERIFY(run(probe + QStringList{"--method", "light-octree", "--set", "direct.samples=8"}).code == 0);

        QStringList photons = bake;
        photons[3] = "photon-map";
        QVERIFY(run(photons + QStringList{"-o", at("photons.vdb")}).code == 0);
        QVERIFY(
            run({"probe", kScene, "--points", at("points.csv"), "--bake", at("photons.vdb"), "-o", at("stored.csv")})
                .code == 0);
        QVERIFY(run(probeWords("photon-map", at("fresh.csv"))).code == 0);
        QCOMPARE(contents(at("stored.csv")), contents(at("fresh.csv")));

        const QStringList render{"render", kScene, "--size", "40x30", "--spp", "1", "-o", at("stored.exr")};
        QVERIFY(run(render + QStringList{"--bake", at("b.vdb")}).code == 0);
        const std::vector<std::pair<QStringList, QString>> refused{{{"--method", "photon-map"}, "photon-map"},
                                                                   {{"--set", "vdl.count=2"}, "vdl.count"},
                                                                   {{"--seed", "9"}, "seed"},
                                                                   {{"--preset", "final"}, "--preset"}};
        for (const auto& [words, mention] : refused) {
            const Ran ran = run(probe + words);
            QVERIFY2(ran.code == 3 && ran.failedWithOneLine() && ran.err.contains(mention), qPrintable(ran.text()));
        }
        QVERIFY(run({"make-scene", "figure", "--triangles", "60", "-o", at("other.glb")}).code == 0);
        QStringList other = probe;
        other[1] = at("other.glb");
        const Ran ran = run(other);
        QVERIFY2(ran.code == 3 && ran.failedWithOneLine(), qPrintable(ran.text()));
    }

    void picturesAreMadeAndCompared()
    {
        const QStringList words{"render", kScene, "--size", "64x48", "--spp", "4"};
        const QStringList cached = words + QStringList{"--method", "light-octree"} + kQuickBake;
        const Ran exr = run(cached + QStringList{"-o", at("a.exr"), "--json", "--camera", "0"});
        QVERIFY2(exr.code == 0, qPrintable(exr.text()));
        QCOMPARE(nlohmann::json::parse(exr.out.toStdString())["width"].get<int>(), 64);
        QVERIFY(run(words + QStringList{"--method", "reference", "--no-cache", "-o", at("b.exr")}).code == 0);
        QVERIFY(contents(at("b.exr")).contains("stderr.R") && !contents(at("a.exr")).contains("stderr.R"));
        const Ran target = run({"render", kScene, "--method", "reference", "--size", "16x12", "--target-stderr", "0.2",
                                "--no-cache", "--json", "-o", at("t.exr")});
        QVERIFY2(target.code == 0, qPrintable(target.text()));
        QVERIFY2(nlohmann::json::parse(target.out.toStdString())["relative_standard_error"].get<double>() <= 0.2,
                 qPrintable(target.text()));
        QVERIFY(run(cached + QStringList{"-o", at("a.png"), "--ev", "4"}).code == 0);
        QVERIFY(contents(at("a.exr")).contains("lightloom.photons"));
        QVERIFY(contents(at("a.png")).contains("lightloom.method"));

        const Ran all = run({"compare", at("a.exr"), at("b.exr"), "--json", "--heatmap", at("h.png")});
        QVERIFY2(all.code == 0, qPrintable(all.text()));
        const auto json = nlohmann::json::parse(all.out.toStdString());
        QVERIFY(json["relrmse"].get<double>() > 0.0 && std::abs(json["bias"].get<double>()) < 0.3);
        QCOMPARE(json["compared"].get<std::string>(), std::string("indirect light, 64 x 48 pixels"));
        QVERIFY(contents(at("h.png")).startsWith("\x89PNG"));

        const Ran flip = run({"compare", at("a.exr"), at("b.exr"), "--metric", "flip"});
        bool isNumber = false;
        const double value = flip.out.trimmed().toDouble(&isNumber);
        QVERIFY2(isNumber && value > 0.0 && value < 1.0, qPrintable(flip.text()));
        QCOMPARE(run({"compare", at("a.png"), at("a.png"), "--metric", "flip"}).out.trimmed(), QString("0"));
    }

    void tablesAreCompared()
    {
        const QByteArray header = kHeader.toUtf8();
        QVERIFY(write(at("m.csv"), header + "\n0,0,0,0,1,0,0,0,0,3,3,3\n1,0,0,0,1,0,0,0,0,1,1,1\n"));
        QVERIFY(write(at("n.csv"), header + ",stderr_r,stderr_g,stderr_b\n0,0,0,0,1,0,0,0,0,2,2,2,0,0,0\n"
                                            "1,0,0,0,1,0,0,0,0,2,2,2,0,0,0\n"));
        QVERIFY(write(at("moved.csv"), header + "\n0,0,0,0,1,0,0,0,0,3,3,3\n2,0,0,0,1,0,0,0,0,1,1,1\n"));
        const std::map<QString, double> wanted{{"relrmse", 0.5}, {"bias", 0.0}, {"mae", 0.5},
                                               {"p95", 0.5},     {"max", 0.5},  {"perpoint", 0.5}};
        for (const auto& [metric, value] : wanted) {
            const Ran ran = run({"compare", at("m.csv"), at("n.csv"), "--metric", metric});
            QVERIFY2(ran.code == 0 && std::abs(ran.out.toDouble() - value) <= 1e-6, qPrintable(metric + ran.text()));
        }
        QVERIFY(run({"compare", at("m.csv"), at("n.csv")}).out.contains("reference noise"));
        const Ran moved = run({"compare", at("moved.csv"), at("n.csv")});
        QVERIFY2(moved.code == 3 && moved.err.contains("line 3"), qPrintable(moved.text()));
        QVERIFY(write(at("nan.csv"), header + "\n0,0,0,0,1,0,0,0,0,nan,3,3\n1,0,0,0,1,0,0,0,0,1,1,1\n"));
        QCOMPARE(run({"compare", at("nan.csv"), at("n.csv")}).code, 3);
    }

    void progressIsToldAsAsked()
    {
        const QStringList words = probeWords("light-octree", at("p.csv"));
        const Ran none = run(words + QStringList{"--log-level", "warning"});
        QVERIFY2(none.code == 0 && none.err.isEmpty() && none.out.isEmpty(), qPrintable(none.text()));
        const Ran quiet = run(words + QStringList{"--quiet", "--progress", "json"});
        QVERIFY2(quiet.code == 0 && quiet.err.isEmpty(), qPrintable(quiet.text()));
        const Ran json = run(words + QStringList{"--progress", "json"});
        double last = -1.0;
        for (const QString& line : json.err.trimmed().split('\n')) {
            const auto event = nlohmann::json::parse(line.toStdString());
            if (!event.contains("progress")) continue;
            const double fraction = event["progress"].get<double>();
            QVERIFY2(fraction >= last && fraction <= 1.0, qPrintable(line));
            last = fraction;
        }
        QCOMPARE(last, 1.0);
        const Ran bar = run(words + QStringList{"--progress", "bar"});
        QVERIFY2(bar.err.contains('\r') && bar.err.contains("100 %") && !bar.err.contains('\x1b'),
                 qPrintable(bar.text()));
    }

    void colourOnlyOnTerminalsThatWantIt()
    {
        QVERIFY(!run({"points", at("none.glb"), "--count", "5"}).err.contains('\x1b'));
        const QStringList words{"points", at("none.glb"), "--count", "5"};
        const QByteArray coloured = onTerminal(words, ""), plain = onTerminal(words, "1");
        QVERIFY2(coloured.contains("\x1b[31merror:"), coloured.constData());
        QVERIFY2(plain.contains("error:") && !plain.contains('\x1b'), plain.constData());
    }

    void interruptStopsCleanly_data()
    {
        QTest::addColumn<QStringList>("words");
        QTest::addColumn<QString>("output");
        const QString points = at("points.csv");
        QTest::newRow("bake file") << QStringList{"bake",         kScene,  "--method",
                                                  "light-octree", "--set", "photons=20000000"}
                                   << "i_bake.vdb";
        QTest::newRow("bake") << QStringList{"probe",        kScene,  "--method",
                                             "light-octree", "--set", "photons=20000000",
                                             "--points",     points}
                              << "i_bake.csv";
        QTest::newRow("reference") << QStringList{"probe",     kScene,  "--method",
                                                  "reference", "--set", "reference.samples=3000000",
                                                  "--points",  points,  "--no-cache"}
                                   << "i_reference.csv";
        QTest::newRow("render") << QStringList{"render", kScene,    "--method", "direct",
                                               "--size", "640x480", "--spp",    "100000"}
                                << "i_render.exr";
    }
    void interruptStopsCleanly()
    {
        QFETCH(QStringList, words);
        QFETCH(QString, output);
        qint64 tookMs = 0;
        const Ran ran = interrupted(words + QStringList{"-o", at(output)}, tookMs);
        QVERIFY2(ran.code == 130, qPrintable(ran.text()));
        QVERIFY2(tookMs < 5000, qPrintable(QString("%1 ms").arg(tookMs)));
        if (!QFile::exists(at(output))) return;
        // what was kept says that it is not all
        const QByteArray kept = contents(at(output));
        QVERIFY2(kept.contains("incomplete"), kept.left(200).constData());
        if (output.endsWith(".csv")) QCOMPARE(run({"compare", at(output), at(output)}).code, 3);
    }

    void interruptedReferencesGoOn_data()
    {
        QTest::addColumn<QStringList>("how");
        QTest::newRow("all paths") << QStringList{"--set", "reference.samples=16384"};
        QTest::newRow("to a target") << QStringList{"--target-stderr", "0.005"};
    }
    void interruptedReferencesGoOn() // --resume ends where a run in one piece does, to the byte
    {
        QFETCH(QStringList, how);
        const QString scene = at(how[0] == "--set" ? "resume_a.glb" : "resume_b.glb");
        QVERIFY(QFile::copy(kScene, scene));
        const QStringList words =
            QStringList{"probe", scene, "--method", "reference", "--points", at("points.csv")} + how;
        qint64 tookMs = 0;
        const Ran part = interrupted(words + QStringList{"-o", at("part.csv")}, tookMs);
        QVERIFY2(part.code == 130 && part.err.contains("--resume"), qPrintable(part.text()));
        const Ran on = run(words + QStringList{"--resume", "-o", at("part.csv")});
        QVERIFY2(on.code == 0 && on.err.contains("traced before"), qPrintable(on.text()));
        QVERIFY2(run(words + QStringList{"--no-cache", "-o", at("whole.csv")}).code == 0, "in one piece");
        QVERIFY(!contents(at("part.csv")).isEmpty() && contents(at("part.csv")) == contents(at("whole.csv")));
    }

    void theSecondInterruptKills()
    {
        // sent back to back: the first one's clean stop must not keep the second from its default
        qint64 tookMs = 0;
        const Ran ran = interrupted({"probe", kScene, "--method", "reference", "--set", "reference.samples=3000000",
                                     "--points", at("points.csv"), "--no-cache", "-o", at("k.csv")},
                                    tookMs, 40);
        QVERIFY2(ran.code == -3 || ran.code == 130, qPrintable(ran.text())); // the kernel may fold pending signals
        QVERIFY2(tookMs < 5000, qPrintable(QString("%1 ms").arg(tookMs)));
    }

    void scenesAreMade()
    {
        const Ran made = run({"make-scene", "figure", "--triangles", "500", "-o", at("figure.glb"), "--json"});
        QVERIFY2(made.code == 0, qPrintable(made.text()));
        QVERIFY(nlohmann::json::parse(made.out.toStdString()).contains("triangles"));
        QCOMPARE(run({"points", at("figure.glb"), "--count", "3"}).out.count('\n'), 4);
    }
};

QTEST_APPLESS_MAIN(CliTest)
#include "tst_cli.moc"
