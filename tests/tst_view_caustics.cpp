// SPDX-License-Identifier: Apache-2.0
// Claim: path-traced pictures have the light of small lamps by way of mirrors, once: on the floor before a plane mirror
// it is what the lamp's image gives, pixel by pixel within the errors told; a small panel's is what paths alone find.
// The same bits on any threads, through a stop, and from disk.
#include "core/bake/render_view.h"
#include "core/bake/view_caustics.h"
#include "core/compare/reference_store.h"
#include "tests/mirror_scene.h"
#include "tests/view_helpers.h"
#include <QTemporaryDir>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr float kFloor = 0.02f; ///< albedo: what the floor sends on hardly counts

/// Looks down on the floor before the mirror.
ViewJob job(int samples, float target = 0.0f, std::uint64_t seed = 1)
{
    ViewJob job;
    job.camera.position = {0.9f, 1.9f, 0.0f};
    job.camera.orientation = glm::quatLookAt(glm::vec3(0, -1, 0), glm::vec3(0, 0, -1));
    job.camera.yFov = 0.4f;
    job.width = 24;
    job.height = 18;
    job.indirect = ViewJob::Indirect::paths;
    job.samples = samples;
    job.targetError = target;
    job.seed = seed;
    return job;
}

View render(const LitScene& lit, const ViewJob& job, int threads = 2)
{
    Workers workers(threads);
    return renderView(*lit.rays, *lit.lights, {}, nullptr, job, workers, {});
}

} // namespace

class ViewCausticsTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void theImageOfALampLightsTheFloor_data()
    {
        QTest::addColumn<int>("samples");
        QTest::addColumn<float>("target");
        QTest::newRow("even") << 128 << 0.0f;
        QTest::newRow("to a target") << 64 << 0.5f;
    }
    void theImageOfALampLightsTheFloor()
    {
        QFETCH(int, samples);
        QFETCH(float, target);
        const MirrorScene mirror(0.0f, 100.0f, kFloor);
        ViewJob with = job(samples, target), without = with;
        without.caustics = false;
        const View seen = render(mirror.lit, with), bare = render(mirror.lit, without);
        QVERIFY(seen.isWhole && seen.causticRounds == causticRounds(with) && bare.causticRounds == 0);
        const Lens lens(with);
        RunningMean ratio, squaredZ;
        for (int i = 0; i < with.width * with.height; ++i) {
            glm::vec3 origin, travel;
            lens.ray(i % with.width, i / with.width, {0.5f, 0.5f}, origin, travel);
            const glm::vec3 p = origin - travel * (origin.y / travel.y);
            const auto at = static_cast<std::size_t>(i);
            const double found = double(seen.indirect.pixels[at].x - bare.indirect.pixels[at].x);
            const double expected = double(kFloor) / kPiD * MirrorScene::exact(double(p.x), double(p.z));
            const double paths = double(bare.standardError.pixels[at].x),
                         error = std::sqrt(
                             std::max(0.0, std::pow(double(seen.standardError.pixels[at].x), 2) - paths * paths));
            if (!(expected > 0.0) || p.x > 1.35f || std::abs(p.z) > 1.7f)
                continue; // the edge of what the mirror lights
            ratio.add(found / expected);
            squaredZ.add(std::pow((found - expected) / error, 2));
        }
        QVERIFY2(ratio.count() > 200, qPrintable(QString::number(ratio.count())));
        // discs of one round share photons with their neighbours: the mean is not as good as its pixels are many
        QVERIFY2(std::abs(ratio.mean() - 1.0) <= 0.01, qPrintable(QString::number(ratio.mean())));
        QVERIFY2(squaredZ.mean() >= 0.7 && squaredZ.mean() <= 1.4, qPrintable(QString::number(squaredZ.mean())));
    }

    void aSmallPanelComesOnce()
    {
        const MirrorScene small(0.085f, 100.0f, kFloor);
        ViewJob photons = job(128), paths = job(100'000);
        paths.caustics = false;
        photons.width = paths.width = 6;
        photons.height = paths.height = 4;
        const View a = render(small.lit, photons), b = render(small.lit, paths);
        QVERIFY(a.causticRounds == 128 && b.causticRounds == 0);
        double difference = 0.0, variance = 0.0, all = 0.0;
        for (std::size_t i = 0; i < a.indirect.pixels.size(); ++i) {
            difference += double(a.indirect.pixels[i].x - b.indirect.pixels[i].x);
            all += double(b.indirect.pixels[i].x);
            variance += std::pow(double(b.standardError.pixels[i].x), 2);
        }
        const double error = std::sqrt(variance) / all;
        QVERIFY2(error <= 0.06, qPrintable(QString::number(error)));
        QVERIFY2(std::abs(difference / all) <= 3.9 * error,
                 qPrintable(QString("%1 +- %2").arg(difference / all).arg(error)));
    }

    void sameBitsOnAnyThreadsAndThroughAStop()
    {
        const MirrorScene mirror(0.0f, 100.0f, kFloor);
        const ViewJob asked = job(16);
        const View one = render(mirror.lit, asked, 1), three = render(mirror.lit, asked, 3);
        QVERIFY(one.isWhole && sameBits(one, three));
        for (const double until : {0.3, 0.8}) {
            Workers workers(2);
            ViewState state;
            std::stop_source stop;
            const View part = continueView(*mirror.lit.rays, *mirror.lit.lights, {}, nullptr, asked, state, workers,
                                           stop.get_token(), [&](double f) {
                                               if (f > until) stop.request_stop();
                                           });
            QVERIFY(!part.isWhole && state.causticRounds < 16 && (state.causticRounds > 0) == (until > 0.5));
            const View on = continueView(*mirror.lit.rays, *mirror.lit.lights, {}, nullptr, asked, state, workers, {});
            QVERIFY(sameBits(on, one));
        }
    }

    void fromDisk()
    {
        const MirrorScene mirror(0.0f, 100.0f, kFloor);
        QTemporaryDir folder;
        const std::filesystem::path scene = folder.filePath("scene.glb").toStdString();
        for (const ViewJob& asked : {job(16), job(16, 0.5f)}) {
            Workers workers(2);
            const auto get = [&](const ReferenceStore& store) {
                return store.picture(*mirror.lit.rays, *mirror.lit.lights, {}, asked, ReferenceMatch::sameBits, workers,
                                     {});
            };
            const KeptView made = get(ReferenceStore(scene)), found = get(ReferenceStore(scene));
            QVERIFY(!made.wasStored && found.wasStored && made.result.causticRounds > 0);
            QVERIFY(sameBits(made.result, found.result));
        }
    }
};

QTEST_APPLESS_MAIN(ViewCausticsTest)
#include "tst_view_caustics.moc"
