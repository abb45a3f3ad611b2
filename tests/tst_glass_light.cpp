// SPDX-License-Identifier: Apache-2.0
// Claims about light by way of glass, for photons and paths each: what a slab lets through, closed form with all its
// inner reflections and Beer's law; a lamp behind a pane and behind a slab; a furnace with glass in it stays one, and
// the luminance in the glass is n^2 times as high; not a lumen is lost; no shape, index or angle hangs or makes a NaN.
#include "core/trace/direct_light.h"
#include "core/trace/light_reach.h"
#include "core/trace/path_walk.h"
#include "tests/glass_scene.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

const double kZ = sidakLimit(60);

void addFloor(SceneBuilder& builder, float half = 3.0f)
{
    builder.add("Floor", quadMesh({-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0}),
                builder.addMaterial("black", glm::vec3(0.0f)));
}

/// A black floor under a wide slab, `kThick` of absorbing glass, and a sun at `deg` from straight above, 1000 lux.
constexpr float kThick = 0.4f;
Scene sunOnSlab(float deg)
{
    SceneBuilder builder("sun on a slab");
    addFloor(builder);
    builder.add("Slab", boxMesh({-3, 1, -3}, {3, 1 + kThick, 3}),
                builder.addGlass("glass", 1.5f, glm::vec3(0.5f), 1.0f));
    const float a = glm::radians(deg);
    builder.addDirectional("Sun", {std::sin(a), -std::cos(a), 0}, glm::vec3(1000));
    return builder.finish();
}

/// A lamp of 100 cd (or a panel of `size` that shines as much straight down) 2 m above a black floor, and glass.
Scene lampOver(float panel, bool isSlab)
{
    SceneBuilder builder("lamp over glass");
    addFloor(builder);
    if (isSlab) { // two sheets without an edge: total reflection there would show mirror images of the lamp
        const int glass = builder.addGlass("glass", 1.5f);
        builder.add("Top", quadMesh({-3, 1.2f, -3}, {0, 0, 6}, {6, 0, 0}), glass);
        builder.add("Bottom", quadMesh({-3, 0.8f, -3}, {6, 0, 0}, {0, 0, 6}), glass);
    } else {
        builder.add("Pane", quadMesh({-3, 1, -3}, {0, 0, 6}, {6, 0, 0}), builder.addPane("pane", {0.9f, 0.5f, 0.0f}));
    }
    if (panel > 0.0f) {
        const float h = 0.5f * panel;
        builder.add("Lamp", quadMesh({-h, 2, -h}, {panel, 0, 0}, {0, 0, panel}),
                    builder.addEmitter("lamp", glm::vec3(100.0f / (panel * panel))));
    } else {
        builder.addPoint("Lamp", {0, 2, 0}, glm::vec3(100.0f));
    }
    return builder.finish();
}

/// Tint per pass, first channel of `lampOver`'s pane.
constexpr double kTint[3] = {double(0.9f), 0.5, 0.0};

/// A furnace of 2 m (every face emits M = 1 and reflects .5: E = 2 at every point) with a clear body in it.
constexpr double kFurnace = 2.0, kN = 1.5;
Scene furnaceWith(Mesh body, float ior = float(kN))
{
    SceneBuilder builder("furnace with glass");
    Material walls;
    walls.metallic = 0.0f;
    walls.baseColor = glm::vec4(0.5f, 0.5f, 0.5f, 1.0f);
    walls.emission = glm::vec3(1.0f / kPi);
    builder.add("Walls", boxMesh(glm::vec3(-1), glm::vec3(1), Facing::in), builder.addMaterial(walls));
    builder.add("Body", std::move(body), builder.addGlass("glass", ior));
    return builder.finish();
}
Mesh block() { return boxMesh({-0.4f, -0.3f, -0.5f}, {0.2f, 0.3f, 0.4f}); }

/// E inside a clear box on one of its sides, in units of E outside: three pairs of cones reach the outside, whatever
/// lies between them is reflected for ever. With n^2 times the luminance in each.
double insideBox()
{
    const double a = std::asin(1.0 / kN);
    return (kPiD + 4.0 * kN * kN * (a - std::sin(a) * std::cos(a))) / kPiD;
}

ProbePoint probe(glm::vec3 p, glm::vec3 n = {0, 1, 0}) { return {p, n, hashName("glass") ^ std::uint64_t(1e6f * p.x)}; }

#define VERIFY_LUX(found, error, expected, relative, what)                                                             \
    QVERIFY2(std::abs(double(found) - (expected)) <= kZ * double(error) + (relative) * (expected) + 1e-12,             \
             qPrintable(QString("%1: %2 +- %3 instead of %4")                                                          \
                            .arg(what)                                                                                 \
                            .arg(double(found), 0, 'g', 8)                                                             \
                            .arg(double(error), 0, 'g', 3)                                                             \
                            .arg(expected, 0, 'g', 8)))

} // namespace

class GlassLightTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void aSlabLetsThrough() // photons of a sun, counted on the floor in its middle
    {
        for (const float deg : {0.0f, 50.0f}) {
            const LitScene lit(sunOnSlab(deg));
            const double a = double(glm::radians(deg)), sine = std::sin(a), bent = std::sqrt(1.0 - sine * sine / 2.25);
            const double through = slabThrough(sine, 1.5, std::pow(0.5, double(kThick) / bent));
            const RunningMean flux = storedFlux(lit, 100'000, 12, 64, [](const Photon& p) {
                return p.position.y < 0.5f && p.normal.y > 0.5f && std::abs(p.position.x) < 0.5f &&
                       std::abs(p.position.z) < 0.5f;
            });
            VERIFY_MEAN(flux, 1000.0 * std::cos(a) * through, kZ, QString("sun at %1").arg(double(deg)));
            QVERIFY(flux.standardError() <= 0.02 * flux.mean());
        }
    }

    void pathsSeeThroughTheSlab() // towards a large lamp behind it, at two angles, and mirrored in its front
    {
        SceneBuilder builder("slab and lamp");
        builder.add("Slab", boxMesh({-9, 0, -9}, {9, kThick, 9}),
                    builder.addGlass("glass", 1.5f, glm::vec3(0.5f), 1.0f));
        builder.add("Lamp", quadMesh({-90, -1, -90}, {0, 0, 180}, {180, 0, 0}),
                    builder.addEmitter("lamp", glm::vec3(7.0f)));
        const LitScene lit(builder.finish());
        const Mix mix;
        const PathWalk walk(*lit.rays, *lit.lights, mix);
        for (const double deg : {0.0, 60.0}) {
            const double sine = std::sin(deg * kPiD / 180.0), bent = std::sqrt(1.0 - sine * sine / 2.25);
            const double inside = std::pow(0.5, double(kThick) / bent), f = fresnelAgain(sine, 1.5);
            const double through = slabThrough(sine, 1.5, inside), back = f + through * f * inside;
            const glm::vec3 down(sine, -std::cos(deg * kPiD / 180.0), 0.0f), up(down.x, -down.y, 0.0f);
            RunningMean seen, mirrored;
            for (std::uint64_t i = 0; i < 200'000; ++i) {
                Rng rng(1, 5, i);
                seen.add(double(walk.radiance({0, 2, 0}, down, true, 64, rng).x));
                mirrored.add(double(walk.radiance({0, -0.5f, 0}, up, true, 64, rng).x));
            }
            VERIFY_MEAN(seen, 7.0 * through, kZ, QString("through at %1").arg(deg));
            VERIFY_MEAN(mirrored, 7.0 * back, kZ, QString("mirrored at %1").arg(deg));
        }
    }

    void aLampBehindAPane() // straight on, tinted; photons carry it, and it is not direct
    {
        const LitScene lit(lampOver(0.0f, false));
        std::vector<ProbePoint> probes;
        for (const float x : {0.0f, 0.7f, 1.9f}) probes.push_back(probe({x, 0, 0.1f}));
        const ReferenceResult r = traceProbes(lit, probes, 6'400);
        QVERIFY(r.causticPhotons > 0);
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const glm::dvec3 to = glm::dvec3(0, 2, 0) - glm::dvec3(probes[i].position);
            const double d = glm::length(to), cosine = 2.0 / d, bare = 100.0 * cosine / (d * d);
            QCOMPARE(r.probes[i].direct, glm::vec3(0.0f));
            for (int c = 0; c < 3; ++c) {
                const double expected = bare * slabThrough(std::sqrt(1.0 - cosine * cosine), 1.5, kTint[c]);
                VERIFY_LUX(r.probes[i].indirect[c], r.probes[i].indirectError[c], expected, 1e-3,
                           QString("point %1").arg(i));
            }
            QVERIFY(double(r.probes[i].indirectError.x) <= 0.08 * double(r.probes[i].indirect.x));
            Rng rng(1, 1, 1);
            QCOMPARE(directIlluminance(*lit.rays, *lit.lights, {}, probes[i].position, {0, 1, 0}, 16, rng),
                     glm::vec3(0));
        }
        // and the photons of a bake, on a disc below the lamp
        const double radius = 0.3;
        double expected = 0.0;
        for (int i = 0; i < 1000; ++i) {
            const double x = radius * std::sqrt((i + 0.5) / 1000.0), d2 = 4.0 + x * x;
            expected += 100.0 * 2.0 / std::pow(d2, 1.5) * slabThrough(x / std::sqrt(d2), 1.5, kTint[0]);
        }
        const RunningMean flux = storedFlux(lit, 100'000, 12, 64, [&](const Photon& p) {
            return p.position.y < 0.5f && p.normal.y > 0.5f && std::hypot(p.position.x, p.position.z) < float(radius);
        });
        VERIFY_MEAN(flux, expected / 1000.0 * kPiD * radius * radius, kZ, "photons");
    }

    void aLampBehindASlab() // at normal incidence each order of inner reflections comes from an image of its own
    {
        const LitScene lit(lampOver(0.0f, true));
        const double t = 0.4, f = fresnelAgain(0.0, 1.5);
        double expected = 0.0;
        for (int k = 0; k < 20; ++k) {
            const double d = 2.0 - double(0.4f) + (2 * k + 1) * t / 1.5;
            expected += 100.0 * (1.0 - f) * (1.0 - f) * std::pow(f, 2 * k) / (d * d);
        }
        const ReferenceResult r = traceProbes(lit, {probe({0, 0, 0})}, 64 * 150);
        VERIFY_LUX(r.probes[0].indirect.x, r.probes[0].indirectError.x, expected, 1e-3, "below the lamp");
        QVERIFY(double(r.probes[0].indirectError.x) <= 0.03 * expected);
        QVERIFY(expected > 1.05 * 25.0 * slabThrough(0.0, 1.5)); // the slab moves the lamp nearer, which shows
    }

    void aPanelBehindAPane() // a large one by paths, a small one by photons: once each
    {
        for (const double size : {1.5, 0.06}) {
            const LitScene lit(lampOver(float(size), false));
            double expected[3] = {0, 0, 0};
            constexpr int kSteps = 300;
            for (int i = 0; i < kSteps; ++i) {
                for (int k = 0; k < kSteps; ++k) {
                    const double x = size * ((i + 0.5) / kSteps - 0.5) - 0.4, z = size * ((k + 0.5) / kSteps - 0.5);
                    const double d2 = x * x + z * z + 4.0, cosine = 2.0 / std::sqrt(d2);
                    for (int c = 0; c < 3; ++c)
                        expected[c] += 100.0 / (kSteps * kSteps) * cosine * cosine / d2 *
                                       slabThrough(std::sqrt(1.0 - cosine * cosine), 1.5, kTint[c]);
                }
            }
            const ReferenceResult r = traceProbes(lit, {probe({0.4f, 0, 0})}, size > 1.0 ? 200'000 : 6'400);
            QCOMPARE(r.causticPhotons > 0, size < 1.0);
            QCOMPARE(r.probes[0].direct, glm::vec3(0.0f));
            for (int c = 0; c < 3; ++c)
                VERIFY_LUX(r.probes[0].indirect[c], r.probes[0].indirectError[c], expected[c], 1e-3,
                           QString("%1 m").arg(size));
            QVERIFY(double(r.probes[0].indirectError.x) <= 0.03 * expected[0]);
        }
    }

    void aFurnaceStaysOne_data()
    {
        QTest::addColumn<int>("shape");
        QTest::newRow("ball") << 0;
        QTest::newRow("block") << 1;
        QTest::newRow("inside out") << 2; // a bubble of air in glass, as seen from the walls
    }
    void aFurnaceStaysOne() // paths: E = 2 on the walls and on the glass, whatever the glass does to single rays
    {
        QFETCH(int, shape);
        const LitScene lit(furnaceWith(
            shape == 1 ? block() : sphereMesh({0.1f, 0, 0}, 0.5f, 24, shape == 2 ? Facing::in : Facing::out)));
        const glm::vec3 glass = shape == 1 ? glm::vec3(-0.1f, 0.3f, 0.05f) : glm::vec3(0.1f, 0.4999f, 0.01f);
        std::vector<ProbePoint> probes{probe({0.2f, -1, 0.1f}), probe({-1, 0.3f, 0.2f}, {1, 0, 0})};
        if (shape != 2) probes.push_back(probe(glass));
        const ReferenceResult r = traceProbes(lit, probes, 60'000, 256);
        for (std::size_t i = 0; i < probes.size(); ++i) {
            const ProbeLight& p = r.probes[i];
            const double error = std::hypot(double(p.directError.x), double(p.indirectError.x));
            VERIFY_LUX(p.direct.x + p.indirect.x, error, kFurnace, 1e-4, QString("probe %1").arg(i));
            QVERIFY(error <= 0.005 * kFurnace);
        }
    }

    void glassIsBrighterInside() // by n^2, in the cones that reach the outside
    {
        const LitScene lit(furnaceWith(block()));
        const std::vector<ProbePoint> probes{probe({-0.1f, 0.3f, 0.05f}, {0, -1, 0}),
                                             probe({-0.4f, 0.1f, 0.05f}, {1, 0, 0})};
        const ReferenceResult r = traceProbes(lit, probes, 100'000, 256);
        for (const ProbeLight& p : r.probes) {
            QCOMPARE(p.direct.x, 0.0f);
            VERIFY_LUX(p.indirect.x, p.indirectError.x, kFurnace * insideBox(), 1e-4, "inside");
            QVERIFY(double(p.indirectError.x) <= 0.005 * kFurnace);
        }
    }

    void aFurnaceOfPhotonsStaysOne() // walls, glass from outside, glass from inside: all their light is known
    {
        const LitScene lit(furnaceWith(block()));
        const double walls = 24.0, glass = areaOf(block());
        // the photon tracer stores no first hit: M from each wall's area, of which M per area meets the glass
        const auto onWall = [](const Photon& p) {
            return std::max({std::abs(p.position.x), std::abs(p.position.y), std::abs(p.position.z)}) > 0.9f;
        };
        const auto isOutside = [](const Photon& p) {
            return glm::dot(p.normal, p.position - glm::vec3(-0.1f, 0, -0.05f)) > 0.0f;
        };
        const RunningMean atWalls = storedFlux(lit, 50'000, 12, 256, onWall);
        VERIFY_MEAN(atWalls, kFurnace * walls - (walls - glass), kZ, "walls");
        const RunningMean outside =
            storedFlux(lit, 50'000, 12, 256, [&](const Photon& p) { return !onWall(p) && isOutside(p); });
        VERIFY_MEAN(outside, kFurnace * glass - glass, kZ, "glass, outside");
        const RunningMean inside =
            storedFlux(lit, 50'000, 12, 256, [&](const Photon& p) { return !onWall(p) && !isOutside(p); });
        VERIFY_MEAN(inside, kFurnace * insideBox() * glass, kZ, "glass, inside");
        QVERIFY(atWalls.standardError() <= 0.005 * atWalls.mean() && inside.standardError() <= 0.01 * inside.mean());
    }

    void notALumenIsLost() // coloured, absorbing glass and a tinted pane in a room
    {
        SceneBuilder builder("room");
        builder.add("Room", boxMesh(glm::vec3(-2), glm::vec3(2), Facing::in),
                    builder.addMaterial("grey", {0.7f, 0.5f, 0.3f}));
        builder.add("Ball", sphereMesh({0.5f, -1, 0}, 0.6f, 16),
                    builder.addGlass("red", 1.6f, {0.9f, 0.2f, 0.0f}, 0.3f));
        builder.add("Pane", quadMesh({-1, -2, -1}, {0, 0, 2}, {0, 3, 0}), builder.addPane("green", {0.3f, 0.9f, 0.4f}));
        builder.addPoint("Lamp", {0.2f, 1, 0.3f}, {100, 80, 60});
        const LitScene lit(builder.finish());
        const auto paths = shootPhotons(lit, 100'000);
        for (int c = 0; c < 3; ++c)
            QVERIFY2(std::abs(paths->ledger.missing()[c]) <= 1e-9 * paths->ledger.emitted[c],
                     qPrintable(QString::number(paths->ledger.missing()[c])));
        QVERIFY(paths->caustic > 0 && paths->ledger.absorbed.x > 0.9 * paths->ledger.emitted.x);
        QVERIFY(paths->ledger.escaped.x <= 1e-4 * paths->ledger.emitted.x);
    }

    void glassOfIndexOneIsAir()
    {
        SceneBuilder builder("nothing");
        addFloor(builder);
        builder.add("Ball", sphereMesh({0, 1, 0}, 0.5f, 16), builder.addGlass("air", 1.0f));
        builder.addPoint("Lamp", {0, 2, 0}, glm::vec3(100));
        const LitScene lit(builder.finish());
        const double radius = 0.3, expected = 100.0 * 2.0 * kPiD * (1.0 - 2.0 / std::hypot(2.0, radius));
        const RunningMean flux = storedFlux(lit, 100'000, 12, 64, [&](const Photon& p) {
            return p.position.y < 0.1f && p.normal.y > 0.5f && std::hypot(p.position.x, p.position.z) < float(radius);
        });
        VERIFY_MEAN(flux, expected, kZ, "below the ball");
    }

    void lightReachesThroughPanesAndIntoGlass() // a closed room lit by the sun through its window alone
    {
        SceneBuilder builder("window");
        const int white = builder.addMaterial("white", glm::vec3(0.8f));
        CellPlan plan;
        plan.xs = {0, 0.3f, 4.0f, 4.3f};
        plan.ys = {0, 0.3f, 1.0f, 2.0f, 3.0f, 3.3f};
        plan.zs = {0, 0.3f, 1.0f, 3.0f, 4.0f, 4.3f};
        plan.airOutside = true;
        plan.isAir = [](glm::vec3 p) {
            const bool isRoom = p.x > 0.3f && p.x < 4.0f && p.y > 0.3f && p.y < 3.0f && p.z > 0.3f && p.z < 4.0f;
            return isRoom || (p.x < 0.3f && p.y > 1.0f && p.y < 2.0f && p.z > 1.0f && p.z < 3.0f);
        };
        plan.materialOf = [=](glm::vec3, glm::vec3) { return white; };
        builder.add("House", cellShell(plan));
        builder.add("Window", quadMesh({0.15f, 1, 1}, {0, 0, 2}, {0, 1, 0}), builder.addPane("pane"));
        builder.add("Ball", sphereMesh({2, 0.9f, 2}, 0.5f, 12), builder.addGlass("glass", 1.5f));
        builder.add("Heart", sphereMesh({2, 0.9f, 2}, 0.2f, 8), white);
        builder.addDirectional("Sun", {1.0f, -0.7f, 0.1f}, glm::vec3(50'000));
        const LitScene lit(builder.finish());
        Workers workers(2);
        const auto reach = LightReach::find(*lit.rays, *lit.lights, workers, {});
        double room = 0.0, heart = 0.0, inside = 0.0;
        for (const ReachedFacet& f : reach->facets()) {
            const double area = 0.5 * double(glm::length(glm::cross(f.b - f.a, f.c - f.a)));
            const std::string& node = lit.scene->instances[lit.rays->triangle(f.side / 2).instance].node;
            if (node == "House" && f.a.x > 0.29f && f.a.x < 4.01f && f.a.y > 0.29f && f.a.y < 3.01f && f.a.z > 0.29f &&
                f.a.z < 4.01f)
                room += area;
            if (node == "Heart") heart += area;
            if (node == "Ball" && glm::dot(f.normal, f.a - glm::vec3(2, 0.9f, 2)) < 0.0f) inside += area;
        }
        const double all = 2 * (3.7 * 2.7 + 3.7 * 3.7 + 2.7 * 3.7) - 2.0;
        QVERIFY2(room >= 0.98 * all, qPrintable(QString("%1 of %2").arg(room).arg(all)));
        QVERIFY2(heart >= 0.95 * areaOf(sphereMesh({2, 0.9f, 2}, 0.2f, 8)), qPrintable(QString::number(heart)));
        QVERIFY2(inside >= 0.95 * areaOf(sphereMesh({2, 0.9f, 2}, 0.5f, 12)), qPrintable(QString::number(inside)));
        QCOMPARE(samplePoints(*lit.rays, *lit.lights, *reach, 500, 1).size(), std::size_t(500));
        const auto paths = shootPhotons(lit, 20'000);
        // the sun aims at its window: 3,300 without, 19,400 with
        QVERIFY2(paths->caustic > 10'000, qPrintable(QString::number(paths->caustic)));
    }

    void extremesEndAndStayFinite_data()
    {
        QTest::addColumn<float>("ior");
        QTest::addColumn<int>("shape");
        for (const float ior : {0.0f, 0.5f, 1.0f, 1.5f, 1000.0f}) {
            for (int shape = 0; shape < 5; ++shape)
                QTest::addRow("ior %g shape %d", double(ior), shape) << ior << shape;
        }
    }
    void extremesEndAndStayFinite() // nested, open, flat on a wall, around the lamp, and rays that graze
    {
        QFETCH(float, ior);
        QFETCH(int, shape);
        SceneBuilder builder("extreme");
        builder.add("Room", boxMesh(glm::vec3(-2), glm::vec3(2), Facing::in),
                    builder.addMaterial("white", glm::vec3(1.0f)));
        const int glass = builder.addGlass("glass", ior, {0.0f, 1.0f, 0.5f}, shape == 0 ? 1e-38f : 0.2f);
        const int clear = builder.addGlass("clear", ior), pane = builder.addPane("pane", glm::vec3(1.0f), ior);
        glm::vec3 lamp(0.3f, 1.5f, 0.2f);
        if (shape == 0) {
            builder.add("Outer", sphereMesh({0, 0, 0}, 1.0f, 12), glass);
            builder.add("Inner", sphereMesh({0, 0, 0}, 0.5f, 12), clear);
            builder.add("Core", sphereMesh({0, 0, 0}, 0.2f, 8), builder.addMaterial("grey", glm::vec3(0.5f)));
        } else if (shape == 1) { // a sheet that says it is solid, and half a ball
            builder.add("Sheet", quadMesh({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), glass);
            Mesh half = sphereMesh({0, -1, 0}, 0.5f, 12);
            half.triangles.resize(half.triangles.size() / 2);
            builder.add("Half", std::move(half), clear);
        } else if (shape == 2) { // in the very plane of the floor, and panes back to back
            builder.add("Film", quadMesh({-1, -2, -1}, {0, 0, 2}, {2, 0, 0}), pane);
            builder.add("Panes", quadMesh({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), pane);
            builder.add("Panes 2", quadMesh({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}), pane);
        } else if (shape == 3) { // a lamp that is cast into a block: most of its light never leaves
            builder.add("Block", boxMesh(glm::vec3(-1), glm::vec3(1)), clear);
            lamp = {0.1f, 0.2f, 0.3f};
        } else { // the lamp in the plane of a pane
            builder.add("Pane", quadMesh({-1, 1.5f, -1}, {0, 0, 2}, {2, 0, 0}), pane);
            builder.add("Mirror", quadMesh({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}),
                        builder.addMetal("mirror", glm::vec3(1), 0.0f));
        }
        builder.addPoint("Lamp", lamp, glm::vec3(100));
        const LitScene lit(builder.finish());
        const auto paths = shootPhotons(lit, 4096);
        for (const Photon& p : paths->photons) {
            QVERIFY(isFinite(p.position) && isFinite(p.flux) && isFinite(p.toLight) && isFinite(p.normal));
            QVERIFY(glm::all(glm::greaterThanEqual(p.flux, glm::vec3(0.0f))));
        }
        for (int c = 0; c < 3; ++c) QVERIFY(std::abs(paths->ledger.missing()[c]) <= 1e-9 * paths->ledger.emitted[c]);
        const std::vector<ProbePoint> probes{probe({0.2f, -2, 0.1f}), probe({0.3f, 0, 0.2f}),
                                             probe({0, 0.2f, 0}, {0, -1, 0})};
        const ReferenceResult r = traceProbes(lit, probes, 128, 1024, false);
        QCOMPARE(r.finished, probes.size());
        std::vector<CatchPoint> discs;
        for (const ProbePoint& p : probes) discs.push_back({p.position, p.normal, 0.1f});
        std::vector<CausticSums> sums(probes.size());
        Workers workers(2);
        const CausticLamps lamps(*lit.rays, *lit.lights, {});
        QVERIFY(addCausticRound(*lit.rays, lamps, {1, 1024, 4096}, 0, discs, sums, workers, {}));
        for (const CausticSums& s : sums) {
            for (int c = 0; c < 3; ++c) QVERIFY(s.mean()[c] >= 0.0 && std::isfinite(s.mean()[c]));
        }
        for (const ProbeLight& p : r.probes) {
            QVERIFY(isFinite(p.direct) && isFinite(p.indirect) && isFinite(p.indirectError));
            QVERIFY(glm::all(glm::greaterThanEqual(p.indirect, glm::vec3(0.0f))));
        }
    }
};

QTEST_APPLESS_MAIN(GlassLightTest)
#include "tst_glass_light.moc"
