// SPDX-License-Identifier: Apache-2.0
// Claim: light of small lamps that meets a mirror first is in the reference, once: behind a plane mirror stands the
// lamp's image, whose illuminance is known exactly, sharp edge included. Scenes without mirrors or small lamps shoot no
// photon for it.
#include "core/scene/analytic_scenes.h"
#include "core/trace/reference.h"
#include "tests/mirror_scene.h"
#include <cstring>

using namespace lightloom;
using namespace lightloom::test;

namespace {

ReferenceResult trace(const LitScene& lit, const std::vector<ProbePoint>& probes, int paths, std::uint64_t seed = 1,
                      int threads = 2)
{
    ReferenceJob job;
    job.paths = paths;
    job.seed = seed;
    Workers workers(threads);
    return referenceIlluminance(*lit.rays, *lit.lights, {}, probes, job, workers, {});
}

ProbePoint onFloor(double x, double z) { return {{float(x), 0.0f, float(z)}, {0, 1, 0}, std::uint64_t(1000 * x)}; }

} // namespace

class CausticsTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void theImageOfALampLightsTheFloor() // and nothing where it does not reach
    {
        const MirrorScene mirror;
        std::vector<ProbePoint> probes;
        std::vector<double> expected;
        for (const auto& [x, z] : {std::pair(0.8, 0.1), {1.2, 0.6}, {0.6, -0.8}, {1.1, 0.2}, {2.2, 0.1}}) {
            probes.push_back(onFloor(x, z));
            expected.push_back(MirrorScene::exact(x, z));
        }
        const ReferenceResult r = trace(mirror.lit, probes, 12'800);
        QCOMPARE(r.causticPhotons, std::uint64_t(200) << 17);
        QVERIFY2(r.causticRadius > 0.0 && r.causticRadius < 0.01 * double(mirror.lit.scene->bounds.diagonal()),
                 qPrintable(QString::number(r.causticRadius)));
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const ProbeLight& p = r.probes[i];
            const double found = double(p.indirect.x), error = double(p.indirectError.x);
            QVERIFY2(
                std::abs(found - expected[i]) <= sidakLimit(5) * error + 1e-3 * expected[i] + 1e-9,
                qPrintable(QString("point %1: %2 +- %3 instead of %4").arg(i).arg(found).arg(error).arg(expected[i])));
            // a disc's photons are Poisson distributed, and so is the noise of the mean over 200 rounds
            const double poisson = MirrorScene::noise(mirror.lit, expected[i], 200);
            QVERIFY2(error >= 0.75 * poisson && error <= 1.3 * poisson,
                     qPrintable(QString("%1 of %2, not %3").arg(error).arg(expected[i]).arg(poisson)));
            QVERIFY(double(p.causticBlur) >= 0.0 && double(p.causticBlur) <= 0.5 * expected[i] + 1e-9);
            QCOMPARE(p.caustic, p.indirect); // nothing else reflects
        }
    }

    void theEdgeIsAsSharpAsTheDiscs() // across the border the answer is the mean over a disc, and the bound says so
    {
        const MirrorScene mirror;
        const double edge = 1.5; // the mirror's upper rim at 1.2 m: 2 - 2/(x + 1) = 1.2
        std::vector<ProbePoint> probes;
        for (const double off : {-0.06, -0.02, 0.0, 0.02, 0.06}) probes.push_back(onFloor(edge + off, 0.0));
        ReferenceState state;
        ReferenceJob job;
        job.paths = 1024;
        Workers workers(2);
        const ReferenceResult r =
            continueReference(*mirror.lit.rays, *mirror.lit.lights, {}, probes, job, state, workers, {});
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const double x = double(probes[i].position.x), point = MirrorScene::exact(x, 0.0);
            RunningMean blurred;
            for (std::uint64_t round = 0; round < state.causticRounds; ++round) {
                blurred.add(MirrorScene::overDisc(x, 0.0, double(causticRadius(*mirror.lit.rays, round))));
            }
            const double found = double(r.probes[i].indirect.x), error = double(r.probes[i].indirectError.x);
            QVERIFY2(std::abs(found - blurred.mean()) <= sidakLimit(5) * error + 2e-3 * point,
                     qPrintable(QString("%1: %2 +- %3, disc %4").arg(x).arg(found).arg(error).arg(blurred.mean())));
            const double bound = double(r.probes[i].causticBlur);
            QVERIFY2(std::abs(found - point) <= bound + sidakLimit(5) * error,
                     qPrintable(QString("%1: %2 instead of %3, bound %4").arg(x).arg(found).arg(point).arg(bound)));
        }
    }

    void aSmallPanelComesOnce() // by photons what paths leave out: the same light as by paths alone
    {
        const MirrorScene small(0.085f);
        const std::vector<ProbePoint> probe{onFloor(1.0, 0.1)};
        ReferenceJob paths;
        paths.paths = 2'000'000;
        paths.caustics = false;
        Workers workers(2);
        const ProbeLight a =
            referenceIlluminance(*small.lit.rays, *small.lit.lights, {}, probe, paths, workers, {}).probes[0];
        const ReferenceResult both = trace(small.lit, probe, 6400);
        const ProbeLight& b = both.probes[0];
        QVERIFY(both.causticPhotons > 0 && a.caustic == glm::vec3(0));
        const double error = std::hypot(double(a.indirectError.x), double(b.indirectError.x));
        QVERIFY2(b.indirect.x > 1.0f && error <= 0.07 * double(b.indirect.x), qPrintable(QString("%1").arg(error)));
        QVERIFY2(std::abs(double(a.indirect.x - b.indirect.x)) <= 4.9 * error,
                 qPrintable(QString("%1 and %2 +- %3").arg(double(a.indirect.x)).arg(double(b.indirect.x)).arg(error)));
    }

    void nothingIsShotWithoutNeed()
    {
        const LitScene matt(cavityCube(0.5f));
        QCOMPARE(trace(matt, {{{0, -2, 0}, {0, 1, 0}, 0}}, 128).causticPhotons, std::uint64_t(0));
        const MirrorScene large(1.0f); // a mirror, but its lamp is no small one
        QCOMPARE(trace(large.lit, {onFloor(2, 0)}, 128).causticPhotons, std::uint64_t(0));
        const MirrorScene off(0.0f, 0.0f);
        QCOMPARE(trace(off.lit, {onFloor(2, 0)}, 128).causticPhotons, std::uint64_t(0));
    }

    void sameBitsOnAnyThreads() // and twice the light is twice the result
    {
        const MirrorScene mirror, twice(0.0f, 200.0f);
        const std::vector<ProbePoint> probes{onFloor(0.8, 0.1), onFloor(1.5, 0.0)};
        const ReferenceResult one = trace(mirror.lit, probes, 1024, 3, 1),
                              three = trace(mirror.lit, probes, 1024, 3, 3);
        QVERIFY(std::memcmp(one.probes.data(), three.probes.data(), probes.size() * sizeof(ProbeLight)) == 0);
        const ReferenceResult doubled = trace(twice.lit, probes, 1024, 3);
        for (std::size_t i = 0; i < probes.size(); ++i) {
            QCOMPARE(doubled.probes[i].caustic.x, 2.0f * one.probes[i].caustic.x);
        }
    }

    void seedsAgree()
    {
        const MirrorScene mirror;
        const std::vector<ProbePoint> probes{onFloor(0.8, 0.1), onFloor(1.1, 0.5), onFloor(1.49, 0.0)};
        const ReferenceResult a = trace(mirror.lit, probes, 1024, 1), b = trace(mirror.lit, probes, 1024, 2);
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const double e = std::hypot(double(a.probes[i].indirectError.x), double(b.probes[i].indirectError.x));
            const double d = double(a.probes[i].indirect.x - b.probes[i].indirect.x);
            QVERIFY2(d != 0.0 && std::abs(d) <= sidakLimit(3) * e, qPrintable(QString::number(d / e)));
        }
    }

    void stoppedRoundsGoOnToTheSameBits()
    {
        const MirrorScene mirror;
        const std::vector<ProbePoint> probes{onFloor(0.8, 0.1), onFloor(1.1, 0.5)};
        ReferenceJob job;
        Workers workers(2);
        const ReferenceResult whole = trace(mirror.lit, probes, job.paths);
        ReferenceState state;
        std::stop_source stop;
        const ReferenceResult part = continueReference(*mirror.lit.rays, *mirror.lit.lights, {}, probes, job, state,
                                                       workers, stop.get_token(), [&](double f) {
                                                           if (f > 0.7) stop.request_stop();
                                                       });
        QVERIFY(part.finished == 0 && state.causticRounds > 0 && state.causticRounds < 16);
        const ReferenceResult on =
            continueReference(*mirror.lit.rays, *mirror.lit.lights, {}, probes, job, state, workers, {});
        QVERIFY(on.finished == 2);
        QVERIFY(std::memcmp(on.probes.data(), whole.probes.data(), probes.size() * sizeof(ProbeLight)) == 0);
    }

    void aTargetCountsThePhotonsOwnLight() // paths alone find nothing here, and a share of nothing is never reached
    {
        const MirrorScene mirror;
        const std::vector<ProbePoint> probes{onFloor(0.8, 0.1), onFloor(1.1, 0.5)};
        ReferenceJob job;
        job.paths = 1 << 20;
        job.targetError = 0.1f;
        Workers workers(2);
        const ReferenceResult r =
            referenceIlluminance(*mirror.lit.rays, *mirror.lit.lights, {}, probes, job, workers, {});
        QCOMPARE(r.finished, probes.size());
        QVERIFY2(r.causticPhotons < mostCausticPhotons(job) / 20, qPrintable(QString::number(r.causticPhotons)));
        double squares = 0.0, light = 0.0;
        for (const ProbeLight& p : r.probes) {
            squares += double(p.indirectError.x) * double(p.indirectError.x) / 2.0;
            light += double(p.indirect.x) / 2.0;
        }
        QVERIFY2(std::sqrt(squares) <= 0.1 * light, qPrintable(QString::number(std::sqrt(squares) / light)));
    }

    void discsKeepClearOfWalls()
    {
        const LitScene cube(cavityCube(0.5f));
        QVERIFY(std::abs(clearRadius(*cube.rays, {1.9f, -2.0f, 0.0f}, {0, 1, 0}, 0.5f) - 0.1f) <= 0.005f);
        QCOMPARE(clearRadius(*cube.rays, {0.0f, -2.0f, 0.0f}, {0, 1, 0}, 0.5f), 0.5f);
    }
};

QTEST_APPLESS_MAIN(CausticsTest)
#include "tst_caustics.moc"
