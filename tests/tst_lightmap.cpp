// SPDX-License-Identifier: Apache-2.0
// Claims: a lightmap holds lux: what the field says (and exact direct light) at each texel; texels without an answer
// continue their chart and no other; lookups on the surface give the field back; the same bits on any number of
// threads; a stop leaves nothing.
#include "core/atlas/lightmap.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "tests/atlas_helpers.h"
#include "tests/bake_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

using Answer = std::function<bool(glm::vec3 p, glm::vec3 n, glm::vec3& lux)>;

class MadeUpField final : public IndirectField {
public:
    explicit MadeUpField(Answer answer) : answer_(std::move(answer)) {}
    bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override { return answer_(p, n, lux); }
    std::shared_ptr<const IndirectField> withMix(Mix) const override { return nullptr; }
    std::string_view method() const override { return "made up"; }
    std::size_t memoryBytes() const override { return 0; }

private:
    Answer answer_;
};

FloatImage baked(const Unwrapped& u, const IndirectField* field, const DirectInLightmap& direct = {}, int threads = 2)
{
    Workers workers(threads);
    const auto image = bakeLightmap(*u.lit.rays, *u.atlas, field, direct, workers, {});
    if (!image) qFatal("the lightmap was not baked");
    return *image;
}

Scene floorScene(const std::function<void(SceneBuilder&)>& add)
{
    SceneBuilder builder("floor");
    builder.add("Floor", quadMesh({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}), builder.addMaterial("grey", glm::vec3(0.5f)));
    add(builder);
    return builder.finish();
}

} // namespace

class LightmapTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void everyOwnedTexelIsFilled()
    {
        const Unwrapped u(*figureScene(2000), {256});
        const MadeUpField field([](glm::vec3, glm::vec3, glm::vec3& lux) { return lux = {1, 2, 3}, true; });
        const FloatImage image = baked(u, &field);
        std::size_t owned = 0;
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            const bool isOwned = u.atlas->owners[i] >= 0;
            owned += isOwned;
            QCOMPARE(image.pixels[i], isOwned ? glm::vec3(1, 2, 3) : glm::vec3(0.0f));
        }
        QVERIFY(owned > u.atlas->texels.size() && u.atlas->texels.size() > 10'000);
    }

    void lookupsGiveTheFieldBack() // linear light: bilinear reading is exact but for clamped border texels
    {
        const Unwrapped u(floorScene([](SceneBuilder& b) { b.addPoint("Lamp", {0, 1, 0}, glm::vec3(1.0f)); }), {128});
        const MadeUpField field([](glm::vec3 p, glm::vec3 n, glm::vec3& lux) {
            lux = glm::vec3(2.0f + p.x, 2.0f + p.z, 5.0f * n.y);
            return true;
        });
        const FloatImage image = baked(u, &field);
        const double texel = 1.0 / u.atlas->report.texelsPerMetre;
        double inside = 0.0, all = 0.0;
        for (std::size_t f = 0; f < u.atlas->sides.size(); ++f) {
            for (int i = 0; i < 5000; ++i) {
                Rng rng(1, f, static_cast<std::uint64_t>(i));
                const float u1 = rng.uniform(), u2 = rng.uniform();
                const glm::vec2 b = sampleTriangle(u1, u2);
                const glm::dvec3 w(1.0 - b.x - b.y, b.x, b.y);
                const glm::dvec3 p = positionAt(u.lit.rays->triangle(u.atlas->sides[f] / 2), w);
                const glm::dvec3 read(bilinear(image, uvAt(u.atlas->uv[f], w)));
                const double error = glm::length(read - glm::dvec3(2.0 + p.x, 2.0 + p.z, 5.0));
                all = std::max(all, error);
                if (1.0 - std::max(std::abs(p.x), std::abs(p.z)) > 1.5 * texel) inside = std::max(inside, error);
            }
        }
        QVERIFY2(inside <= 1e-4, qPrintable(QString::number(inside)));
        QVERIFY2(all <= 0.8 * texel, qPrintable(QString("%1 of %2").arg(all).arg(texel)));
    }

    void directLightIsExact() // E = I cos / d^2 of a point lamp one metre up
    {
        const Unwrapped u(floorScene([](SceneBuilder& b) { b.addPoint("Lamp", {0, 1, 0}, {3, 2, 1}); }), {64});
        const FloatImage image = baked(u, nullptr, {u.lit.lights.get(), 16, 1});
        double worst = 0.0;
        for (const SurfaceTexel& t : u.atlas->texels) {
            const double d2 = 1.0 + double(t.position.x) * t.position.x + double(t.position.z) * t.position.z;
            const double expected = 3.0 / (d2 * std::sqrt(d2));
            worst = std::max(worst, std::abs(image.pixels[t.texel].x / expected - 1.0));
            QVERIFY(std::abs(image.pixels[t.texel].z * 3.0f - image.pixels[t.texel].x) <= 1e-5f);
        }
        QVERIFY2(worst <= 1e-5, qPrintable(QString::number(worst)));
    }

    void directAndIndirectAddUp()
    {
        const Unwrapped u(floorScene([](SceneBuilder& b) { b.addPoint("Lamp", {0, 1, 0}, {3, 2, 1}); }), {64});
        const MadeUpField field([](glm::vec3, glm::vec3, glm::vec3& lux) { return lux = {4, 5, 6}, true; });
        const DirectInLightmap direct{u.lit.lights.get(), 16, 1};
        const FloatImage sum = baked(u, &field, direct), alone = baked(u, nullptr, direct);
        for (const SurfaceTexel& t : u.atlas->texels) {
            const glm::vec3 difference = sum.pixels[t.texel] - alone.pixels[t.texel] - glm::vec3(4, 5, 6);
            QVERIFY(glm::length(difference) <= 1e-5f);
        }
    }

    void unknownTexelsContinueTheirOwnChart()
    {
        const Unwrapped u(inTwoColours(), {128});
        // one colour per sheet, known on their left halves only
        const MadeUpField field([](glm::vec3 p, glm::vec3, glm::vec3& lux) {
            const bool isUpper = p.y > 0.5f;
            lux = isUpper ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 7);
            return p.x < 0.0f;
        });
        const FloatImage image = baked(u, &field);
        for (const SurfaceTexel& t : u.atlas->texels) {
            const glm::vec3 expected = t.position.y > 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 7);
            QVERIFY(glm::length(image.pixels[t.texel] - expected) <= 1e-6f);
        }
        // nothing known at all: black, and no division by zero
        const MadeUpField nothing([](glm::vec3, glm::vec3, glm::vec3& lux) { return lux = glm::vec3(0.0f), false; });
        for (const glm::vec3 pixel : baked(u, &nothing).pixels) QCOMPARE(pixel, glm::vec3(0.0f));
    }

    void bakedOctreeIsReadBack()
    {
        const Unwrapped u(*sampleScene("cornell"), {512});
        BakeParams params;
        params.photonCount = 60'000;
        const Baked bake = bakeOctree(u.lit.scene, params);
        QVERIFY2(bake.field, bake.error.c_str());
        const FloatImage image = baked(u, bake.field.get());
        double squares = 0.0, mean = 0.0;
        int count = 0;
        for (const SurfacePoint& point : samplePoints(*u.lit.rays, *u.lit.lights, *u.reach, 4000, 1)) {
            const auto place = u.atlas->find(2 * point.triangle);
            glm::vec3 expected;
            if (!place || glm::dot(point.normal, u.lit.rays->triangleNormal(point.triangle)) < 0.0f ||
                !bake.field->lookup(point.position, point.normal, expected)) {
                continue;
            }
            const SceneTriangle& t = u.lit.rays->triangle(point.triangle);
            const glm::dvec3 a(t.a), across = glm::cross(glm::dvec3(t.b) - a, glm::dvec3(t.c) - a);
            const glm::dvec3 p(point.position);
            const auto weight = [&](glm::vec3 from, glm::vec3 to) {
                return glm::dot(glm::cross(glm::dvec3(to) - glm::dvec3(from), p - glm::dvec3(from)), across) /
                       glm::dot(across, across);
            };
            const glm::dvec3 w(weight(t.b, t.c), weight(t.c, t.a), weight(t.a, t.b));
            const glm::vec3 read = bilinear(image, uvAt(u.atlas->uv[*place], w));
            squares += glm::dot(glm::dvec3(read - expected), glm::dvec3(read - expected));
            mean += glm::length(glm::dvec3(expected));
            ++count;
        }
        QVERIFY2(count > 3000, qPrintable(QString::number(count)));
        const double error = std::sqrt(squares / count) / (mean / count);
        QVERIFY2(error <= 0.02, qPrintable(QString::number(error)));
    }

    void sameOnAnyNumberOfThreads()
    {
        const Unwrapped u(*sampleScene("cornell"), {128});
        BakeParams params;
        params.photonCount = 20'000;
        const Baked bake = bakeOctree(u.lit.scene, params);
        const DirectInLightmap direct{u.lit.lights.get(), 4, 1};
        const FloatImage one = baked(u, bake.field.get(), direct, 1), five = baked(u, bake.field.get(), direct, 5);
        QVERIFY(one.pixels == five.pixels);
    }

    void stopsWhenAsked()
    {
        const Unwrapped u(*sampleScene("cornell"), {512});
        const MadeUpField field([](glm::vec3, glm::vec3, glm::vec3& lux) { return lux = glm::vec3(1.0f), true; });
        Workers workers(2);
        std::stop_source source;
        std::atomic<int> told = 0;
        const auto image = bakeLightmap(*u.lit.rays, *u.atlas, &field, {}, workers, source.get_token(), [&](double f) {
            if (f > 0.0 && f <= 1.0) ++told;
            source.request_stop();
        });
        QVERIFY(!image);
        QVERIFY(told >= 1 && told <= 3);
    }

private:
    static Scene inTwoColours()
    {
        return floorScene([](SceneBuilder& b) {
            b.add("Shelf", quadMesh({-1, 1, -1}, {0, 0, 2}, {2, 0, 0}), b.addMaterial("white", glm::vec3(0.8f)));
            b.addPoint("Lamp", {0, 2, 0}, glm::vec3(10.0f));
            b.addPoint("Under", {0, 0.5f, 0}, glm::vec3(10.0f));
        });
    }
};

QTEST_APPLESS_MAIN(LightmapTest)
#include "tst_lightmap.moc"
