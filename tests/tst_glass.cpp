// SPDX-License-Identifier: Apache-2.0
// Claims about glass at one point: Fresnel's and Snell's laws against closed forms, shares that add up, a pane's series
// summed again in double, Beer's law, and scattering that follows the shares. No index, angle or tint makes a NaN.
#include "core/scene/scene_builder.h"
#include "core/trace/medium.h"
#include "tests/light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

Glass border(float eta, glm::vec3 tint = glm::vec3(1.0f)) { return {1.0f, eta, false, tint, glm::vec3(0.0f)}; }
Glass pane(float ior, glm::vec3 tint = glm::vec3(1.0f)) { return {1.0f, ior, true, tint, glm::vec3(0.0f)}; }

Surface surfaceOf(const Glass& glass)
{
    Surface s;
    s.glass = glass;
    return s;
}

glm::vec3 eyeAt(double deg)
{
    const double a = deg * kPiD / 180.0;
    return glm::normalize(glm::vec3(std::sin(a) * 0.6, std::sin(a) * 0.8, std::cos(a)));
}

/// Share of diffuse light that glass reflects from outside, in closed form (Walsh 1926; Duntley 1942).
double walsh(double n)
{
    const double n2 = n * n, n4 = n2 * n2;
    return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
           n2 * (n2 - 1) * (n2 - 1) / std::pow(n2 + 1, 3) * std::log((n - 1) / (n + 1)) -
           2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
           8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
}

/// The same by summing Fresnel's term over the cosine-weighted hemisphere (midpoints in sin^2).
double diffuseReflectance(float eta)
{
    constexpr int kSteps = 400'000;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) sum += double(fresnelDielectric(float(std::sqrt(1.0 - (i + 0.5) / kSteps)), eta));
    return sum / kSteps;
}

/// What a pane does, pass after pass in double.
void paneAgain(double f, double tint, double& reflected, double& through)
{
    reflected = f;
    through = 0.0;
    double inside = (1.0 - f) * tint; // on its way to the far border
    for (int pass = 0; pass < 4000; ++pass) {
        (pass % 2 == 0 ? through : reflected) += inside * (1.0 - f);
        inside *= f * tint;
    }
}

} // namespace

class GlassTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void knownAngles()
    {
        for (const double n : {1.2, 1.33, 1.5, 2.4}) {
            const double straight = std::pow((n - 1) / (n + 1), 2);
            QVERIFY(std::abs(double(fresnelDielectric(1.0f, float(n))) - straight) <= 1e-6);
            QVERIFY(std::abs(double(fresnelDielectric(1.0f, float(1 / n))) - straight) <= 1e-6);
            QCOMPARE(fresnelDielectric(0.0f, float(n)), 1.0f);
            // Brewster: nothing of the light that swings in the plane; the other half is ((n^2 - 1)/(n^2 + 1))^2
            const double brewster = 0.5 * std::pow((n * n - 1) / (n * n + 1), 2);
            QVERIFY(std::abs(double(fresnelDielectric(float(1 / std::sqrt(1 + n * n)), float(n))) - brewster) <= 1e-6);
            // total reflection begins where sin = 1/n
            const double critical = std::sqrt(1.0 - 1.0 / (n * n));
            QCOMPARE(fresnelDielectric(float(critical * 0.999), float(1 / n)), 1.0f);
            QVERIFY(fresnelDielectric(float(critical * 1.001), float(1 / n)) < 1.0f);
        }
        for (const float cosine : {0.0f, 1e-6f, 0.3f, 1.0f}) QCOMPARE(fresnelDielectric(cosine, 1.0f), 0.0f);
    }

    void bothSidesReflectAlike() // at the angles that Snell's law joins
    {
        for (std::uint64_t i = 0; i < 10'000; ++i) {
            Rng rng(1, 1, i);
            const float n = 1.01f + 2.0f * rng.uniform();
            const glm::vec3 toEye = eyeAt(89.0 * double(rng.uniform())), on = refracted(toEye, n);
            const double sine = std::hypot(double(toEye.x), double(toEye.y)),
                         bent = std::hypot(double(on.x), double(on.y));
            QVERIFY(std::abs(sine - double(n) * bent) <= 1e-6);
            QVERIFY(std::abs(double(glm::length(on)) - 1.0) <= 1e-6 && on.z < 0.0f);
            QVERIFY(std::abs(glm::cross(toEye, on).z) <= 1e-6f); // in the plane of the normal and the ray
            const float out = fresnelDielectric(toEye.z, n), in = fresnelDielectric(-on.z, 1.0f / n);
            // near the critical angle the cosine beyond is a root of what is left of 1
            QVERIFY2(std::abs(out - in) <= 1e-4f, qPrintable(QString("%1 and %2").arg(double(out)).arg(double(in))));
            const glm::vec3 back = refracted(-on, 1.0f / n); // the way back is the way there
            QVERIFY(glm::length(back - glm::vec3(-toEye.x, -toEye.y, -toEye.z)) <= 2e-4f);
        }
    }

    void diffuseLightReflectsAsWalshSays() // and from inside 1 - (1 - r) / n^2
    {
        for (const double n : {1.2, 1.33, 1.5, 2.0}) {
            const double outside = walsh(n), inside = 1.0 - (1.0 - outside) / (n * n);
            QVERIFY2(std::abs(diffuseReflectance(float(n)) - outside) <= 2e-6,
                     qPrintable(QString("%1: %2 and %3").arg(n).arg(diffuseReflectance(float(n))).arg(outside)));
            QVERIFY2(std::abs(diffuseReflectance(float(1 / n)) - inside) <= 5e-6,
                     qPrintable(QString("%1: %2 and %3").arg(n).arg(diffuseReflectance(float(1 / n))).arg(inside)));
        }
    }

    void sharesAddUp() // clear glass takes nothing, tinted glass what the series says
    {
        for (std::uint64_t i = 0; i < 20'000; ++i) {
            Rng rng(2, 1, i);
            const float eta = 0.3f + 3.0f * rng.uniform(), cosine = rng.uniform();
            const glm::vec3 tint(rng.uniform(), rng.uniform(), 1.0f);
            const double f = double(fresnelDielectric(cosine, eta));
            const GlassShares solid = glassShares(border(eta, tint), cosine),
                              thin = glassShares(pane(eta, tint), cosine);
            QVERIFY(std::abs(solid.reflected.z + solid.through.z - 1.0f) <= 1e-6f);
            QVERIFY(std::abs(thin.reflected.z + thin.through.z - 1.0f) <= 1e-5f);
            QVERIFY(std::abs(double(solid.through.x) - (1.0 - f) * double(tint.x)) <= 1e-6);
            double reflected = 0.0, through = 0.0;
            paneAgain(f, double(tint.x), reflected, through);
            QVERIFY2(std::abs(double(thin.reflected.x) - reflected) <= 2e-5,
                     qPrintable(QString("%1 and %2").arg(double(thin.reflected.x)).arg(reflected)));
            QVERIFY(std::abs(double(thin.through.x) - through) <= 2e-5);
        }
    }

    void scatteringFollowsTheShares() // mean weight = share, mirrored and refracted directions, at every lobe mixture
    {
        for (const double deg : {0.0, 40.0, 60.0, 85.0}) {
            for (const Glass& glass :
                 {border(1.5f, {0.9f, 1.0f, 0.5f}), border(1.0f / 1.5f), pane(1.5f, {1, 0.5f, 0.1f})}) {
                for (const float share : {0.4f, 1.0f}) {
                    Surface s = surfaceOf(glass);
                    s.glass.share = share;
                    s.diffuse = (1.0f - share) * glm::vec3(0.5f, 0.3f, 0.8f);
                    const glm::vec3 eye = eyeAt(deg);
                    const GlassShares expected = glassShares(s.glass, eye.z);
                    RunningMean back[3], on[3], matt[3];
                    for (std::uint64_t i = 0; i < 20'000; ++i) {
                        Rng rng(3, 1, i);
                        Scatter out;
                        const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
                        const bool goesOn = scatter(s, {0, 0, 1}, eye, u, out);
                        QVERIFY(goesOn || share == 1.0f);
                        for (int c = 0; c < 3; ++c) {
                            const double w = goesOn ? double(out.weight[c]) : 0.0;
                            back[c].add(out.isMirror && !out.isThrough ? w : 0.0);
                            on[c].add(out.isThrough ? w : 0.0);
                            matt[c].add(out.isMirror ? 0.0 : w);
                        }
                        if (!out.isMirror) {
                            const float told = scatterPdf(s, {0, 0, 1}, out.away, eye);
                            QVERIFY(std::abs(out.pdf / told - 1.0f) <= 1e-4f && !out.isThrough && !out.isSpecular);
                            continue;
                        }
                        QVERIFY(out.isSpecular && out.pdf == 0.0f);
                        const glm::vec3 ideal = !out.isThrough   ? glm::vec3(-eye.x, -eye.y, eye.z)
                                                : s.glass.isThin ? -eye
                                                                 : refracted(eye, s.glass.eta);
                        QVERIFY(glm::length(out.away - ideal) <= 1e-6f);
                        const float scale =
                            out.isThrough && !s.glass.isThin ? 1.0f / (s.glass.eta * s.glass.eta) : 1.0f;
                        QCOMPARE(out.radianceScale, scale);
                        QVERIFY(glm::dot(out.side({0, 0, 1}), out.away) >= 0.0f);
                    }
                    for (int c = 0; c < 3; ++c) {
                        VERIFY_MEAN(back[c], double(expected.reflected[c]), sidakLimit(300), "reflected");
                        VERIFY_MEAN(on[c], double(expected.through[c]), sidakLimit(300), "through");
                        VERIFY_MEAN(matt[c], double(s.diffuse[c]), sidakLimit(300), "matt");
                    }
                }
            }
        }
    }

    void beersLaw()
    {
        Material m;
        m.attenuationColor = {0.25f, 1.0f, 0.0f};
        m.attenuationDistance = 0.5f;
        const glm::vec3 a = absorptionOf(m);
        QVERIFY(std::abs(std::exp(-a.x * 1.0f) - 0.0625f) <= 1e-6f && a.y == 0.0f && std::exp(-a.z * 0.5f) <= 1e-30f);
        m.attenuationDistance = 0.0f; // none
        QCOMPARE(absorptionOf(m), glm::vec3(0.0f));
        m.attenuationDistance = 1e-38f;
        for (int c = 0; c < 3; ++c) QVERIFY(std::isfinite(absorptionOf(m)[c]));
    }

    void aBodysInsideAbsorbs() // from the front nothing, from the back the segment's length, behind the border that was
                               // crossed
    {
        SceneBuilder builder("slab");
        builder.add("Slab", boxMesh({-1, 0, -1}, {1, 0.5f, 1}),
                    builder.addGlass("green", 1.5f, {0.5f, 1.0f, 0.5f}, 1.0f));
        builder.add("Core", boxMesh({-0.1f, 0.1f, -0.1f}, {0.1f, 0.2f, 0.1f}),
                    builder.addMaterial("core", glm::vec3(0.5f)));
        const LitScene lit(builder.finish());
        Medium medium;
        Hit hit;
        QVERIFY(lit.rays->intersect({0.01f, 1, 0.02f}, {0, -1, 0}, 10.0f, hit));
        const Surface top = surfaceAt(*lit.rays, hit);
        QVERIFY(!medium.absorbs(hit, top));
        QCOMPARE(top.glass.eta, 1.5f);
        Scatter in;
        in.isThrough = true;
        medium.cross(hit, top, in);
        QVERIFY(lit.rays->intersect({0.01f, 0.4999f, 0.02f}, {0, -1, 0}, 10.0f, hit)); // the core, inside
        const Surface core = surfaceAt(*lit.rays, hit);
        QVERIFY(medium.absorbs(hit, core));
        QVERIFY(std::abs(medium.transmittance(hit, core).x - std::exp2(-hit.distance)) <= 1e-6f);
        QVERIFY(lit.rays->intersect({0.5f, 0.4999f, 0.02f}, {0, -1, 0}, 10.0f, hit)); // the far border, from inside
        const Surface bottom = surfaceAt(*lit.rays, hit);
        QCOMPARE(bottom.glass.eta, 1.0f / 1.5f);
        QVERIFY(std::abs(Medium().transmittance(hit, bottom).x - std::exp2(-0.4999f)) <= 1e-5f);
        medium.cross(hit, bottom, in);
        QVERIFY(!medium.absorbs(hit, core));
    }

    void surfacesTellTheirGlass() // factors, metal, the clamp of albedos that spares clear glass
    {
        Material m;
        m.metallic = 0.25f;
        m.transmission = 0.8f;
        m.baseColor = {1.0f, 0.5f, 0.25f, 1.0f};
        m.roughness = 0.0f;
        SceneBuilder builder("quad");
        builder.add("Quad", quadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), builder.addMaterial(m));
        const LitScene lit(builder.finish());
        Hit hit;
        QVERIFY(lit.rays->intersect({0.1f, 0.2f, 1}, {0, 0, -1}, 10.0f, hit));
        const Surface s = surfaceAt(*lit.rays, hit);
        QVERIFY(std::abs(s.glass.share - 0.6f) <= 1e-6f && s.glass.isThin);
        QCOMPARE(s.glass.tint, glm::vec3(1.0f, 0.5f, 0.25f));
        QVERIFY(glm::length(s.diffuse - 0.15f * glm::vec3(0.99f, 0.5f, 0.25f)) <= 1e-6f);
        QVERIFY(glm::length(s.specular - 0.25f * glm::vec3(0.99f, 0.5f, 0.25f)) <= 1e-6f);
        m.metallic = 1.0f;
        QVERIFY(!mayTransmit(m));
    }

    void anyNumberGivesANumber()
    {
        const glm::vec3 odd[] = {glm::vec3(0.0f), glm::vec3(1.0f), {0.0f, 1.0f, 0.5f}};
        for (const float eta : {0.0f, 1e-30f, 1e-3f, 0.5f, 1.0f, 1.0000001f, 1.5f, 1000.0f, 1e30f, INFINITY, NAN}) {
            for (const float cosine : {0.0f, 1e-30f, 1e-7f, 1e-3f, 0.5f, 1.0f}) {
                const float f = fresnelDielectric(cosine, eta);
                QVERIFY2(f >= 0.0f && f <= 1.0f, qPrintable(QString("%1 %2").arg(double(eta)).arg(double(cosine))));
                for (const glm::vec3 tint : odd) {
                    for (const bool thin : {false, true}) {
                        const Glass glass{1.0f, eta, thin, tint, glm::vec3(0.0f)};
                        const glm::vec3 eye(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
                        for (const float u : {0.0f, 0.5f, 0.9999999f}) {
                            Scatter out;
                            if (!scatter(surfaceOf(glass), {0, 0, 1}, eye, {u, 0.5f, u}, out)) continue;
                            QVERIFY(isFinite(out.away) && isFinite(out.weight));
                            QVERIFY(std::abs(glm::length(out.away) - 1.0f) <= 1e-5f);
                            QVERIFY(glm::all(glm::greaterThanEqual(out.weight, glm::vec3(0.0f))));
                        }
                    }
                }
            }
        }
    }
};

QTEST_APPLESS_MAIN(GlassTest)
#include "tst_glass.moc"
