// SPDX-License-Identifier: Apache-2.0
// Claims about emitters: their flux is the closed form's, photons carry exactly that flux where it belongs, samples
// towards a point and the densities told for them agree, dim lamps keep their share, nothing odd gives a NaN.
#include "core/scene/analytic_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/trace/material.h"
#include "core/trace/photon_tracer.h"
#include "tests/light_helpers.h"
#include <limits>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
const double kZ = sidakLimit(200); // claims by z-test in this file, roughly

double relative(double found, double expected) { return std::abs(found / expected - 1.0); }

/// A quad of 2 x 1 m at height 1, facing up, so that bounds have a size; black.
SceneBuilder withFloor(const std::string& name)
{
    SceneBuilder builder(name);
    builder.add("Floor", quadMesh({-1, 0, -0.5f}, {0, 0, 1}, {2, 0, 0}), builder.addMaterial("black", glm::vec3(0)));
    return builder;
}

Image checkImage() // 4 x 4, three of sixteen texels lit
{
    Image image;
    image.width = image.height = 4;
    image.rgba.assign(64, 0);
    for (const std::size_t i : {0u, 6u, 9u}) image.rgba[4 * i] = 255;
    for (std::size_t i = 0; i < 16; ++i) image.rgba[4 * i + 3] = 255;
    return image;
}

Scene texturedLamp()
{
    SceneBuilder builder("textured lamp");
    Material m;
    m.name = "screen";
    m.metallic = 0.0f;
    m.baseColor = glm::vec4(0, 0, 0, 1);
    m.emission = glm::vec3(100.0f);
    m.emissionTexture.image = builder.addImage(checkImage());
    m.emissionTexture.smooth = false;
    builder.add("Screen", texturedQuadMesh({0, 0, 0}, {2, 0, 0}, {0, 1, 0}), builder.addMaterial(m));
    return builder.finish();
}

/// Point, spot, sun, a square and a two-sided triangle in one group.
Scene mixedGroup()
{
    SceneBuilder builder = withFloor("mixed");
    builder.addPoint("P", {0, 2, 0}, glm::vec3(5, 4, 3), "all");
    builder.addSpot("S", {1, 2, 0}, {1, 0, 0}, glm::vec3(20, 30, 40), 0.2f, 0.5f, "all");
    builder.addDirectional("D", {0.3f, -1, 0.2f}, glm::vec3(2), "all");
    builder.add("Q", quadMesh({-1, 3, 0}, {1, 0, 0}, {0, 0, 1}), builder.addEmitter("q", glm::vec3(7, 1, 0)), "all");
    Material both;
    both.metallic = 0.0f;
    both.emission = glm::vec3(3, 2, 1);
    both.doubleSided = true;
    builder.add("T", quadMesh({2, 0, 0}, {0, 1, 0}, {0, 0, 0.5f}), builder.addMaterial(both), "all");
    return builder.finish();
}

} // namespace

class LightSamplerTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void sidakLimitsAreKnown()
    {
        QVERIFY(std::abs(sidakLimit(1) - 4.892) <= 1e-3);
        QVERIFY(std::abs(sidakLimit(1, 1e-9) - 6.109) <= 1e-3);
    }

    void pointFlux()
    {
        SceneBuilder builder = withFloor("point");
        builder.addPoint("P", {0, 1, 0}, glm::vec3(100, 10, 1));
        const LitScene lit(builder.finish());
        QVERIFY(relative(lit.lights->groupFlux(0).x, 400.0 * kPiD) <= 1e-6);
        QVERIFY(relative(lit.lights->groupFlux(0).z, 4.0 * kPiD) <= 1e-6);
    }

    void spotFlux_data()
    {
        QTest::addColumn<double>("inner");
        QTest::addColumn<double>("outer");
        for (const auto& [i, o] : std::vector<std::pair<double, double>>{
                 {0.0, 0.785398}, {0.3, 0.6}, {0.5, 0.5}, {0.0, 0.01}, {1.2, 1.5707963}, {0.0, 0.0}}) {
            QTest::addRow("%g to %g", i, o) << i << o;
        }
    }
    void spotFlux() // the closed form against the integral of the fall-off itself, and photons against both
    {
        QFETCH(double, inner);
        QFETCH(double, outer);
        SceneBuilder builder = withFloor("spot");
        builder.addSpot("S", {0, 1, 0}, {0.2f, -1, 0.1f}, glm::vec3(50), 0.0f, 1.0f);
        Scene scene = builder.finish();
        scene.lights[0].innerCone = float(inner); // coinciding cones too, which files may hold
        scene.lights[0].outerCone = float(outer);
        const LitScene lit(std::move(scene));
        const double ci = std::cos(inner), co = std::cos(outer);
        double integral = 2.0 * kPiD * (1.0 - ci);
        const int steps = 20'000;
        for (int i = 0; i < steps; ++i) { // KHR_lights_punctual: clamp((cos - cosOuter) / (cosInner - cosOuter))^2
            const double t = (i + 0.5) / steps;
            integral += 2.0 * kPiD * t * t * (ci - co) / steps;
        }
        const double flux = lit.lights->groupFlux(0).x;
        if (outer == 0.0) {
            QCOMPARE(flux, 0.0);
            return;
        }
        QVERIFY2(relative(flux, 50.0 * integral) <= 1e-5, qPrintable(QString::number(flux / integral, 'g', 8)));

        const glm::vec3 axis = lit.scene->lights[0].travel;
        RunningMean inside, cosine;
        for (std::uint64_t i = 0; i < 200'000; ++i) {
            Rng rng(1, 2, i);
            EmittedPhoton photon;
            QVERIFY(lit.lights->emit(0, rng, photon));
            QVERIFY(relative(photon.flux.x, flux) <= 1e-5);
            const double off = 0.5 * glm::dot(axis - photon.travel, axis - photon.travel); // 1 - cos
            QVERIFY(off <= (1.0 - co) * (1.0 + 1e-3) + 1e-7);
            inside.add(off <= 1.0 - ci ? 1.0 : 0.0);
            cosine.add(off);
        }
        if (inner > 0.0 && inner < outer) {
            VERIFY_MEAN(inside, 2.0 * kPiD * (1.0 - ci) / integral, kZ, "share inside the inner cone");
        }
        double moment = kPiD * (1.0 - ci) * (1.0 - ci);
        for (int i = 0; i < steps; ++i) {
            const double t = (i + 0.5) / steps;
            moment += 2.0 * kPiD * t * t * (1.0 - co - t * (ci - co)) * (ci - co) / steps;
        }
        VERIFY_MEAN(cosine, moment / integral, kZ, "mean of 1 - cos");
    }

    void directionalFluxCoversTheScene() // E times the disc; photons land with E cos per area everywhere
    {
        SceneBuilder builder = withFloor("sun");
        const glm::vec3 travel = glm::normalize(glm::vec3(0.5f, -1.0f, 0.25f));
        builder.addDirectional("Sun", travel, glm::vec3(1000));
        const LitScene lit(builder.finish());
        const double radius = 0.5 * std::sqrt(5.0);
        const double flux = lit.lights->groupFlux(0).x;
        QVERIFY(relative(flux, 1000.0 * kPiD * radius * radius) <= 1e-4);
        RunningMean left, right;
        for (std::uint64_t i = 0; i < 100'000; ++i) {
            Rng rng(1, 2, i);
            EmittedPhoton photon;
            QVERIFY(lit.lights->emit(0, rng, photon));
            Hit hit;
            const bool landed = lit.rays->intersect(photon.position, photon.travel, kFar, hit);
            QVERIFY(!landed || glm::dot(photon.position, travel) < -radius);
            left.add(landed && hit.position.x < 0.0f ? photon.flux.x : 0.0);
            right.add(landed && hit.position.x >= 0.0f ? photon.flux.x : 0.0);
        }
        const double expected = 1000.0 * double(-travel.y);
        VERIFY_MEAN(left, expected, kZ, "one half of the floor");
        VERIFY_MEAN(right, expected, kZ, "the other half");
    }

    void surfaceFlux() // pi L A, twice that from a two-sided material, in a mirrored and scaled place too
    {
        SceneBuilder builder("panels");
        const int one = builder.addEmitter("one", glm::vec3(10, 20, 30));
        Material both;
        both.metallic = 0.0f;
        both.emission = glm::vec3(10);
        both.doubleSided = true;
        const int two = builder.addMaterial(both);
        builder.add("A", quadMesh({0, 0, 0}, {2, 0, 0}, {0, 3, 0}), one);
        builder.add("B", quadMesh({0, 0, 5}, {2, 0, 0}, {0, 3, 0}), two);
        const int mesh = builder.addMesh(quadMesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), one);
        glm::mat4 place(1.0f);
        place[0].x = -2.0f;
        place[1].y = 3.0f;
        builder.place("C", mesh, place);
        const LitScene lit(builder.finish());
        QVERIFY(relative(lit.lights->groupFlux(0).y, kPiD * 20.0 * 6.0) <= 1e-6);
        QVERIFY(relative(lit.lights->groupFlux(1).y, kPiD * 10.0 * 12.0) <= 1e-6);
        QVERIFY(relative(lit.lights->groupFlux(2).y, kPiD * 20.0 * 6.0) <= 1e-6);
        for (int group = 0; group < 3; ++group) {
            RunningMean forward, squared;
            for (std::uint64_t i = 0; i < 50'000; ++i) {
                Rng rng(3, 4, i);
                EmittedPhoton photon;
                QVERIFY(lit.lights->emit(group, rng, photon));
                QVERIFY(std::abs(glm::dot(photon.side, photon.travel) - std::abs(photon.travel.z)) <= 1e-5f);
                forward.add(photon.travel.z > 0.0f ? 1.0 : 0.0);
                squared.add(double(photon.travel.z) * double(photon.travel.z)); // cosine law: mean 1/2
            }
            VERIFY_MEAN(forward, group == 1 ? 0.5 : 1.0, kZ, QString("front of %1").arg(group));
            VERIFY_MEAN(squared, 0.5, kZ, "cosine law");
        }
    }

    void texturedFlux() // three of sixteen texels shine; photons start there only and carry all of it
    {
        const LitScene lit(texturedLamp());
        const double flux = kPiD * 100.0 * 2.0 * 3.0 / 16.0;
        QVERIFY2(relative(lit.lights->groupFlux(0).x, flux) <= 0.01,
                 qPrintable(QString::number(lit.lights->groupFlux(0).x)));
        QCOMPARE(lit.lights->groupFlux(0).y, 0.0f);
        RunningMean carried, corner;
        for (std::uint64_t i = 0; i < 100'000; ++i) {
            Rng rng(5, 6, i);
            EmittedPhoton photon;
            const bool shone = lit.lights->emit(0, rng, photon);
            carried.add(shone ? photon.flux.x : 0.0);
            const bool inCorner = photon.position.x < 0.5f && photon.position.y > 0.75f; // texel 0: top left
            corner.add(shone && inCorner ? photon.flux.x : 0.0);
        }
        VERIFY_MEAN(carried, flux, kZ, "all of it");
        VERIFY_MEAN(corner, flux / 3.0, kZ, "the top left texel");
    }

    void texturedFluxOfOddShapes() // a texture turned, tiled and smooth: the mean still holds to a percent
    {
        Scene scene = texturedLamp();
        scene.materials[0].emissionTexture.smooth = true;
        scene.materials[0].emissionTexture.rotation = 0.4f;
        scene.materials[0].emissionTexture.scale = {3.3f, 1.7f};
        const LitScene lit(std::move(scene));
        RunningMean carried;
        for (std::uint64_t i = 0; i < 200'000; ++i) {
            Rng rng(23, 24, i);
            EmittedPhoton photon;
            carried.add(lit.lights->emit(0, rng, photon) ? photon.flux.x : 0.0);
        }
        QVERIFY2(relative(lit.lights->groupFlux(0).x, carried.mean()) <= 0.01,
                 qPrintable(QString("%1, photons %2").arg(double(lit.lights->groupFlux(0).x)).arg(carried.mean())));
    }

    void photonsCarryTheGroupsFlux() // whatever the group is made of: the choice among emitters is paid back
    {
        const LitScene lit(mixedGroup());
        QCOMPARE(lit.lights->emitters().size(), std::size_t(5));
        QCOMPARE(lit.lights->inGroup(0).size(), std::size_t(5));
        RunningMean carried[3];
        for (std::uint64_t i = 0; i < 200'000; ++i) {
            Rng rng(7, 8, i);
            EmittedPhoton photon;
            QVERIFY(lit.lights->emit(0, rng, photon));
            QVERIFY(std::abs(glm::length(photon.travel) - 1.0f) <= 1e-5f);
            for (int c = 0; c < 3; ++c) carried[c].add(photon.flux[c]);
        }
        const glm::vec3 flux = lit.lights->groupFlux(0);
        for (int c = 0; c < 3; ++c) VERIFY_MEAN(carried[c], double(flux[c]), kZ, QString("channel %1").arg(c));
    }

    void dimLampKeepsItsShare() // a million to one in a joined group: a twentieth of the photons all the same
    {
        SceneBuilder builder = withFloor("dim");
        builder.addPoint("Bright", {-1, 1, 0}, glm::vec3(1e6f), "both");
        builder.addPoint("Dim", {1, 1, 0}, glm::vec3(1.0f), "both");
        const LitScene lit(builder.finish());
        RunningMean share, flux;
        for (std::uint64_t i = 0; i < 100'000; ++i) {
            Rng rng(9, 10, i);
            EmittedPhoton photon;
            QVERIFY(lit.lights->emit(0, rng, photon));
            const bool isDim = photon.position.x > 0.0f;
            share.add(isDim ? 1.0 : 0.0);
            flux.add(isDim ? photon.flux.x : 0.0);
        }
        VERIFY_MEAN(share, 0.05, kZ, "photons from the dim lamp");
        VERIFY_MEAN(flux, 4.0 * kPiD, kZ, "lumen from the dim lamp");
    }

    void pointSourceFluxPerFace() // A3: a black room's faces get I times their solid angle
    {
        const LitScene lit(pointSourceRoom());
        const glm::dvec3 low(0.0), high(4.0, 3.0, 4.0), source(2.0, 2.9, 2.0);
        std::array<RunningMean, 6> faces;
        for (std::uint64_t i = 0; i < 400'000; ++i) {
            Rng rng(11, 12, i);
            EmittedPhoton photon;
            Hit hit;
            QVERIFY(lit.lights->emit(0, rng, photon));
            QVERIFY(lit.rays->intersect(photon.position, photon.travel, kFar, hit));
            for (std::size_t f = 0; f < 6; ++f) {
                const float side = hit.normal[int(f / 2)];
                faces[f].add((f % 2 == 0 ? side > 0.5f : side < -0.5f) ? photon.flux.x : 0.0);
            }
        }
        for (std::size_t f = 0; f < 6; ++f) {
            const double omega = boxSideSolidAngle(source, low, high, int(f / 2), f % 2 == 1);
            VERIFY_MEAN(faces[f], 1000.0 * omega, sidakLimit(6), QString("face %1").arg(f));
        }
    }

    void areaSourceFluxPerFace() // A3 with a panel: shares of 10000 lm from the configuration factors of the faces
    {
        const LitScene lit(areaSourceRoom());
        // floor and one wall, z up: averages of Lambert's formula over the panel
        double floorShare = 0.0, wallShare = 0.0;
        const int n = 40;
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                const glm::dvec3 p(1.5 + (i + 0.5) / n, 1.5 + (j + 0.5) / n, 3.0), down(0, 0, -1);
                floorShare += configurationFactor(p, down, {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}) / (n * n);
                wallShare += configurationFactor(p, down, {{0, 0, 0}, {0, 4, 0}, {0, 4, 3}, {0, 0, 3}}) / (n * n);
            }
        }
        QVERIFY(std::abs(floorShare + 4.0 * wallShare - 1.0) <= 1e-6);
        std::array<RunningMean, 5> faces; // floor, walls
        for (std::uint64_t i = 0; i < 400'000; ++i) {
            Rng rng(13, 14, i);
            EmittedPhoton photon;
            Hit hit;
            QVERIFY(lit.lights->emit(0, rng, photon));
            QVERIFY(lit.rays->intersect(photon.position, photon.travel, kFar, hit));
            const glm::vec3 m = hit.normal;
            const std::array<bool, 5> on{m.y > 0.5f, m.x > 0.5f, m.x<-0.5f, m.z> 0.5f, m.z < -0.5f};
            for (std::size_t f = 0; f < 5; ++f) faces[f].add(on[f] ? photon.flux.x : 0.0);
        }
        VERIFY_MEAN(faces[0], 10000.0 * floorShare, sidakLimit(5), "floor");
        for (std::size_t f = 1; f < 5; ++f) VERIFY_MEAN(faces[f], 10000.0 * wallShare, sidakLimit(5), "wall");
    }

    void samplesAndDensitiesAgree() // what sample() picked, a ray finds, with the density pdf() tells
    {
        const LitScene lit(mixedGroup());
        int seen = 0;
        for (std::size_t e = 0; e < lit.lights->emitters().size(); ++e) {
            if (lit.lights->emitters()[e].kind != Emitter::Kind::surface) continue;
            for (std::uint64_t i = 0; i < 5000; ++i) {
                Rng rng(15, e, i);
                const glm::vec3 p(4.0f * rng.uniform() - 1.0f, 0.1f + 2.0f * rng.uniform(), rng.uniform() - 0.5f);
                const glm::vec2 u(rng.uniform(), rng.uniform());
                LightSample s;
                if (!lit.lights->sample(int(e), p, u, s)) continue;
                Hit hit;
                if (!lit.rays->intersect(p, s.toLight, kFar, hit)) continue; // grazed an edge
                if (lit.lights->emitterOf(hit.triangle) != int(e)) continue; // another stands between
                ++seen;
                QVERIFY(relative(lit.lights->pdf(p, hit), s.pdf) <= 1e-3);
                QVERIFY(glm::length(hit.position - s.end) <= 1.1f * lit.rays->offset() + 1e-5f);
                QVERIFY(!lit.rays->isBlocked(p, s.end));
                QVERIFY(glm::length(surfaceAt(*lit.rays, hit).emission - s.radiance) <= 1e-6f);
                QVERIFY(relative(glm::length(s.end - p), s.distance) <= 1e-5);
            }
        }
        QVERIFY(seen > 5000);
    }

    void backsOfPanelsAreDark() // unless their material is two-sided
    {
        SceneBuilder builder("panels");
        Material both;
        both.metallic = 0.0f;
        both.emission = glm::vec3(10);
        both.doubleSided = true;
        builder.add("One", quadMesh({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), builder.addEmitter("one", glm::vec3(10)));
        builder.add("Two", quadMesh({5, 0, 0}, {1, 0, 0}, {0, 1, 0}), builder.addMaterial(both));
        const LitScene lit(builder.finish());
        for (int e = 0; e < 2; ++e) {
            for (const float z : {2.0f, -2.0f}) {
                const glm::vec3 p(0.3f + 5.0f * float(e), 0.4f, z);
                LightSample s;
                Hit hit;
                const bool shines = e == 1 || z > 0.0f;
                QCOMPARE(lit.lights->sample(e, p, {0.3f, 0.6f}, s), shines);
                if (shines) QCOMPARE(s.radiance, glm::vec3(10));
                QVERIFY(lit.rays->intersect(p, {0, 0, z > 0.0f ? -1.0f : 1.0f}, kFar, hit));
                QCOMPARE(lit.lights->pdf(p, hit) > 0.0f, shines);
            }
        }
    }

    void lampsDoNotShareRandomNumbers() // or their noise would add up
    {
        SceneBuilder builder("twins");
        builder.add("Box", boxMesh(glm::vec3(-1), glm::vec3(1), Facing::in),
                    builder.addMaterial("grey", glm::vec3(0.5f)));
        builder.addPoint("A", glm::vec3(0), glm::vec3(1));
        builder.addPoint("B", glm::vec3(0), glm::vec3(1));
        const LitScene lit(builder.finish());
        Workers workers(2);
        const auto a = tracePhotons(*lit.rays, *lit.lights, {0, 1, 1000, 64}, workers, {}),
                   b = tracePhotons(*lit.rays, *lit.lights, {1, 1, 1000, 64}, workers, {});
        QVERIFY(a->photons.size() > 500 && b->photons.size() > 500);
        std::size_t alike = 0;
        for (std::size_t i = 0; i < std::min(a->photons.size(), b->photons.size()); ++i)
            alike += a->photons[i].position == b->photons[i].position ? 1 : 0;
        QCOMPARE(alike, std::size_t(0));
    }

    void densityIntegratesToOne_data()
    {
        QTest::addColumn<float>("height");
        for (const float h : {0.05f, 0.5f, 3.0f}) QTest::addRow("%g m", double(h)) << h;
    }
    void densityIntegratesToOne() // over all directions, for a lamp that is seen whole
    {
        QFETCH(float, height);
        SceneBuilder builder("panel");
        builder.add("A", quadMesh({0, 0, 0}, {2, 0, 0}, {0, 1, 0}), builder.addEmitter("a", glm::vec3(1)));
        const LitScene lit(builder.finish());
        const glm::vec3 p(0.7f, 0.4f, height);
        RunningMean front, back;
        for (std::uint64_t i = 0; i < 400'000; ++i) {
            Rng rng(17, 18, i);
            const float u1 = rng.uniform(), u2 = rng.uniform();
            const glm::vec3 w = sampleCosineHemisphere(u1, u2); // as cos / pi: the density's own shape is near it
            const auto weigh = [&](glm::vec3 from, glm::vec3 towards) {
                Hit hit;
                if (!lit.rays->intersect(from, towards, kFar, hit)) return 0.0;
                return double(lit.lights->pdf(from, hit)) * kPiD / double(w.z);
            };
            front.add(weigh(p, {w.x, w.y, -w.z}));
            back.add(weigh({p.x, p.y, -p.z}, w));
        }
        VERIFY_MEAN(front, 1.0, kZ, "in front");
        QCOMPARE(back.mean(), 0.0); // one-sided: nothing is ever picked from behind
    }

    void manyTriangles() // a lamp of 131072 triangles: picked by area, whatever their order
    {
        SceneBuilder builder("sphere");
        builder.add("Ball", sphereMesh(glm::vec3(0), 1.0f, 256), builder.addEmitter("a", glm::vec3(1)));
        const LitScene lit(builder.finish());
        QVERIFY(lit.rays->triangleCount() > 100'000);
        QVERIFY(relative(lit.lights->groupFlux(0).x, 4.0 * kPiD * kPiD) <= 1e-3);
        RunningMean octant, band;
        for (std::uint64_t i = 0; i < 100'000; ++i) {
            Rng rng(19, 20, i);
            EmittedPhoton photon;
            QVERIFY(lit.lights->emit(0, rng, photon));
            octant.add(photon.position.x > 0 && photon.position.y > 0 && photon.position.z > 0 ? 1.0 : 0.0);
            band.add(photon.position.y > 0.5f ? 1.0 : 0.0);
        }
        VERIFY_MEAN(octant, 0.125, kZ, "an octant");
        VERIFY_MEAN(band, 0.25, kZ, "the cap above one half"); // Archimedes
    }

    void punctualSamples() // I / d^2, and nothing outside a spot's cone; the sun from everywhere alike
    {
        const LitScene lit(mixedGroup());
        LightSample s;
        QVERIFY(lit.lights->sample(0, {3, 2, 4}, {0, 0}, s));
        QVERIFY(s.isPunctual());
        QVERIFY(relative(s.illuminance.x, 5.0 / 25.0) <= 1e-6);
        QVERIFY(relative(s.distance, 5.0) <= 1e-6);
        QVERIFY(!lit.lights->sample(0, {0, 2, 0}, {0, 0}, s)); // at the lamp itself
        QVERIFY(!lit.lights->sample(1, {1, 3, 0}, {0, 0}, s)); // behind the spot
        QVERIFY(lit.lights->sample(1, {1, 0, 0}, {0, 0}, s));
        QVERIFY(relative(s.illuminance.y, 30.0 / 4.0) <= 1e-6);
        QVERIFY(lit.lights->sample(2, {1, 0, 0}, {0, 0}, s));
        QVERIFY(relative(s.illuminance.x, 2.0) <= 1e-6);
        QVERIFY(s.distance > lit.scene->bounds.diagonal());
        QVERIFY(lit.lights->pdf({0, 1, 0}, Hit{}) == 0.0f); // the floor is no lamp
    }

    void oddScenesStayFinite() // no lamps, no geometry, dark lamps, flat triangles, tiny and huge sizes
    {
        SceneBuilder builder("odd");
        builder.addPoint("Dark", {0, 0, 0}, glm::vec3(0));
        builder.addDirectional("Sun", {0, -1, 0}, glm::vec3(1));
        Mesh flat = quadMesh({0, 0, 0}, {0, 0, 0}, {0, 1, 0});
        builder.add("Flat", flat, builder.addEmitter("e", glm::vec3(1)));
        const LitScene lit(builder.finish());
        for (int group = 0; group < 3; ++group) {
            Rng rng(1, 1, 1);
            EmittedPhoton photon;
            const bool shines = lit.lights->emit(group, rng, photon);
            QVERIFY(!shines || (isFinite(photon.position) && isFinite(photon.travel) && isFinite(photon.flux)));
            QVERIFY(isFinite(lit.lights->groupFlux(group)));
        }
        const LitScene empty{Scene{}};
        QVERIFY(empty.lights->emitters().empty());
        for (const float scale : {1e-4f, 1e5f}) {
            SceneBuilder small("scaled");
            small.add("A", quadMesh({0, 0, 0}, glm::vec3(scale, 0, 0), glm::vec3(0, scale, 0)),
                      small.addEmitter("a", glm::vec3(1)));
            const LitScene scaled(small.finish());
            LightSample s;
            const glm::vec3 p(0.5f * scale, 0.5f * scale, scale);
            RunningMean lux;
            for (std::uint64_t i = 0; i < 20'000; ++i) {
                Rng rng(21, 22, i);
                const glm::vec2 u(rng.uniform(), rng.uniform());
                QVERIFY(scaled.lights->sample(0, p, u, s));
                lux.add(double(s.radiance.x) * double(-s.toLight.z) / double(s.pdf));
            }
            const double c =
                configurationFactor({0.5, 0.5, 1.0}, {0, 0, -1}, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
            VERIFY_MEAN(lux, kPiD * c, kZ, QString("scale %1").arg(double(scale)));
        }
    }
};

QTEST_APPLESS_MAIN(LightSamplerTest)
#include "tst_light_sampler.moc"
