// SPDX-License-Identifier: Apache-2.0
// Claims: a picture made in slices ends in the same bits as one made at once, also when it is kept on disk in between;
// every slice leaves an even picture; a picture's error figures are those of the plain metrics, and an absolute error
// is one of illuminance.
#include "bake_helpers.h"
#include "core/bake/progressive_view.h"
#include "core/compare/reference_store.h"
#include "core/compare/view_error.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "tests/light_helpers.h"
#include "tests/mirror_scene.h"
#include "tests/view_helpers.h"
#include <QTemporaryDir>

using namespace lightloom;
using namespace lightloom::test;

namespace {

struct Lit {
    std::shared_ptr<const Scene> scene = share(*sampleScene("cornell"));
    std::shared_ptr<const RayScene> rays = *RayScene::build(scene);
    std::shared_ptr<const LightSampler> lights = std::make_shared<LightSampler>(rays);

    [[nodiscard]] ViewJob job(int samples, ViewJob::Indirect indirect = ViewJob::Indirect::paths) const
    {
        ViewJob job{scene->cameras[0], 70, 50}; // neither side is a whole number of tiles
        job.indirect = indirect;
        job.samples = samples;
        return job;
    }
    [[nodiscard]] ProgressiveView view(int samples, ViewState state = {}) const
    {
        return {rays, lights, {}, nullptr, job(samples), std::move(state)};
    }
    View render(const ViewJob& job, Workers& workers, const IndirectField* field = nullptr) const
    {
        return renderView(*rays, *lights, {}, field, job, workers, {});
    }
};

} // namespace

class ProgressiveViewTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void slicesEndInTheSameBits()
    {
        Workers workers(3);
        ProgressiveView view = lit_.view(12);
        int slices = 0, last = 0;
        View part;
        while (!view.isWhole()) {
            part = view.advance(0.0, workers, {});
            ++slices;
            QVERIFY2(part.samples == last + 1, qPrintable(QString("%1 after %2").arg(part.samples).arg(last)));
            QCOMPARE(part.rays, std::uint64_t(70 * 50 * part.samples)); // all pixels alike
            last = part.samples;
        }
        QCOMPARE(slices, 12);
        QVERIFY(sameBits(part, lit_.render(lit_.job(12), workers)));
        QVERIFY(view.seconds() > 0.0);
    }

    void photonsByWayOfMirrorsComeInSlicesToo()
    {
        const MirrorScene mirror(0.0f, 100.0f, 0.5f);
        const auto lights = std::make_shared<LightSampler>(mirror.lit.rays);
        ViewJob job = lit_.job(12);
        job.camera.position = {0.9f, 1.9f, 0.0f}; // above the floor that the lamp's image lights
        job.camera.orientation = glm::quatLookAt(glm::vec3(0, -1, 0), glm::vec3(0, 0, -1));
        Workers workers(3);
        ProgressiveView view(mirror.lit.rays, lights, {}, nullptr, job);
        View part;
        int ofPhotons = 0;
        std::uint64_t last = 0;
        while (!view.isWhole()) {
            part = view.advance(0.0, workers, {});
            QCOMPARE(part.rays, std::uint64_t(70 * 50 * part.samples)); // all pixels alike
            QVERIFY(part.causticRounds <= last + 1);
            ofPhotons += part.causticRounds > last ? 1 : 0;
            last = part.causticRounds;
        }
        QCOMPARE(ofPhotons, 12);
        const View whole = renderView(*mirror.lit.rays, *lights, {}, nullptr, job, workers, {});
        QVERIFY(sameBits(part, whole));
    }

    void aStopLosesNothing()
    {
        Workers workers(2);
        ProgressiveView view = lit_.view(8);
        std::stop_source stop;
        stop.request_stop();
        QCOMPARE(view.advance(10.0, workers, stop.get_token()).samples, 0);
        QVERIFY(!view.isWhole());
        View end;
        while (!view.isWhole()) end = view.advance(0.01, workers, {});
        QVERIFY(sameBits(end, lit_.render(lit_.job(8), workers)));
    }

    void slicesAreKeptAndGoneOnWith()
    {
        const QTemporaryDir folder;
        qputenv("XDG_CACHE_HOME", (folder.path() + "/user").toUtf8());
        const ReferenceStore store((folder.path() + "/cornell.glb").toStdString());
        Workers workers(2);
        const auto find = [&](int samples) {
            return store.findPicture(*lit_.rays, {}, lit_.job(samples), ReferenceMatch::asGood);
        };
        QVERIFY(!find(8).kept.wasStored && find(8).state.pixels.empty());
        ProgressiveView begun = lit_.view(8);
        const View part = begun.advance(0.0, workers, {});
        QVERIFY(!store.keepPicture(*lit_.rays, {}, lit_.job(8), part, begun.state()).empty());
        ReferenceStore::FoundView found = find(8);
        QVERIFY(!found.kept.wasStored);
        QCOMPARE(found.kept.resumed, part.rays);
        ProgressiveView on = lit_.view(8, std::move(found.state));
        View end;
        while (!on.isWhole()) end = on.advance(0.0, workers, {});
        QVERIFY(sameBits(end, lit_.render(lit_.job(8), workers)));
        store.keepPicture(*lit_.rays, {}, lit_.job(8), end, on.state());
        QVERIFY(find(8).kept.wasStored && find(4).kept.wasStored && !find(16).kept.wasStored);
        QVERIFY(sameBits(find(8).kept.result, end));
    }

    void errorsAreThoseOfTheMetrics()
    {
        Workers workers(2);
        const Baked baked = bakeOctree(lit_.scene, roughBake());
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        const View reference = lit_.render(lit_.job(32), workers);
        const View picture = lit_.render(lit_.job(8, ViewJob::Indirect::field), workers, baked.field.get());
        const FloatImage matt = mattReflectance(*lit_.rays, lit_.job(8), workers, {});
        // by hand, from the definitions
        double mean = 0, squares = 0, sum = 0;
        const std::vector<double> e = luminances(picture.indirect.pixels), r = luminances(reference.indirect.pixels);
        for (std::size_t i = 0; i < e.size(); ++i) {
            mean += r[i] / double(r.size());
            squares += (e[i] - r[i]) * (e[i] - r[i]) / double(r.size());
            sum += (e[i] - r[i]) / double(r.size());
        }
        for (const ErrorKind kind : {ErrorKind::relative, ErrorKind::absolute, ErrorKind::difference}) {
            const Result<ViewError> error = viewError(picture, reference, kind, matt);
            QVERIFY(error);
            QVERIFY(std::abs(error->metrics.relRmse - std::sqrt(squares) / mean) <= 1e-9);
            QVERIFY(std::abs(error->metrics.bias - sum / mean) <= 1e-9);
            double noise = 0;
            for (const double s : luminances(reference.standardError.pixels)) noise += s * s / double(r.size());
            QVERIFY(noise > 0.0 && std::abs(error->noise - std::sqrt(noise) / mean) <= 1e-9);
            QVERIFY(error->kind == kind && error->top > 0.0f);
            if (kind == ErrorKind::absolute) continue;
            for (std::size_t i = 0; i < e.size(); ++i) {
                const double d = (e[i] - r[i]) / mean, wanted = kind == ErrorKind::relative ? std::abs(d) : d;
                QVERIFY(std::abs(double(error->map.values[i]) - wanted) <= 1e-5 * (1.0 + std::abs(wanted)));
            }
        }
        ViewJob small = lit_.job(1);
        small.width = small.height = 8;
        QVERIFY(!viewError(lit_.render(small, workers), reference, ErrorKind::relative));
    }

    void illuminanceIsThatOfTheField() // whatever colour the surface has
    {
        Workers workers(2);
        const Baked baked = bakeOctree(lit_.scene, roughBake());
        ViewJob job = lit_.job(4, ViewJob::Indirect::field);
        // within the box, above the blocks, so that every pixel is on a surface
        const glm::vec3 size = lit_.scene->bounds.size();
        job.camera.position = lit_.scene->bounds.centre() + glm::vec3(0.0f, 0.25f, 0.45f) * size;
        const FloatImage lux = illuminanceOf(lit_.render(job, workers, baked.field.get()).indirect,
                                             mattReflectance(*lit_.rays, job, workers, {}));
        const glm::mat3 turn = glm::mat3_cast(job.camera.orientation);
        const double tall = std::tan(0.5 * double(job.camera.yFov));
        double worst = 0.0, sum = 0.0;
        int checked = 0;
        for (int y = 0; y < 50; ++y) {
            for (int x = 0; x < 70; ++x) { // through the middle of each pixel, by hand
                const glm::vec3 travel = glm::normalize(
                    turn * glm::vec3((2 * (x + 0.5) / 70 - 1) * tall * 1.4, (1 - 2 * (y + 0.5) / 50) * tall, -1));
                Hit hit;
                glm::vec3 expected(0.0f);
                QVERIFY(lit_.rays->intersect(job.camera.position, travel, 1e30f, hit));
                if (!baked.field->lookup(hit.position, hit.facing(), expected)) continue;
                const double error = std::abs(double(lux.at(x, y).y - expected.y));
                sum += double(expected.y);
                worst = std::max(worst, error);
                checked += error <= 0.05 * double(expected.y) ? 1 : 0; // not where a pixel has two surfaces in it
            }
        }
        QVERIFY2(sum > 0.0 && checked >= 70 * 50 * 9 / 10, qPrintable(QString("%1, %2").arg(checked).arg(worst)));
    }

    void glossHasNoIlluminance()
    {
        const Lit metal{share(*sampleScene("gallery"))};
        Workers workers(2);
        ViewJob job = metal.job(4);
        job.camera = metal.scene->cameras[2]; // the golden ring is in its middle
        const FloatImage matt = mattReflectance(*metal.rays, job, workers, {});
        int black = 0, lit = 0;
        for (const glm::vec3& m : matt.pixels) (m == glm::vec3(0.0f) ? black : lit) += 1;
        QVERIFY2(black > 20 && lit > 1000, qPrintable(QString("%1 %2").arg(black).arg(lit)));
        const FloatImage lux = illuminanceOf(FloatImage(matt), matt);
        for (std::size_t i = 0; i < lux.pixels.size(); ++i)
            QVERIFY(matt.pixels[i] != glm::vec3(0.0f) || lux.pixels[i] == glm::vec3(0.0f));
    }

    void theIndirectLightNeedsNoDirectLight()
    {
        Workers workers(2);
        const Baked baked = bakeOctree(lit_.scene, roughBake());
        ViewJob job = lit_.job(4, ViewJob::Indirect::field);
        const View both = lit_.render(job, workers, baked.field.get());
        job.withDirect = false;
        const View alone = lit_.render(job, workers, baked.field.get());
        int other = 0; // where the field has no answer, rays are drawn from what the direct light left
        for (std::size_t i = 0; i < both.indirect.pixels.size(); ++i) {
            QVERIFY(alone.direct.pixels[i] == glm::vec3(0.0f));
            other += alone.indirect.pixels[i] == both.indirect.pixels[i] ? 0 : 1;
        }
        QVERIFY2(other <= 35, qPrintable(QString::number(other)));
    }

private:
    static BakeParams roughBake()
    {
        BakeParams params;
        params.photonCount = 20'000;
        params.octreeDepth = 4;
        return params;
    }
    Lit lit_;
};

QTEST_APPLESS_MAIN(ProgressiveViewTest)
#include "tst_progressive_view.moc"
