// SPDX-License-Identifier: Apache-2.0
// Claims about surfaces: textures wrap, filter and turn as glTF says; scattering follows its own density, keeps energy
// and agrees with the GGX formulas written here again in double.
#include "core/scene/scene_builder.h"
#include "core/trace/material.h"
#include "tests/light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

const double kZ = sidakLimit(300);

/// 2 x 2: red, green over blue, white; alpha 0 85 170 255.
Scene fourTexels()
{
    Scene scene;
    Image image;
    image.width = image.height = 2;
    image.rgba = {255, 0, 0, 0, 0, 255, 0, 85, 0, 0, 255, 170, 255, 255, 255, 255};
    scene.images.push_back(image);
    return scene;
}

Texture nearest()
{
    Texture t;
    t.image = 0;
    t.smooth = false;
    return t;
}

Surface metal(float roughness, glm::vec3 f0 = glm::vec3(0.9f))
{
    Surface s;
    s.specular = f0;
    s.roughness = roughness;
    return s;
}

Surface half(float roughness) // half matt, half metal
{
    Surface s = metal(roughness, {0.4f, 0.3f, 0.1f});
    s.diffuse = s.specular;
    s.grazing = 0.5f * kLargestAlbedo;
    return s;
}

glm::vec3 eyeAt(double deg)
{
    const double a = deg * kPiD / 180.0;
    return glm::normalize(glm::vec3(std::sin(a) * 0.6, std::sin(a) * 0.8, std::cos(a)));
}

/// GGX with height-correlated Smith and Schlick in double, straight from Heitz (2014), z along the normal.
double ggxAgain(double alpha, double f0, double f90, glm::dvec3 l, glm::dvec3 v)
{
    const glm::dvec3 h = glm::normalize(l + v);
    const double a2 = alpha * alpha, t = (a2 - 1.0) * h.z * h.z + 1.0, d = a2 / (kPiD * t * t);
    const auto root = [&](double c) { return std::sqrt(a2 + (1.0 - a2) * c * c); };
    const double visible = 0.5 / (l.z * root(v.z) + v.z * root(l.z));
    return d * visible * (f0 + (f90 - f0) * std::pow(1.0 - glm::dot(h, v), 5.0));
}

} // namespace

class MaterialTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void texelsLieWhereGltfSaysSo() // row 0 on top, v downwards, centres at halves
    {
        const Scene scene = fourTexels();
        const Texture t = nearest();
        QCOMPARE(sampleTexture(scene, t, {0.1f, 0.1f}, false), glm::vec4(1, 0, 0, 0));
        QCOMPARE(sampleTexture(scene, t, {0.9f, 0.1f}, false), glm::vec4(0, 1, 0, 1.0f / 3.0f));
        QCOMPARE(sampleTexture(scene, t, {0.1f, 0.9f}, false), glm::vec4(0, 0, 1, 2.0f / 3.0f));
        Texture smooth = t;
        smooth.smooth = true;
        smooth.wrapS = smooth.wrapT = Texture::Wrap::clamp;
        QCOMPARE(sampleTexture(scene, smooth, {0.25f, 0.25f}, false), glm::vec4(1, 0, 0, 0));
        const glm::vec4 middle = sampleTexture(scene, smooth, {0.5f, 0.5f}, false);
        QVERIFY(glm::length(middle - glm::vec4(0.5f)) <= 1e-6f);
        const glm::vec4 edge = sampleTexture(scene, smooth, {0.5f, 0.0f}, false); // red and green, half each
        QVERIFY(glm::length(edge - glm::vec4(0.5f, 0.5f, 0, 1.0f / 6.0f)) <= 1e-6f);
        QCOMPARE(sampleTexture(scene, Texture{}, {0.5f, 0.0f}, false), glm::vec4(1.0f));
    }

    void wrapping()
    {
        const Scene scene = fourTexels();
        Texture t = nearest();
        const auto red = [&](float u) { return sampleTexture(scene, t, {u, 0.1f}, false).x; };
        QCOMPARE(red(1.1f), 1.0f);
        QCOMPARE(red(-0.9f), 1.0f);
        QCOMPARE(red(-0.1f), 0.0f);
        t.wrapS = Texture::Wrap::mirror;
        QCOMPARE(red(1.1f), 0.0f); // seen from behind: the green one first
        QCOMPARE(red(1.9f), 1.0f);
        QCOMPARE(red(-0.1f), 1.0f);
        t.wrapS = Texture::Wrap::clamp;
        QCOMPARE(red(-5.0f), 1.0f);
        QCOMPARE(red(5.0f), 0.0f);
        t.smooth = true;
        t.wrapS = t.wrapT = Texture::Wrap::repeat;
        const glm::vec4 corner = sampleTexture(scene, t, {0.0f, 0.0f}, false); // all four meet across the border
        QVERIFY(glm::length(corner - glm::vec4(0.5f)) <= 1e-6f);
        for (const float odd : {NAN, INFINITY, -INFINITY, 1e30f, -1e30f}) {
            for (const auto wrap : {Texture::Wrap::repeat, Texture::Wrap::mirror, Texture::Wrap::clamp}) {
                t.wrapS = t.wrapT = wrap;
                const glm::vec4 v = sampleTexture(scene, t, {odd, odd}, true);
                QVERIFY(v.x >= 0.0f && v.x <= 1.0f && v.w >= 0.0f && v.w <= 1.0f);
            }
        }
    }

    void transform() // KHR_texture_transform: scale, turn counter-clockwise, shift
    {
        const Scene scene = fourTexels();
        Texture t = nearest();
        t.offset = {0.5f, 0.0f};
        QCOMPARE(sampleTexture(scene, t, {0.1f, 0.1f}, false).y, 1.0f); // green
        t.offset = {0.0f, 0.0f};
        t.scale = {2.0f, 1.0f};
        QCOMPARE(sampleTexture(scene, t, {0.3f, 0.1f}, false).y, 1.0f);
        t.scale = glm::vec2(1.0f);
        t.rotation = float(kPiD / 2.0);
        // (.9, .1) turned a quarter counter-clockwise, v down, lies at (.1, -.9), which repeats at (.1, .1): red
        QCOMPARE(sampleTexture(scene, t, {0.9f, 0.1f}, false), glm::vec4(1, 0, 0, 0));
    }

    void srgbIsDecodedBeforeFiltering()
    {
        Scene scene = fourTexels();
        scene.images[0].rgba = {0, 0, 0, 255, 255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255};
        Texture t = nearest();
        t.smooth = true;
        QVERIFY(std::abs(sampleTexture(scene, t, {0.5f, 0.5f}, true).x - 0.5f) <= 1e-6f);
        scene.images[0].rgba.assign(16, 128); // ((128/255 + .055) / 1.055)^2.4
        QVERIFY(std::abs(sampleTexture(scene, t, {0.5f, 0.5f}, true).x - 0.215861f) <= 1e-6f);
        QVERIFY(std::abs(sampleTexture(scene, t, {0.5f, 0.5f}, false).x - 128.0f / 255.0f) <= 1e-6f);
    }

    void surfacesTakeAllFactors()
    {
        SceneBuilder builder("factors");
        Material m;
        m.baseColor = {0.5f, 1.0f, 0.8f, 1.0f};
        m.metallic = 0.25f;
        m.roughness = 0.8f;
        m.emission = {3, 2, 1};
        Image image; // one texel: roughness .5 (G), metallic 1 (B)
        image.width = image.height = 1;
        image.rgba = {0, 128, 255, 255};
        m.metallicRoughnessTexture.image = builder.addImage(image);
        Mesh quad = texturedQuadMesh({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
        quad.colors.assign(quad.positions.size(), glm::vec4(0.5f, 1.0f, 0.25f, 1.0f));
        builder.add("Quad", quad, builder.addMaterial(m));
        const LitScene lit(builder.finish());
        for (const bool front : {true, false}) {
            Hit hit;
            const float side = front ? 1.0f : -1.0f;
            QVERIFY(lit.rays->intersect({0.1f, 0.2f, side}, {0, 0, -side}, 10.0f, hit));
            QCOMPARE(hit.isFront, front);
            const Surface s = surfaceAt(*lit.rays, hit);
            QVERIFY(glm::length(s.diffuse - 0.75f * glm::vec3(0.25f, 0.99f, 0.2f)) <= 1e-6f); // .99: clamped
            QVERIFY(glm::length(s.specular - 0.25f * glm::vec3(0.25f, 0.99f, 0.2f)) <= 1e-6f);
            QVERIFY(std::abs(s.roughness - 0.8f * 128.0f / 255.0f) <= 1e-6f);
            QCOMPARE(s.emission, front ? glm::vec3(3, 2, 1) : glm::vec3(0)); // one-sided
        }
    }

    void ggxMatchesTheFormulas()
    {
        for (const float roughness : {0.06f, 0.2f, 0.5f, 1.0f}) {
            const Surface s = metal(roughness);
            for (std::uint64_t i = 0; i < 2000; ++i) {
                Rng rng(1, 2, i);
                const glm::vec3 v = eyeAt(85.0 * double(rng.uniform()));
                const float u1 = rng.uniform(), u2 = rng.uniform();
                Scatter out;
                if (!scatter(s, {0, 0, 1}, v, {u1, u2, 0.0f}, out)) continue; // directions where the lobe is
                const double alpha = double(roughness) * double(roughness);
                const double again = ggxAgain(alpha, 0.9f, double(kLargestAlbedo), out.away, v);
                // the reference takes 1 - cos^2 of float directions: 1e-7 in the angle counts against alpha
                const double limit = 1e-4 + 2e-7 / (alpha * alpha);
                const double error = std::abs(double(brdf(s, {0, 0, 1}, out.away, v).x) / again - 1.0);
                QVERIFY2(error <= limit,
                         qPrintable(QString("roughness %1: off by %2").arg(double(roughness)).arg(error)));
                const float back = brdf(s, {0, 0, 1}, v, out.away).x; // reciprocity
                QVERIFY(std::abs(double(back) / again - 1.0) <= 2.0 * limit);
                const double weight = again * double(out.away.z) / double(scatterPdf(s, {0, 0, 1}, out.away, v));
                QVERIFY(std::abs(double(out.weight.x) / weight - 1.0) <= 2.0 * limit);
            }
        }
    }

    void scatterFollowsItsDensity_data()
    {
        QTest::addColumn<bool>("isMixed");
        QTest::addColumn<float>("roughness");
        QTest::addColumn<double>("eyeDeg");
        for (const bool mixed : {false, true}) {
            for (const float r : {0.25f, 0.6f, 1.0f}) {
                for (const double deg : {0.0, 50.0, 85.0}) {
                    QTest::addRow("%s r=%g at %g", mixed ? "half" : "metal", double(r), deg) << mixed << r << deg;
                }
            }
        }
    }
    /// Moments of the directions picked = integrals of the told density, which uniform directions find; and the mean
    /// weight = the reflectance, found the same way. Directions lost below the surface are missing from both.
    void scatterFollowsItsDensity()
    {
        QFETCH(bool, isMixed);
        QFETCH(float, roughness);
        QFETCH(double, eyeDeg);
        const Surface s = isMixed ? half(roughness) : metal(roughness);
        const glm::vec3 n = glm::normalize(glm::vec3(0.3f, -0.5f, 0.8f)), v = Frame(n).toWorld(eyeAt(eyeDeg));
        const glm::vec3 axis = glm::normalize(glm::vec3(1, 2, 3));
        RunningMean all, tilt, square, reflected, allAgain, tiltAgain, squareAgain, reflectedAgain;
        for (std::uint64_t i = 0; i < 300'000; ++i) {
            Rng rng(3, 4, i);
            const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
            Scatter out;
            const bool lives = scatter(s, n, v, u, out);
            const double t = lives ? double(glm::dot(out.away, axis)) : 0.0;
            all.add(lives ? 1.0 : 0.0);
            tilt.add(t);
            square.add(t * t);
            reflected.add(lives ? double(out.weight.x) : 0.0);
            QVERIFY(!lives || (glm::dot(out.away, n) > 0.0f && out.pdf > 0.0f && !out.isMirror));

            const float u1 = rng.uniform(), u2 = rng.uniform();
            // around the mirrored eye, half of the time, so that narrow lobes are found too
            const glm::vec3 mirrored = 2.0f * glm::dot(n, v) * n - v;
            const float spread = 0.6f;
            const glm::vec3 w =
                rng.uniform() < 0.5f ? Frame(mirrored).toWorld(sampleCone(u1, u2, spread)) : sampleSphere(u1, u2);
            const double cone = glm::dot(w, mirrored) >= spread ? 1.0 / (2.0 * kPiD * (1.0 - double(spread))) : 0.0;
            const double guide = 0.5 * cone + 0.5 / (4.0 * kPiD);
            const double density = double(scatterPdf(s, n, w, v)) / guide, ta = double(glm::dot(w, axis));
            allAgain.add(density);
            tiltAgain.add(density * ta);
            squareAgain.add(density * ta * ta);
            const double cosine = std::max(0.0, double(glm::dot(n, w)));
            reflectedAgain.add(double(brdf(s, n, w, v).x) * cosine / guide);
        }
        const auto agree = [&](const RunningMean& a, const RunningMean& b, const char* what) {
            const double error = std::abs(a.mean() - b.mean());
            const double limit = kZ * std::hypot(a.standardError(), b.standardError()) + 1e-6;
            QVERIFY2(error <= limit, qPrintable(QString("%1: %2 and %3").arg(what).arg(a.mean()).arg(b.mean())));
        };
        agree(all, allAgain, "share that leaves");
        agree(tilt, tiltAgain, "mean");
        agree(square, squareAgain, "second moment");
        agree(reflected, reflectedAgain, "reflectance");
    }

    void furnace_data()
    {
        QTest::addColumn<float>("roughness");
        for (const float r : {0.0f, 0.04f, 0.06f, 0.1f, 0.3f, 0.6f, 1.0f}) QTest::addRow("%g", double(r)) << r;
    }
    void furnace() // no path gains: weights stay below 1, at the best metal and at grazing angles too
    {
        QFETCH(float, roughness);
        for (const double deg : {0.0, 30.0, 60.0, 80.0, 89.0, 89.99}) {
            for (const bool mixed : {false, true}) {
                Surface s = mixed ? half(roughness) : metal(roughness, glm::vec3(kLargestAlbedo));
                RunningMean sum;
                float most = 0.0f;
                for (std::uint64_t i = 0; i < 20'000; ++i) {
                    Rng rng(5, 6, i);
                    const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
                    Scatter out;
                    const bool lives = scatter(s, {0, 0, 1}, eyeAt(deg), u, out);
                    sum.add(lives ? double(out.weight.x) : 0.0);
                    if (lives) most = std::max(most, out.weight.x);
                    QVERIFY(!lives || isFinite(out.weight));
                }
                const QString what = QString("at %1: mean %2, most %3").arg(deg).arg(sum.mean()).arg(double(most));
                QVERIFY2(sum.mean() <= 1.0, qPrintable(what));
                if (!mixed) QVERIFY2(most <= 0.9901f, qPrintable(what));
                // smooth metals lose nothing; rough ones lose what bounces twice in the microfacets
                if (!mixed && roughness <= 0.1f && deg <= 60.0) QVERIFY2(sum.mean() >= 0.985, qPrintable(what));
            }
        }
    }

    void mattSurfacesAreExact()
    {
        Surface s;
        s.diffuse = {0.2f, 0.5f, 0.7f};
        RunningMean square;
        for (std::uint64_t i = 0; i < 100'000; ++i) {
            Rng rng(7, 8, i);
            const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
            Scatter out;
            QVERIFY(scatter(s, {0, 0, 1}, eyeAt(40), u, out));
            QCOMPARE(out.weight, s.diffuse);
            square.add(double(out.away.z) * double(out.away.z));
        }
        VERIFY_MEAN(square, 0.5, kZ, "cosine law");
    }

    void mirrorsMirror() // below the limit: one direction, Fresnel's share, unseen by brdf and density
    {
        const glm::vec3 n = glm::normalize(glm::vec3(1, 1, 0)), v = glm::normalize(glm::vec3(1, 0.2f, 0.3f));
        const Surface s = metal(0.049f, {0.9f, 0.5f, 0.1f});
        QVERIFY(s.isMirror());
        Scatter out;
        QVERIFY(scatter(s, n, v, {0.3f, 0.6f, 0.9f}, out));
        QVERIFY(out.isMirror && out.isSpecular && out.pdf == 0.0f);
        QVERIFY(glm::length(out.away - (2.0f * glm::dot(n, v) * n - v)) <= 1e-6f);
        const float m = std::pow(1.0f - glm::dot(n, v), 5.0f);
        QVERIFY(glm::length(out.weight - (s.specular + (glm::vec3(kLargestAlbedo) - s.specular) * m)) <= 1e-5f);
        QCOMPARE(brdf(s, n, out.away, v), glm::vec3(0));
        QCOMPARE(scatterPdf(s, n, out.away, v), 0.0f);
        QVERIFY(!scatter(s, -n, v, {0.3f, 0.6f, 0.9f}, out)); // from behind its own normal
    }

    void halfMirrorsShareOut() // both lobes together reflect what the formulas say
    {
        const Surface s = half(0.0f);
        RunningMean mirror, matt;
        for (std::uint64_t i = 0; i < 100'000; ++i) {
            Rng rng(9, 10, i);
            const glm::vec3 u(rng.uniform(), rng.uniform(), rng.uniform());
            Scatter out;
            QVERIFY(scatter(s, {0, 0, 1}, eyeAt(70), u, out));
            mirror.add(out.isMirror ? double(out.weight.x) : 0.0);
            matt.add(out.isMirror ? 0.0 : double(out.weight.x));
        }
        const double m = std::pow(1.0 - double(eyeAt(70).z), 5.0);
        VERIFY_MEAN(mirror, 0.4 + (0.5 * 0.99 - 0.4) * m, kZ, "mirror");
        VERIFY_MEAN(matt, 0.4, kZ, "matt");
    }

    void blackReflectsNothing() // black paint and glTF's default metal in black
    {
        Scatter out;
        QVERIFY(!scatter(Surface{}, {0, 0, 1}, {0, 0, 1}, {0.1f, 0.2f, 0.3f}, out));
        QVERIFY(!scatter(metal(0.5f, glm::vec3(0)), {0, 0, 1}, eyeAt(89), {0.1f, 0.2f, 0.3f}, out));
        QCOMPARE(brdf(metal(0.5f, glm::vec3(0)), {0, 0, 1}, eyeAt(80), eyeAt(80)), glm::vec3(0));
    }
};

QTEST_APPLESS_MAIN(MaterialTest)
#include "tst_material.moc"
