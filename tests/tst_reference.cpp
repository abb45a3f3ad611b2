// SPDX-License-Identifier: Apache-2.0
// The path tracer judges every cache, so it is judged first: against everything that is known exactly (METHODS
// section 8), within 1 % and within the Sidak limit on |z| at a family-wise 1e-6, with standard errors of at most a
// fifth of the tolerance. Then that it repeats itself: other seeds agree, other thread counts give the same bits.
#include "core/scene/analytic_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/trace/path_walk.h"
#include "core/trace/reference.h"
#include "tests/light_helpers.h"
#include <cstring>
#include <mutex>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr double kTolerance = 0.01;

struct Claim {
    QString what;
    double found, error, expected;
};

/// All claims of one scene, judged together.
void judge(const std::vector<Claim>& claims)
{
    const double limit = sidakLimit(int(claims.size()));
    for (const Claim& c : claims) {
        const QString figures = QString("%1: %2 +- %3 instead of %4")
                                    .arg(c.what)
                                    .arg(c.found, 0, 'g', 7)
                                    .arg(c.error, 0, 'g', 3)
                                    .arg(c.expected, 0, 'g', 7);
        QVERIFY2(c.error <= 0.2 * kTolerance * std::abs(c.expected), qPrintable("too noisy to judge, " + figures));
        QVERIFY2(std::abs(c.found - c.expected) <= kTolerance * std::abs(c.expected), qPrintable(figures));
        // 1e-5: float rounding of the scene where there is no noise at all
        QVERIFY2(std::abs(c.found - c.expected) <= limit * c.error + 1e-5 * std::abs(c.expected), qPrintable(figures));
    }
}

std::vector<ProbePoint> probesAt(const std::vector<FacePoint>& points)
{
    std::vector<ProbePoint> probes;
    for (std::size_t i = 0; i < points.size(); ++i) probes.push_back({points[i].position, points[i].normal, i});
    return probes;
}

ReferenceResult light(const LitScene& lit, const std::vector<ProbePoint>& probes, int paths, std::uint64_t seed = 1,
                      const Mix& mix = {}, int threads = 0)
{
    static Workers shared; // starting threads per call would cost more than some of the scenes
    ReferenceJob job;
    job.paths = paths;
    job.seed = seed;
    if (threads == 0) return referenceIlluminance(*lit.rays, *lit.lights, mix, probes, job, shared, {});
    Workers own(threads);
    return referenceIlluminance(*lit.rays, *lit.lights, mix, probes, job, own, {});
}

enum class Part { direct, indirect };

/// Mean over an area: sets of evenly spread probes, each set an estimate of its own; their spread is the error.
Claim meanOver(const LitScene& lit, Part part, int perSet, double expected, const QString& what,
               const std::string& nodes = {})
{
    constexpr int kSets = 48;
    std::vector<FacePoint> points;
    for (int set = 0; set < kSets; ++set) {
        const std::vector<FacePoint> more = facePoints(*lit.scene, perSet, std::uint64_t(set), nodes);
        points.insert(points.end(), more.begin(), more.end());
    }
    const ReferenceResult result = light(lit, probesAt(points), 128);
    RunningMean mean;
    for (int set = 0; set < kSets; ++set) {
        double sum = 0.0;
        for (int i = 0; i < perSet; ++i) {
            const ProbeLight& p = result.probes[std::size_t(set * perSet + i)];
            sum += double(part == Part::direct ? p.direct.x : p.indirect.x);
        }
        mean.add(sum / perSet);
    }
    return {what, mean.mean(), mean.standardError(), expected};
}

glm::vec3 zUp(double x, double y, double z) { return fromZUp(float(x), float(y), float(z)); }

} // namespace

class ReferenceTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void reflectionOfAPlane() // A4: rho E C at points of the wall and in mid-air, facing down
    {
        for (const double side : {0.5, 4.0, 500.0}) {
            const LitScene lit(reflectionScene(float(side)));
            const std::vector<glm::dvec3> s2{
                {-side / 2, 0, 0}, {side / 2, 0, 0}, {side / 2, side, 0}, {-side / 2, side, 0}};
            std::vector<ProbePoint> probes;
            std::vector<double> expected;
            const auto add = [&](glm::dvec3 p, glm::dvec3 n) {
                probes.push_back({zUp(p.x, p.y, p.z), zUp(n.x, n.y, n.z), probes.size()});
                expected.push_back(500.0 * configurationFactor(p, n, s2));
            };
            add({0, 0, 0.125}, {0, 1, 0});
            if (side > 1.0) { // from farther off the small plane is a speck that few paths find
                for (const double z : {0.5, 1.0, 2.0, 3.0}) add({0, 0, z}, {0, 1, 0});
                add({0, side / 2, 2}, {0, 0, -1});
                add({1, side / 2, 2}, {0, 0, -1});
            }
            const ReferenceResult result = light(lit, probes, side < 1.0 ? 2'000'000 : 600'000);
            std::vector<Claim> claims;
            for (std::size_t i = 0; i < probes.size(); ++i) {
                claims.push_back({QString("side %1, point %2").arg(side).arg(i), double(result.probes[i].indirect.x),
                                  double(result.probes[i].indirectError.x), expected[i]});
                QVERIFY(double(result.probes[i].direct.x) <= 1e-4 * expected[i]); // the sun grazes the wall
            }
            judge(claims);
        }
    }

    void reflectionPastAScreen() // A5: the same wall sees what lies before the screen and over it
    {
        const LitScene lit(obstructionScene());
        std::vector<ProbePoint> probes;
        std::vector<double> expected;
        for (const double z : {0.25, 0.5, 0.75, 1.0, 2.0}) {
            const glm::dvec3 p(0, 0, z), n(0, 1, 0);
            double factor = configurationFactor(p, n, {{-2, 0, 0}, {2, 0, 0}, {2, 1, 0}, {-2, 1, 0}});
            const double over = z > 0.5 ? z / (z - 0.5) : 4.0; // where the view over the screen meets the plane
            if (over < 4.0) factor += configurationFactor(p, n, {{-2, over, 0}, {2, over, 0}, {2, 4, 0}, {-2, 4, 0}});
            probes.push_back({zUp(0, 0, z), zUp(0, 1, 0), probes.size()});
            expected.push_back(500.0 * factor);
        }
        const ReferenceResult result = light(lit, probes, 400'000);
        std::vector<Claim> claims;
        for (std::size_t i = 0; i < probes.size(); ++i) {
            claims.push_back({QString("point %1").arg(i), double(result.probes[i].indirect.x),
                              double(result.probes[i].indirectError.x), expected[i]});
        }
        judge(claims);
    }

    void closedCavities() // A6: mean indirect E = Phi rho / (A (1 - rho)), whatever the shape
    {
        std::vector<Claim> claims;
        for (const double rho : {0.2, 0.5, 0.8}) {
            const LitScene cube(cavityCube(float(rho))), corner(cavityL(float(rho)));
            const double share = 1000.0 * rho / (1.0 - rho);
            claims.push_back(meanOver(cube, Part::indirect, 128, share / 96.0, QString("cube %1").arg(rho)));
            claims.push_back(meanOver(corner, Part::indirect, 128, share / 72.0, QString("L %1").arg(rho)));
        }
        judge(claims);
    }

    void pointsInACube_data() // A7: solved by a Nystrom method to about 1e-4 (validation script, n = 20)
    {
        QTest::addColumn<double>("rho");
        QTest::addColumn<QList<double>>("indirect");
        QTest::addRow("1/2") << 0.5 << QList<double>{0.563146, 0.557313, 0.541746, 0.539945, 0.468481, 0.387268};
        QTest::addRow("2/3") << 2.0 / 3.0 << QList<double>{1.103559, 1.095595, 1.073588, 1.071971, 0.966740, 0.837721};
        QTest::addRow("4/5") << 0.8 << QList<double>{2.166152, 2.156405, 2.128592, 2.127629, 1.989721, 1.808542};
    }
    void pointsInACube()
    {
        QFETCH(double, rho);
        QFETCH(QList<double>, indirect);
        const std::vector<glm::dvec2> at{{0, 0}, {.5, 0}, {.5, .5}, {.8, 0}, {.8, .8}, {.95, .95}};
        const LitScene lit(litCube(float(rho), 1.0f));
        std::vector<ProbePoint> probes; // three faces share the work and must agree
        for (int face = 0; face < 3; ++face) {
            for (const glm::dvec2 uv : at) {
                glm::vec3 p(0.0f), n(0.0f);
                p[face] = -1.0f, n[face] = 1.0f;
                p[(face + 1) % 3] = float(uv.x), p[(face + 2) % 3] = float(uv.y);
                probes.push_back({p, n, probes.size()});
            }
        }
        const ReferenceResult result = light(lit, probes, 60'000);
        std::vector<Claim> claims;
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const glm::dvec2 uv = at[i % at.size()];
            const ProbeLight& p = result.probes[i];
            claims.push_back({QString("indirect %1").arg(i), double(p.indirect.x), double(p.indirectError.x),
                              indirect[qsizetype(i % at.size())]});
            claims.push_back({QString("direct %1").arg(i), double(p.direct.x), double(p.directError.x),
                              std::pow(1.0 + uv.x * uv.x + uv.y * uv.y, -1.5)});
        }
        judge(claims);
    }

    void furnace() // A8: direct M, indirect M rho / (1 - rho) at every point, edges and corners included
    {
        std::vector<Claim> claims;
        for (const double rho : {0.2, 0.5, 0.8, 0.95}) {
            const LitScene lit(furnaceBox(float(rho), 2.0f, {2.0f, 1.0f, 3.0f}));
            const std::vector<ProbePoint> probes{{{0, -0.5f, 0}, {0, 1, 0}, 0},
                                                 {{0.99f, -0.5f, 0.2f}, {0, 1, 0}, 1},
                                                 {{0.99f, 0.2f, 1.5f}, {0, 0, -1}, 2},
                                                 {{0.1f, 0.2f, 0.3f}, {0.6f, 0, 0.8f}, 3}};
            const ReferenceResult result = light(lit, probes, rho > 0.9 ? 90'000 : 40'000);
            for (const ProbeLight& p : result.probes) {
                claims.push_back({QString("direct %1").arg(rho), double(p.direct.x), double(p.directError.x), 2.0});
                claims.push_back({QString("indirect %1").arg(rho), double(p.indirect.x), double(p.indirectError.x),
                                  2.0 * rho / (1.0 - rho)});
            }
        }
        judge(claims);
    }

    void parallelPlates() // A9: B_low = M / (1 - r1 r2), B_high = r2 B_low; E on one plate is the other's B
    {
        const double r1 = 0.5, r2 = 0.8, low = 1.0 / (1.0 - r1 * r2);
        const LitScene lit(lightloom::parallelPlates(float(r1), float(r2)));
        const std::vector<ProbePoint> probes{{{0.3f, 0, 0.1f}, {0, 1, 0}, 0}, {{0.2f, 1, -0.4f}, {0, -1, 0}, 1}};
        const ReferenceResult result = light(lit, probes, 200'000);
        const ProbeLight &onLow = result.probes[0], &onHigh = result.probes[1];
        const double open = 3e-4; // the rim: 1e-4 of each bounce
        QCOMPARE(onLow.direct.x, 0.0f);
        const auto near = [&](const ProbeLight& p, double expected, double direct) {
            QVERIFY(double(p.indirectError.x) <= 0.002 * expected);
            QVERIFY2(std::abs(double(p.indirect.x) / expected - 1.0) <=
                         open + sidakLimit(3) * double(p.indirectError.x) / expected,
                     qPrintable(QString("%1 instead of %2").arg(double(p.indirect.x)).arg(expected)));
            QVERIFY(std::abs(double(p.direct.x) - direct) <= open + sidakLimit(3) * double(p.directError.x));
        };
        near(onLow, r2 * low, 0.0);
        near(onHigh, low - 1.0, 1.0);
    }

    void concentricSpheres() // A9: means over each sphere, with the facets' true areas
    {
        const double r1 = 0.5, r2 = 0.8;
        const LitScene lit(lightloom::concentricSpheres(float(r1), float(r2)));
        const double k = area(triangles(*lit.scene, "Inner")) / area(triangles(*lit.scene, "Outer"));
        const double in = 1.0 / (1.0 - r1 * r2 * k / (1.0 - r2 * (1.0 - k))),
                     out = r2 * k * in / (1.0 - r2 * (1.0 - k));
        QVERIFY(std::abs(k - 0.25) <= 1e-3);
        judge({meanOver(lit, Part::indirect, 32, out, "on the inner", "Inner"),
               meanOver(lit, Part::direct, 32, k, "direct on the outer", "Outer"),
               meanOver(lit, Part::indirect, 32, out / r2 - k, "indirect on the outer", "Outer")});
    }

    void lampSeenInAMirrorIsIndirect() // its image through F0 .9, and its plain light stays direct
    {
        SceneBuilder builder("mirror");
        builder.add("Lamp", quadMesh({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}), builder.addEmitter("lamp", glm::vec3(100)));
        builder.add("Mirror", quadMesh({-50, -1, -50}, {0, 0, 100}, {100, 0, 0}),
                    builder.addMetal("mirror", glm::vec3(0.9f), 0.0f));
        const LitScene lit(builder.finish());
        const ReferenceResult result = light(lit, {{{0, 0, 0}, {0, -1, 0}, 0}, {{0, 0, 0}, {0, 1, 0}, 1}}, 1'600'000);
        const double image =
            configurationFactor({0, 0, 0}, {0, 1, 0}, {{-1, 4, -1}, {1, 4, -1}, {1, 4, 1}, {-1, 4, 1}});
        const double straight =
            configurationFactor({0, 0, 0}, {0, 1, 0}, {{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}});
        const ProbeLight &down = result.probes[0], &up = result.probes[1];
        QCOMPARE(down.direct, glm::vec3(0));
        QCOMPARE(up.indirect, glm::vec3(0)); // the lamp reflects nothing
        judge({{"image", double(down.indirect.x), double(down.indirectError.x), 100.0 * kPiD * image * 0.9},
               {"straight", double(up.direct.x), double(up.directError.x), 100.0 * kPiD * straight}});
    }

    void glossyFurnace() // rough metal walls: indirect = M (a + a^2 + ...) would need the albedo per angle; a lossless
                         // mirror room knows it: F0 .99 with smooth gloss keeps nearly all
    {
        for (const float roughness : {0.0f, 0.06f}) {
            SceneBuilder builder("glossy furnace");
            Material m;
            m.baseColor = glm::vec4(0.5f, 0.5f, 0.5f, 1.0f);
            m.metallic = 1.0f;
            m.roughness = roughness;
            m.emission = glm::vec3(1.0f / kPi);
            builder.add("Box", boxMesh(glm::vec3(-1), glm::vec3(1), Facing::in), builder.addMaterial(m));
            const LitScene lit(builder.finish());
            const ReferenceResult result = light(lit, {{{0.2f, 0.1f, 0.3f}, {0, 1, 0}, 0}}, 100'000);
            const ProbeLight& p = result.probes[0];
            // reflectance lies between F0 and what Schlick adds at grazing angles (mean over cosines: 1/21 of the rest)
            QVERIFY(double(p.indirectError.x) <= 0.002 * double(p.indirect.x));
            QVERIFY2(double(p.indirect.x) >= 0.99 && double(p.indirect.x) <= 1.25,
                     qPrintable(QString("roughness %1: %2").arg(double(roughness)).arg(double(p.indirect.x))));
            QVERIFY(std::abs(double(p.direct.x) - 1.0) <= 5.0 * double(p.directError.x) + 1e-5);
        }
    }

    void lampsInManyPlaces() // 40 lamps: the flat choice among them agrees with one lamp at a time
    {
        const auto room = [](int only) {
            SceneBuilder builder("many");
            builder.add("Room", boxMesh(glm::vec3(-2), glm::vec3(2), Facing::in),
                        builder.addMaterial("g", glm::vec3(0.5f)));
            for (int i = 0; i < 40; ++i) {
                const glm::vec3 p(-1.5f + 0.4f * float(i % 8), 1.0f, -1.5f + 0.6f * float(i / 8));
                const bool isOn = only < 0 || i % 4 == only;
                builder.addPoint("L" + std::to_string(i), p, glm::vec3(isOn ? float(1 + i % 7) : 0.0f));
            }
            return builder.finish();
        };
        const std::vector<ProbePoint> probe{{{0.3f, -2, 0.4f}, {0, 1, 0}, 0}};
        const ProbeLight all = light(LitScene(room(-1)), probe, 60'000).probes[0];
        double sum = 0.0, variance = 0.0;
        for (int part = 0; part < 4; ++part) { // ten lamps each: chosen by distance
            const ProbeLight p = light(LitScene(room(part)), probe, 60'000).probes[0];
            sum += double(p.indirect.x);
            variance += double(p.indirectError.x) * double(p.indirectError.x);
        }
        const double error = std::sqrt(variance + double(all.indirectError.x) * double(all.indirectError.x));
        QVERIFY(error <= 0.01 * sum);
        QVERIFY2(std::abs(double(all.indirect.x) - sum) <= 4.9 * error,
                 qPrintable(QString("%1 and %2 +- %3").arg(double(all.indirect.x)).arg(sum).arg(error)));
    }

    void seedsAgree()
    {
        const LitScene lit(cavityL(0.6f));
        const std::vector<ProbePoint> probes = probesAt(facePoints(*lit.scene, 200, 5));
        const ReferenceResult a = light(lit, probes, 4096, 1), b = light(lit, probes, 4096, 2);
        RunningMean squares;
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const double d = double(a.probes[i].indirect.x - b.probes[i].indirect.x);
            const double e = std::hypot(double(a.probes[i].indirectError.x), double(b.probes[i].indirectError.x));
            QVERIFY(d != 0.0);
            QVERIFY2(std::abs(d) <= 6.5 * e, qPrintable(QString("probe %1: %2 sigma").arg(i).arg(d / e)));
            squares.add(d * d / (e * e));
        }
        // the errors told are the errors made: z^2 averages 1 (batches of 64: Student's t lifts it by 3 %)
        QVERIFY2(std::abs(squares.mean() - 1.03) <= 4.9 * squares.standardError(),
                 qPrintable(QString::number(squares.mean())));
    }

    void sameBitsOnAnyThreads()
    {
        const LitScene lit(furnaceBox(0.5f));
        const std::vector<ProbePoint> probes = probesAt(facePoints(*lit.scene, 40, 6));
        const ReferenceResult one = light(lit, probes, 640, 3, {}, 1);
        for (const int threads : {2, 5}) {
            const ReferenceResult more = light(lit, probes, 640, 3, {}, threads);
            QCOMPARE(more.paths, one.paths);
            QCOMPARE(more.finished, probes.size());
            QVERIFY(std::memcmp(more.probes.data(), one.probes.data(), probes.size() * sizeof(ProbeLight)) == 0);
        }
        // a probe's light is its own affair: alone it comes out the same
        const ReferenceResult alone = light(lit, {probes[7]}, 640, 3);
        QVERIFY(std::memcmp(alone.probes.data(), &one.probes[7], sizeof(ProbeLight)) == 0);
    }

    void adaptiveMeetsItsTarget() // over all probes, at a part of the whole's cost; the same bits on any threads
    {
        const LitScene lit(cavityL(0.6f));
        const std::vector<ProbePoint> probes = probesAt(facePoints(*lit.scene, 60, 7));
        ReferenceJob job;
        job.paths = 65'536;
        job.targetError = 0.02f;
        Workers one(1), three(3);
        const ReferenceResult a = referenceIlluminance(*lit.rays, *lit.lights, {}, probes, job, one, {});
        const ReferenceResult b = referenceIlluminance(*lit.rays, *lit.lights, {}, probes, job, three, {});
        QVERIFY(std::memcmp(a.probes.data(), b.probes.data(), probes.size() * sizeof(ProbeLight)) == 0);
        QVERIFY2(a.paths == b.paths && a.paths < 60 * 65'536 / 4, qPrintable(QString::number(a.paths)));
        QCOMPARE(a.finished, probes.size());
        QCOMPARE(a.capped, std::size_t(0));
        RunningMean mean, squares;
        for (const ProbeLight& p : a.probes) {
            mean.add(double(p.indirect.x));
            squares.add(double(p.indirectError.x) * double(p.indirectError.x));
        }
        const double rms = std::sqrt(squares.mean()) / mean.mean();
        QVERIFY2(rms <= 0.02 && rms >= 0.01, qPrintable(QString::number(rms)));
        for (const ProbeLight& p : a.probes) QVERIFY(double(p.indirectError.x) <= 0.03 * mean.mean());
    }

    void aTargetOutOfReachIsSaid()
    {
        const LitScene lit(cavityL(0.6f));
        ReferenceJob job;
        job.paths = 2048;
        job.targetError = 1e-4f;
        Workers workers(2);
        const std::vector<ProbePoint> probes = probesAt(facePoints(*lit.scene, 10, 7));
        const ReferenceResult r = referenceIlluminance(*lit.rays, *lit.lights, {}, probes, job, workers, {});
        QCOMPARE(r.capped, probes.size());
        QCOMPARE(r.leastPaths, std::uint64_t(2048));
        QCOMPARE(r.finished, probes.size());
    }

    void stoppedRunsGoOnToTheSameBits_data()
    {
        QTest::addColumn<float>("target");
        QTest::newRow("all paths") << 0.0f;
        QTest::newRow("to a target") << 0.02f;
    }
    void stoppedRunsGoOnToTheSameBits() // however often they are stopped, on other thread counts
    {
        QFETCH(float, target);
        const LitScene lit(cavityL(0.6f));
        const std::vector<ProbePoint> probes = probesAt(facePoints(*lit.scene, 30, 11));
        ReferenceJob job;
        job.paths = 4096;
        job.targetError = target;
        Workers two(2), three(3);
        const ReferenceResult whole = referenceIlluminance(*lit.rays, *lit.lights, {}, probes, job, two, {});
        ReferenceState state;
        ReferenceResult part;
        int rounds = 0;
        for (; rounds < 1000 && (rounds == 0 || part.finished < probes.size()); ++rounds) {
            std::stop_source stop;
            int ended = 0;
            std::mutex mutex;
            part = continueReference(*lit.rays, *lit.lights, {}, probes, job, state, rounds % 2 ? two : three,
                                     stop.get_token(), [&](double) {
                                         std::lock_guard lock(mutex);
                                         if (++ended == 7 + rounds) stop.request_stop();
                                     });
        }
        QVERIFY2(rounds >= 3, qPrintable(QString("%1 rounds").arg(rounds)));
        QCOMPARE(part.paths, whole.paths);
        QVERIFY(std::memcmp(part.probes.data(), whole.probes.data(), probes.size() * sizeof(ProbeLight)) == 0);
    }

    void fewerPathsAreAStartForMore()
    {
        const LitScene lit(cavityL(0.6f));
        const std::vector<ProbePoint> probes = probesAt(facePoints(*lit.scene, 20, 12));
        ReferenceJob few, more;
        few.paths = 192; // an odd number of batches
        more.paths = 1024;
        Workers workers(2);
        ReferenceState state;
        static_cast<void>(continueReference(*lit.rays, *lit.lights, {}, probes, few, state, workers, {}));
        const ReferenceResult on = continueReference(*lit.rays, *lit.lights, {}, probes, more, state, workers, {});
        const ReferenceResult anew = referenceIlluminance(*lit.rays, *lit.lights, {}, probes, more, workers, {});
        QVERIFY(std::memcmp(on.probes.data(), anew.probes.data(), probes.size() * sizeof(ProbeLight)) == 0);
    }

    void stopsSoonAndSaysHowFar()
    {
        const LitScene lit(cavityL(0.6f));
        const std::vector<ProbePoint> probes = probesAt(facePoints(*lit.scene, 200, 8));
        ReferenceJob job;
        job.paths = 1 << 14;
        Workers workers(2);
        std::stop_source stop;
        QElapsedTimer since;
        const ReferenceResult part = referenceIlluminance(*lit.rays, *lit.lights, {}, probes, job, workers,
                                                          stop.get_token(), [&](double fraction) {
                                                              if (fraction < 0.1 || stop.stop_requested()) return;
                                                              stop.request_stop();
                                                              since.start();
                                                          });
        QVERIFY2(since.elapsed() <= 100, qPrintable(QString("%1 ms after the stop").arg(since.elapsed())));
        QVERIFY(part.finished >= 10 && part.finished < 40);
        QCOMPARE(part.probes.size(), probes.size());
        const ReferenceResult whole = light(lit, {probes.begin(), probes.begin() + 5}, job.paths);
        QVERIFY(std::memcmp(part.probes.data(), whole.probes.data(), 5 * sizeof(ProbeLight)) == 0);
        stop = {};
        stop.request_stop();
        const ReferenceResult none =
            referenceIlluminance(*lit.rays, *lit.lights, {}, probes, job, workers, stop.get_token());
        QCOMPARE(none.finished, std::size_t(0));
    }

    void mixIsLinear() // twice the light, twice the result to the bit; off is off
    {
        const LitScene lit(furnaceBox(0.5f));
        const std::vector<ProbePoint> probes = probesAt(facePoints(*lit.scene, 5, 9));
        const ReferenceResult once = light(lit, probes, 128), twice = light(lit, probes, 128, 1, {glm::vec3(2, 1, 0)});
        for (std::size_t i = 0; i < probes.size(); ++i) {
            QCOMPARE(twice.probes[i].indirect.x, 2.0f * once.probes[i].indirect.x);
            QCOMPARE(twice.probes[i].direct.x, 2.0f * once.probes[i].direct.x);
            QCOMPARE(twice.probes[i].indirect.y, once.probes[i].indirect.y);
            QCOMPARE(twice.probes[i].direct.z, 0.0f);
            QCOMPARE(twice.probes[i].indirect.z, 0.0f);
        }
    }

    void scaleChangesNothing() // a scene 2^k times as large with the same luminances has the same light
    {
        std::vector<double> found;
        for (const float scale : {1.0f / 8192.0f, 1.0f, 65536.0f}) {
            const LitScene lit(furnaceBox(0.5f, 1.0f, glm::vec3(2.0f * scale)));
            const ProbeLight p = light(lit, {{{0.25f * scale, -scale, 0.5f * scale}, {0, 1, 0}, 0}}, 6400).probes[0];
            found.push_back(double(p.indirect.x));
        }
        QVERIFY(std::abs(found[0] / found[1] - 1.0) <= 1e-4);
        QVERIFY(std::abs(found[2] / found[1] - 1.0) <= 1e-4);
    }

    void emptyScenesAreDark()
    {
        const LitScene empty{Scene{}};
        const ReferenceResult none = light(empty, {{{0, 0, 0}, {0, 1, 0}, 0}}, 64);
        QCOMPARE(none.probes[0].direct + none.probes[0].indirect, glm::vec3(0));
        QCOMPARE(light(empty, {}, 64).finished, std::size_t(0));
    }

    void aPathSeesLampsOnlyWhenAsked()
    {
        const LitScene lit(furnaceBox(0.0f, float(kPiD)));
        Rng rng(1, 2, 3);
        const Mix none, mix{{0.5f, 1, 2}};
        const PathWalk plain(*lit.rays, *lit.lights, none), mixed(*lit.rays, *lit.lights, mix);
        QCOMPARE(plain.radiance({0, 0, 0}, {0, 1, 0}, false, 16, rng), glm::vec3(0));
        const glm::vec3 seen = mixed.radiance({0, 0, 0}, {0, 1, 0}, true, 16, rng);
        QVERIFY(glm::length(seen - glm::vec3(0.5f, 1, 2)) <= 1e-5f);
    }
};

QTEST_APPLESS_MAIN(ReferenceTest)
#include "tst_reference.moc"
