// SPDX-License-Identifier: Apache-2.0
// Claim: a path-traced picture knows its own noise: the standard errors told are the errors made. With a target it
// works where noise is, meets the target over the picture, and stays unbiased. Stopped pictures go on to the same bits,
// on any number of threads; pictures come from disk the second time.
#include "core/compare/reference_store.h"
#include "core/scene/analytic_scenes.h"
#include "tests/light_helpers.h"
#include "tests/view_helpers.h"
#include <QTemporaryDir>
#include <mutex>

using namespace lightloom;
using namespace lightloom::test;
namespace fs = std::filesystem;

namespace {

/// The L-shaped room seen from one arm: bright beside the lamp, dark around the corner.
struct Room {
    LitScene lit{cavityL(0.6f)};
    Workers two{2}, three{3};

    static ViewJob job(int samples, float target = 0.0f, std::uint64_t seed = 1)
    {
        ViewJob job;
        job.camera.position = {3.2f, 1.5f, 0.6f};
        job.camera.orientation = glm::quatLookAt(glm::normalize(glm::vec3(-1.0f, -0.1f, 0.35f)), glm::vec3(0, 1, 0));
        job.camera.yFov = 1.2f;
        job.width = 38; // whole blocks neither across nor down
        job.height = 27;
        job.indirect = ViewJob::Indirect::paths;
        job.samples = samples;
        job.targetError = target;
        job.seed = seed;
        return job;
    }
    View render(const ViewJob& job, int threads = 2)
    {
        return renderView(*lit.rays, *lit.lights, {}, nullptr, job, threads == 2 ? two : three, {});
    }
};

/// (a - b)^2 over the sum of their squared errors, pixel by pixel: 1 on average if the errors are true.
RunningMean squaredZ(const View& a, const View& b)
{
    RunningMean squares;
    const FloatImage wholeA = wholeView(a), wholeB = wholeView(b);
    for (std::size_t i = 0; i < wholeA.pixels.size(); ++i) {
        const double d = double(wholeA.pixels[i].x - wholeB.pixels[i].x);
        const double e = std::hypot(double(a.standardError.pixels[i].x), double(b.standardError.pixels[i].x));
        squares.add(d * d / (e * e));
    }
    return squares;
}

/// Largest rms of the errors told in a block of 4 x 4 pixels.
double worstBlock(const View& view)
{
    const FloatImage& errors = view.standardError;
    double worst = 0.0;
    for (int top = 0; top + 4 <= errors.height; top += 4) {
        for (int left = 0; left + 4 <= errors.width; left += 4) {
            RunningMean squares;
            for (int i = 0; i < 16; ++i) {
                const double e = double(errors.at(left + i % 4, top + i / 4).x);
                squares.add(e * e);
            }
            worst = std::max(worst, std::sqrt(squares.mean()));
        }
    }
    return worst;
}

struct Noise {
    double mean = 0.0, rms = 0.0; ///< cd/m2; rms of the errors told
};
Noise noiseOf(const View& view)
{
    RunningMean mean, squares;
    const FloatImage whole = wholeView(view);
    for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
        mean.add(double(whole.pixels[i].x));
        squares.add(double(view.standardError.pixels[i].x) * double(view.standardError.pixels[i].x));
    }
    return {mean.mean(), std::sqrt(squares.mean())};
}

} // namespace

class ReferenceViewTest : public QObject {
    Q_OBJECT
    Room room_;

private Q_SLOTS:
    void theErrorsToldAreTheErrorsMade_data()
    {
        QTest::addColumn<int>("samples");
        QTest::addColumn<float>("target");
        QTest::newRow("even") << 256 << 0.0f;
        QTest::newRow("to a target") << 4096 << 0.03f;
    }
    void theErrorsToldAreTheErrorsMade()
    {
        QFETCH(int, samples);
        QFETCH(float, target);
        const View a = room_.render(Room::job(samples, target)), b = room_.render(Room::job(samples, target, 2));
        const RunningMean z2 = squaredZ(a, b);
        // Student's t lifts z^2 by 2/(n - 3) for n batches: at most 1.2 here
        QVERIFY2(z2.mean() >= 1.0 - 4.9 * z2.standardError() && z2.mean() <= 1.2 + 4.9 * z2.standardError(),
                 qPrintable(QString("%1 +- %2").arg(z2.mean()).arg(z2.standardError())));
    }

    void theTargetIsMetOverThePicture() // and without bias
    {
        const View fine = room_.render(Room::job(4096, 0.03f));
        const Noise noise = noiseOf(fine);
        QVERIFY(fine.isWhole && fine.capped == 0);
        QVERIFY2(noise.rms <= 0.03 * noise.mean && noise.rms >= 0.018 * noise.mean,
                 qPrintable(QString::number(noise.rms / noise.mean)));
        const auto pixels = double(fine.direct.pixels.size());
        const View even = room_.render(Room::job(int(double(fine.rays) / pixels)));
        // as many samples, put where the noise is: the noisiest blocks gain
        QVERIFY2(fine.samples < even.samples && worstBlock(fine) < 0.9 * worstBlock(even),
                 qPrintable(QString("%1, even %2").arg(worstBlock(fine)).arg(worstBlock(even))));
        // means over the picture: errors of pixels are independent
        const Noise evenNoise = noiseOf(even);
        const double error = std::hypot(noise.rms, evenNoise.rms) / std::sqrt(pixels);
        QVERIFY2(std::abs(noise.mean - evenNoise.mean) <= 4.9 * error,
                 qPrintable(QString("%1 and %2 +- %3").arg(noise.mean).arg(evenNoise.mean).arg(error)));
    }

    void aCapIsCounted()
    {
        const View view = room_.render(Room::job(64, 1e-5f));
        QCOMPARE(view.capped, std::uint64_t(view.direct.pixels.size()));
        QVERIFY(view.isWhole && view.samples == 64);
    }

    void stoppedPicturesGoOnToTheSameBits_data()
    {
        QTest::addColumn<float>("target");
        QTest::newRow("even") << 0.0f;
        QTest::newRow("to a target") << 0.1f;
    }
    void stoppedPicturesGoOnToTheSameBits()
    {
        QFETCH(float, target);
        const ViewJob job = Room::job(target > 0 ? 1024 : 32, target);
        const View whole = room_.render(job);
        QVERIFY(sameBits(whole, room_.render(job, 3)));
        ViewState state;
        View part;
        int rounds = 0;
        for (; rounds < 1000 && !part.isWhole; ++rounds) {
            std::stop_source stop;
            std::mutex mutex;
            int calls = 0;
            part = continueView(*room_.lit.rays, *room_.lit.lights, {}, nullptr, job, state,
                                rounds % 2 ? room_.two : room_.three, stop.get_token(), [&](double) {
                                    std::lock_guard lock(mutex);
                                    if (++calls == 20 + 5 * rounds) stop.request_stop();
                                });
        }
        QVERIFY2(rounds >= 3, qPrintable(QString::number(rounds)));
        QVERIFY(sameBits(part, whole));
    }

    void aStoppedAdaptivePictureShowsAFirstLook()
    {
        std::stop_source stop;
        ViewState state;
        const View part = continueView(*room_.lit.rays, *room_.lit.lights, {}, nullptr, Room::job(1024, 0.05f), state,
                                       room_.two, stop.get_token(), [&](double f) {
                                           if (f > 0.3) stop.request_stop();
                                       });
        QVERIFY(!part.isWhole && part.rays > 0);
        int dark = 0;
        for (const glm::vec3& p : wholeView(part).pixels) dark += p.x > 0.0f ? 0 : 1;
        QVERIFY2(dark == 0, qPrintable(QString("%1 dark pixels").arg(dark)));
    }

    void picturesAreKept()
    {
        QTemporaryDir folder;
        qputenv("XDG_CACHE_HOME", (folder.path() + "/user").toUtf8());
        std::vector<std::string> lines;
        const ReferenceStore store(fs::path(folder.path().toStdString()) / "room.glb",
                                   [&](LogLevel, const std::string& line) { lines.push_back(line); });
        const auto ask = [&](const ViewJob& job, ReferenceMatch match, const std::stop_token& stop = {},
                             const std::function<void(double)>& progress = {}) {
            return store.picture(*room_.lit.rays, *room_.lit.lights, {}, job, match, room_.two, stop, progress);
        };
        for (const float target : {0.0f, 0.1f}) {
            const ViewJob job = Room::job(target > 0 ? 1024 : 32, target);
            std::stop_source stop;
            const KeptView part = ask(job, ReferenceMatch::sameBits, stop.get_token(), [&](double f) {
                if (f > 0.4) stop.request_stop();
            });
            QVERIFY(!part.result.isWhole && !part.file.empty());
            const KeptView on = ask(job, ReferenceMatch::sameBits), again = ask(job, ReferenceMatch::sameBits);
            QVERIFY(on.resumed > 0 && !on.wasStored && again.wasStored);
            QVERIFY(sameBits(on.result, room_.render(job)) && sameBits(on.result, again.result));
            QVERIFY(!ask(Room::job(8, target, 5), ReferenceMatch::asGood).wasStored); // another seed
        }
        QVERIFY(ask(Room::job(16), ReferenceMatch::asGood).wasStored);
        QVERIFY(!ask(Room::job(16), ReferenceMatch::sameBits).wasStored);
        QVERIFY(!ask(Room::job(64), ReferenceMatch::asGood).wasStored);
        QVERIFY(ask(Room::job(64, 0.2f), ReferenceMatch::asGood).wasStored);
        QVERIFY(lines.empty());
    }
};

QTEST_APPLESS_MAIN(ReferenceViewTest)
#include "tst_reference_view.moc"
