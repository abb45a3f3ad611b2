// SPDX-License-Identifier: Apache-2.0
// Claim: a reference is traced once. The second time it comes from disk, bit for bit; another question is never
// answered by it, a better answer serves a lesser question only where that was asked for, and a damaged entry costs one
// log line and time, not the result.
#include "core/compare/reference_store.h"
#include "core/scene/analytic_scenes.h"
#include "tests/light_helpers.h"
#include <QTemporaryDir>
#include <cstring>
#include <fstream>

using namespace lightloom;
using namespace lightloom::test;
namespace fs = std::filesystem;

namespace {

/// A store in a folder of its own, and what it logged.
struct Shelf {
    QTemporaryDir folder;
    std::vector<std::string> lines;
    LitScene lit{cavityCube(0.5f)};
    std::vector<ProbePoint> points;
    Workers workers{1};
    int traced = 0;        ///< calls of progress: none when nothing was traced
    std::stop_source stop; ///< of the next run
    int stopAfter = 0;     ///< calls of progress; 0: never
    bool resume = true;

    Shelf()
    {
        qputenv("XDG_CACHE_HOME", (folder.path() + "/user").toUtf8());
        for (const FacePoint& p : facePoints(*lit.scene, 12, 1))
            points.push_back({p.position, p.normal, points.size()});
    }
    [[nodiscard]] fs::path scene() const { return fs::path(folder.path().toStdString()) / "room.glb"; }
    KeptReference ask(const ReferenceJob& job, ReferenceMatch match = ReferenceMatch::sameBits, const Mix& mix = {})
    {
        traced = 0;
        stop = {};
        const ReferenceStore store(
            scene(), [&](LogLevel, const std::string& line) { lines.push_back(line); }, resume);
        return store.illuminance(*lit.rays, *lit.lights, mix, points, job, match, workers, stop.get_token(),
                                 [&](double) {
                                     if (++traced == stopAfter) stop.request_stop();
                                 });
    }
};

ReferenceJob jobOf(int paths, std::uint64_t seed = 1, float target = 0.0f)
{
    ReferenceJob job;
    job.paths = paths;
    job.seed = seed;
    job.targetError = target;
    return job;
}

bool sameBits(const ReferenceResult& a, const ReferenceResult& b)
{
    return a.finished == b.finished && a.probes.size() == b.probes.size() && a.paths == b.paths &&
           std::memcmp(a.probes.data(), b.probes.data(), a.probes.size() * sizeof(ProbeLight)) == 0;
}

} // namespace

class ReferenceStoreTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void theSecondTimeItIsFound()
    {
        Shelf shelf;
        const KeptReference first = shelf.ask(jobOf(256));
        QVERIFY(!first.wasStored && shelf.traced > 0);
        QVERIFY2(first.file.parent_path() == shelf.scene().string() + ".lightloom-cache", first.file.c_str());
        const KeptReference second = shelf.ask(jobOf(256));
        QVERIFY(second.wasStored && shelf.traced == 0);
        QVERIFY(sameBits(first.result, second.result));
        QVERIFY(shelf.lines.empty());
    }

    void anotherQuestionIsTracedAnew()
    {
        Shelf shelf;
        const KeptReference first = shelf.ask(jobOf(256));
        QVERIFY(!shelf.ask(jobOf(256, 2)).wasStored);                                           // seed
        QVERIFY(!shelf.ask(jobOf(256), ReferenceMatch::sameBits, {glm::vec3(0.5f)}).wasStored); // mix
        shelf.points[3].position.x += 1e-4f;
        QVERIFY(!shelf.ask(jobOf(256)).wasStored); // probes
        shelf.points[3].position.x -= 1e-4f;
        shelf.lit.~LitScene();
        new (&shelf.lit) LitScene(cavityCube(0.501f));
        QVERIFY(!shelf.ask(jobOf(256)).wasStored); // scene
    }

    void aBetterOneServesALesserQuestion()
    {
        Shelf shelf;
        const KeptReference fine = shelf.ask(jobOf(2048));
        QVERIFY(!shelf.ask(jobOf(256), ReferenceMatch::sameBits).wasStored); // bits would differ
        fs::remove_all(shelf.scene().string() + ".lightloom-cache");
        const KeptReference again = shelf.ask(jobOf(2048));
        const KeptReference lesser = shelf.ask(jobOf(256), ReferenceMatch::asGood);
        QVERIFY(lesser.wasStored && sameBits(lesser.result, again.result) && sameBits(fine.result, again.result));
        QVERIFY(!shelf.ask(jobOf(4096), ReferenceMatch::asGood).wasStored); // more paths than are there
        QVERIFY(shelf.ask(jobOf(1 << 20, 1, 0.5f), ReferenceMatch::asGood).wasStored);
        QVERIFY(!shelf.ask(jobOf(8192, 1, 1e-4f), ReferenceMatch::asGood).wasStored);
    }

    void whatWasStoppedGoesOn()
    {
        Shelf shelf;
        shelf.stopAfter = 5;
        const KeptReference part = shelf.ask(jobOf(4096));
        QVERIFY(part.result.finished == 5 && !part.wasStored && !part.file.empty());
        shelf.stopAfter = 0;
        shelf.resume = false;
        QCOMPARE(shelf.ask(jobOf(2048)).resumed, std::uint64_t(0));           // not what was asked to go on with
        const KeptReference anew = shelf.ask(jobOf(4096));                    // overwrites the stopped one
        QVERIFY(anew.resumed == 128 * 12 * 16 && anew.result.finished == 12); // ... from the finished 2048
        QVERIFY(fs::remove(anew.file));
        shelf.stopAfter = 5;
        QCOMPARE(shelf.ask(jobOf(4096)).result.finished, std::size_t(5));
        shelf.stopAfter = 0;
        shelf.resume = true;
        const KeptReference on = shelf.ask(jobOf(4096));
        QVERIFY(on.resumed > 0 && sameBits(on.result, anew.result));
        QVERIFY(shelf.ask(jobOf(4096)).wasStored && shelf.lines.empty());
    }

    void damageIsSaidOnceAndMended()
    {
        Shelf shelf;
        const KeptReference first = shelf.ask(jobOf(256));
        const auto size = fs::file_size(first.file);
        for (const std::uintmax_t at : {std::uintmax_t(8), size / 2, size - 1}) {
            {
                std::fstream file(first.file, std::ios::in | std::ios::out | std::ios::binary);
                file.seekg(std::streamoff(at));
                const char byte = char(file.get() ^ 0x10);
                file.seekp(std::streamoff(at));
                file.put(byte);
            }
            shelf.lines.clear();
            const KeptReference again = shelf.ask(jobOf(256));
            QVERIFY(!again.wasStored && sameBits(again.result, first.result));
            QCOMPARE(shelf.lines.size(), std::size_t(1));
            QVERIFY2(shelf.lines[0].find("damaged") != std::string::npos, shelf.lines[0].c_str());
            QVERIFY(shelf.ask(jobOf(256)).wasStored);
        }
        fs::resize_file(first.file, 0);
        QVERIFY(!shelf.ask(jobOf(256)).wasStored);
    }

    void theUsersFolderTakesWhatTheScenesCannot()
    {
        Shelf shelf;
        std::ofstream(shelf.scene().string() + ".lightloom-cache") << "no folder";
        const KeptReference first = shelf.ask(jobOf(128));
        const fs::path user = fs::path(shelf.folder.path().toStdString()) / "user" / "lightloom";
        QVERIFY2(first.file.parent_path() == user, first.file.c_str());
        QVERIFY(shelf.ask(jobOf(128)).wasStored);
        fs::remove_all(user);
        std::ofstream(shelf.folder.path().toStdString() + "/user_file") << "no folder";
        qputenv("XDG_CACHE_HOME", (shelf.folder.path() + "/user_file").toUtf8());
        const KeptReference nowhere = shelf.ask(jobOf(128));
        QVERIFY(nowhere.file.empty() && sameBits(nowhere.result, first.result));
        QCOMPARE(shelf.lines.size(), std::size_t(1));
    }

    void aStoreWithoutASceneKeepsNothing()
    {
        Shelf shelf;
        const ReferenceStore none;
        for (int i = 0; i < 2; ++i) {
            const KeptReference r =
                none.illuminance(*shelf.lit.rays, *shelf.lit.lights, {}, shelf.points, jobOf(128),
                                 ReferenceMatch::asGood, shelf.workers, {}, [&](double) { ++shelf.traced; });
            QVERIFY(!r.wasStored && r.file.empty() && r.result.finished == shelf.points.size());
        }
        QVERIFY(shelf.traced > 0 && none.folders().empty());
    }
};

QTEST_APPLESS_MAIN(ReferenceStoreTest)
#include "tst_reference_store.moc"
