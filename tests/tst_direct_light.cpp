// SPDX-License-Identifier: Apache-2.0
// Claims about direct light: a point source is exact (A1), a panel agrees with Lambert's formula (A2), spots follow
// KHR_lights_punctual, shadows, mixes and mid-air work; gloss and final gather agree with what is known of a furnace.
#include "core/scene/analytic_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/trace/final_gather.h"
#include "tests/light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

double lux(const LitScene& lit, glm::vec3 p, glm::vec3 n, int samples = 1)
{
    Rng rng(1, 2, 3);
    return double(directIlluminance(*lit.rays, *lit.lights, {}, p, n, samples, rng).x);
}

glm::vec3 zUp(glm::vec3 p) { return fromZUp(p.x, p.y, p.z); }

} // namespace

class DirectLightTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void pointSource_data() // A1: I cos / d^2 at the points of the validation script, z up
    {
        QTest::addColumn<double>("x");
        QTest::addColumn<double>("y");
        QTest::addColumn<double>("z");
        QTest::addColumn<double>("expected");
        const std::vector<std::array<double, 4>> points{
            {2, 2, 0, 118.906064},  {1, 2, 0, 100.464716},   {0.5, 0.5, 0, 62.518512}, {0.1, 0.1, 0, 46.930970},
            {3.9, 2, 0, 69.589112}, {0, 2, 1.5, 137.455020}, {0, 0.5, 0.5, 48.052444}, {0, 2, 2.9, 250.0}};
        for (const auto& p : points) QTest::addRow("%g %g %g", p[0], p[1], p[2]) << p[0] << p[1] << p[2] << p[3];
    }
    void pointSource()
    {
        QFETCH(double, x);
        QFETCH(double, y);
        QFETCH(double, z);
        QFETCH(double, expected);
        const LitScene lit(pointSourceRoom());
        const glm::vec3 n = x == 0.0 ? zUp({1, 0, 0}) : zUp({0, 0, 1});
        const double found = lux(lit, zUp({float(x), float(y), float(z)}), n);
        QVERIFY2(std::abs(found / expected - 1.0) <= 1e-5, qPrintable(QString::number(found, 'g', 9)));
        const double again = 1000.0 * std::abs(z == 0.0 ? 2.9 : 2.0) /
                             std::pow((x - 2) * (x - 2) + (y - 2) * (y - 2) + (z - 2.9) * (z - 2.9), 1.5);
        QVERIFY(std::abs(found / again - 1.0) <= 1e-5);
    }

    void areaSource_data() // A2
    {
        QTest::addColumn<double>("x");
        QTest::addColumn<double>("y");
        QTest::addColumn<double>("z");
        QTest::addColumn<double>("expected");
        const std::vector<std::array<double, 4>> points{
            {2, 2, 0, 341.067949},     {1, 2, 0, 279.891563},   {1, 1, 0, 233.482626},
            {0.5, 0.5, 0, 157.149664}, {0.1, 2, 0, 179.414907}, {0, 2, 0.5, 147.379927},
            {0, 2, 1.5, 242.851407},   {0, 2, 2.5, 187.401415}, {0, 2, 2.9, 42.892093}};
        for (const auto& p : points) QTest::addRow("%g %g %g", p[0], p[1], p[2]) << p[0] << p[1] << p[2] << p[3];
    }
    void areaSource()
    {
        QFETCH(double, x);
        QFETCH(double, y);
        QFETCH(double, z);
        QFETCH(double, expected);
        const glm::dvec3 p(x, y, z), n = x == 0.0 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
        const double formula =
            10000.0 * configurationFactor(p, n, {{1.5, 1.5, 3}, {2.5, 1.5, 3}, {2.5, 2.5, 3}, {1.5, 2.5, 3}});
        QVERIFY(std::abs(formula / expected - 1.0) <= 1e-7);
        const LitScene lit(areaSourceRoom());
        RunningMean batches;
        glm::vec3 claimed(0.0f);
        for (std::uint64_t i = 0; i < 400; ++i) {
            Rng rng(1, 2, i);
            batches.add(double(directIlluminance(*lit.rays, *lit.lights, {}, zUp(p), zUp(n), 64, rng, &claimed).x));
        }
        QVERIFY2(batches.standardError() <= 0.002 * expected, qPrintable(QString::number(batches.standardError())));
        VERIFY_MEAN(batches, expected, sidakLimit(9), "A2");
        QVERIFY(std::abs(batches.mean() / expected - 1.0) <= 0.01);
        // the claimed error is that of independent samples: never below what the spread of batches shows
        QVERIFY2(std::sqrt(double(claimed.x)) >= 0.9 * std::sqrt(batches.variance()),
                 qPrintable(QString("claims %1, is %2").arg(std::sqrt(claimed.x)).arg(std::sqrt(batches.variance()))));
    }

    void spotFollowsKhr() // over a plane: on the axis, in the rim, at the edge, outside
    {
        SceneBuilder builder("spot");
        builder.add("Floor", quadMesh({-3, 0, -3}, {0, 0, 6}, {6, 0, 0}), builder.addMaterial("black", glm::vec3(0)));
        builder.addSpot("S", {0.2f, 2, 0.1f}, {0.9f, 0, -0.2f}, {300, 200, 100}, 0.25f, 0.6f);
        const LitScene lit(builder.finish());
        const glm::dvec3 at(0.2f, 2.0, 0.1f), axis = glm::normalize(glm::dvec3(0.9f, 0, -0.2f) - at);
        int inner = 0, rim = 0, outer = 0;
        for (int i = 0; i <= 24; ++i) {
            for (int j = 0; j <= 24; ++j) {
                const glm::dvec3 p(-2.4 + 0.2 * i, 0.0, -2.4 + 0.2 * j), d = p - at;
                const double r = glm::length(d), cosine = glm::dot(d / r, axis);
                const double scale = 1.0 / std::max(0.001, std::cos(0.25) - std::cos(0.6));
                const double fade = std::pow(glm::clamp((cosine - std::cos(0.6)) * scale, 0.0, 1.0), 2.0);
                const double expected = 300.0 * fade * 2.0 / (r * r * r), found = lux(lit, p, {0, 1, 0});
                QVERIFY2(std::abs(found - expected) <= 2e-5 * expected + 1e-5,
                         qPrintable(QString("%1 instead of %2").arg(found).arg(expected)));
                ++(fade == 1.0 ? inner : fade > 0.0 ? rim : outer);
            }
        }
        QVERIFY(inner > 10 && rim > 10 && outer > 10);
    }

    void shadowsAndSides()
    {
        SceneBuilder builder("shadow");
        const int black = builder.addMaterial("black", glm::vec3(0));
        builder.add("Floor", quadMesh({-3, 0, -3}, {0, 0, 6}, {6, 0, 0}), black);
        builder.add("Leaf", quadMesh({0, 1, -1}, {0, 0, 2}, {1, 0, 0}), black);
        builder.addPoint("P", {0, 2, 0}, glm::vec3(100));
        builder.addDirectional("Sun", {0, -1, 0}, glm::vec3(10));
        const LitScene lit(builder.finish());
        QCOMPARE(lux(lit, {0.5f, 0, 0}, {0, 1, 0}), 0.0); // under the leaf
        QVERIFY(std::abs(lux(lit, {0.5f, 1, 0}, {0, 1, 0}) - (10.0 + 100.0 / std::pow(1.25, 1.5))) <= 1e-3); // on it
        QCOMPARE(lux(lit, {0.5f, 1, 0}, {0, -1, 0}), 0.0); // its underside
        QVERIFY(std::abs(lux(lit, {-1, 0, 0}, {0, 1, 0}) - (10.0 + 200.0 / std::pow(5.0, 1.5))) <= 1e-3);
        QCOMPARE(lux(lit, {-1, 0, 0}, {0, -1, 0}), 0.0);
        QVERIFY(std::abs(lux(lit, {-2, 1, 0}, {0, 1, 0}) - (10.0 + 100.0 / std::pow(5.0, 1.5))) <= 1e-3); // in mid-air
    }

    void mixScalesGroups() // linear, per channel
    {
        const LitScene lit([] {
            SceneBuilder builder("mix");
            builder.addPoint("A", {0, 1, 0}, glm::vec3(1));
            builder.addPoint("B", {0, 2, 0}, glm::vec3(1));
            return builder.finish();
        }());
        Rng rng(1, 2, 3);
        const Mix mix{{1, 0, 2}, {4, 0, 0}};
        const glm::vec3 e = directIlluminance(*lit.rays, *lit.lights, mix, {0, 0, 0}, {0, 1, 0}, 1, rng);
        QVERIFY(glm::length(e - glm::vec3(2, 0, 2)) <= 1e-6f);
        const glm::vec3 short_ =
            directIlluminance(*lit.rays, *lit.lights, Mix{{0, 0, 0}}, {0, 0, 0}, {0, 1, 0}, 1, rng);
        QVERIFY(glm::length(short_ - glm::vec3(0.25f)) <= 1e-6f); // groups the mix does not name: as baked
    }

    void glossInAFurnace_data()
    {
        QTest::addColumn<float>("roughness");
        for (const float r : {0.06f, 0.3f, 0.8f}) QTest::addRow("%g", double(r)) << r;
    }
    /// Under uniform light of 1 cd/m2 from everywhere gloss shows its own reflectance, whatever the lobe's width.
    void glossInAFurnace()
    {
        QFETCH(float, roughness);
        const LitScene lit(furnaceBox(0.0f, float(kPiD)));
        Surface s;
        s.specular = glm::vec3(0.8f);
        s.diffuse = glm::vec3(0.5f); // must not show
        s.roughness = roughness;
        const glm::vec3 n(0, 1, 0), eye = glm::normalize(glm::vec3(1, 1, 0.2f));
        RunningMean found, reflectance;
        Surface glossy = s;
        glossy.diffuse = glm::vec3(0.0f);
        for (std::uint64_t i = 0; i < 4000; ++i) {
            Rng rng(4, 5, i);
            found.add(double(directGlossy(*lit.rays, *lit.lights, {}, s, {0.1f, -0.3f, 0.2f}, n, eye, 16, rng).x));
            for (int k = 0; k < 25; ++k) {
                const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
                Scatter out;
                reflectance.add(scatter(glossy, n, eye, u, out) ? double(out.weight.x) : 0.0);
            }
        }
        const double error = std::abs(found.mean() - reflectance.mean());
        QVERIFY2(error <= 4.9 * std::hypot(found.standardError(), reflectance.standardError()) + 1e-4,
                 qPrintable(QString("%1 and %2").arg(found.mean()).arg(reflectance.mean())));
        QVERIFY(error <= 0.01);
        Rng rng(1, 1, 1);
        s.roughness = 0.0f;
        QCOMPARE(directGlossy(*lit.rays, *lit.lights, {}, s, {0, 0, 0}, n, eye, 16, rng), glm::vec3(0));
    }

    void gatherThroughAnExactCache() // furnace: cached M rho / (1 - rho) at every hit gives the same at the point
    {
        const float rho = 0.6f;
        const LitScene lit(furnaceBox(rho));
        const float indirect = rho / (1.0f - rho);
        const CachedIndirect exact = [=](glm::vec3, glm::vec3, glm::vec3& e) {
            e = glm::vec3(indirect);
            return true;
        };
        RunningMean found;
        for (std::uint64_t i = 0; i < 400; ++i) {
            Rng rng(6, 7, i);
            found.add(double(
                gatherIndirect(*lit.rays, *lit.lights, {}, exact, {0.2f, 0.1f, -0.3f}, {0, 1, 0}, 64, 16, rng).x));
        }
        VERIFY_MEAN(found, double(indirect), sidakLimit(5), "gathered");
        QVERIFY(std::abs(found.mean() / double(indirect) - 1.0) <= 0.01);
    }

    void gatherWithoutACacheGoesOn() // it becomes a path tracer: the lit cube's exact value in the middle of a face
    {
        const LitScene lit(litCube(0.5f, 1.0f));
        const CachedIndirect none = [](glm::vec3, glm::vec3, glm::vec3&) { return false; };
        RunningMean found;
        for (std::uint64_t i = 0; i < 1000; ++i) {
            Rng rng(8, 9, i);
            found.add(double(gatherIndirect(*lit.rays, *lit.lights, {}, none, {0, -1, 0}, {0, 1, 0}, 256, 1, rng).x));
        }
        QVERIFY(std::abs(found.mean() / kCubeCentreHalf - 1.0) <= 0.005 + 4.9 * found.standardError());
    }

    void gatherFollowsMirrors() // a lamp seen in a mirror is indirect light; straight it is none
    {
        SceneBuilder builder("mirror");
        builder.add("Lamp", quadMesh({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}), builder.addEmitter("lamp", glm::vec3(100)));
        builder.add("Mirror", quadMesh({-50, -1, -50}, {0, 0, 100}, {100, 0, 0}),
                    builder.addMetal("mirror", glm::vec3(0.9f), 0.0f));
        const LitScene lit(builder.finish());
        const CachedIndirect none = [](glm::vec3, glm::vec3, glm::vec3&) { return false; };
        RunningMean down;
        for (std::uint64_t i = 0; i < 400; ++i) {
            Rng rng(10, 11, i);
            QCOMPARE(gatherIndirect(*lit.rays, *lit.lights, {}, none, {0, 0, 0}, {0, 1, 0}, 16, 4, rng), glm::vec3(0));
            down.add(double(gatherIndirect(*lit.rays, *lit.lights, {}, none, {0, 0, 0}, {0, -1, 0}, 256, 4, rng).x));
        }
        // the lamp's image at y = -4 seen through F0 .9 with Schlick's rise, which is below 1 % up to 50 degrees
        const double c =
            configurationFactor({0, 0, 0}, {0, -1, 0}, {{-1, -4, -1}, {1, -4, -1}, {1, -4, 1}, {-1, -4, 1}});
        VERIFY_MEAN(down, 100.0 * kPiD * c * 0.9, sidakLimit(5), "mirrored lamp");
    }

private:
    static constexpr double kCubeCentreHalf = 0.563146; // indirect E / I at (0,0) for rho 1/2, see tst_reference
};

QTEST_APPLESS_MAIN(DirectLightTest)
#include "tst_direct_light.moc"
