// SPDX-License-Identifier: Apache-2.0
// Claims: the noise a bake states without any reference is the spread that other seeds show; it scales with the lamps
// and is unknown in mid-air;
// the noise map shows it for what each pixel sees.
#include "bake_helpers.h"
#include "core/bake/view_eye.h"
#include "core/base/statistics.h"
#include "core/base/units.h"
#include "core/compare/noise_map.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/scene/sample_scenes.h"
#include "core/trace/light_reach.h"
#include <QTest>
#include <cmath>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr int kSeeds = 32, kPoints = 150;

std::vector<SurfacePoint> pointsOf(const std::shared_ptr<const Scene>& scene)
{
    const auto rays = *RayScene::build(scene);
    const LightSampler lights(rays);
    Workers workers(2);
    return samplePoints(*rays, lights, *LightReach::find(*rays, lights, workers, {}), kPoints, 1);
}

} // namespace

class NoiseTest : public QObject {
    Q_OBJECT

    std::shared_ptr<const Scene> scene_ = share(cornellBox());
    std::vector<SurfacePoint> points_ = pointsOf(scene_);

    static BakeParams smallBake()
    {
        BakeParams params;
        params.photonCount = 20'000;
        params.gatherCount = 100;
        params.octreeDepth = params.octreeFirstDepth = 5;
        return params;
    }

    /// Variance over seeds divided by the variance the bakes state, both summed over the points.
    template<class SomeSolver>
    double spreadOverStated(BakeParams params = smallBake()) const
    {
        std::vector<RunningMean> values(points_.size());
        double stated = 0.0, spread = 0.0;
        SomeSolver solver;
        BakeProducts products;
        for (params.seed = 1; params.seed <= kSeeds; ++params.seed) {
            const auto field = runSolver(solver, {scene_, params, {}}, products).field;
            for (std::size_t i = 0; i < points_.size(); ++i) {
                const glm::vec3 p = points_[i].position, n = points_[i].normal;
                values[i].add(static_cast<double>(luminance(field->irradiance(p, n))));
                const double noise = static_cast<double>(field->noise(p, n).value_or(0.0f));
                stated += noise * noise / kSeeds;
            }
        }
        for (const RunningMean& value : values) spread += value.variance();
        return spread / stated;
    }

private Q_SLOTS:
    void photonMapStatesItsSpread()
    {
        BakeParams plain = smallBake();
        plain.gatherFit = GatherFit::mean, plain.gatherAdapt = Switch::off;
        const double ratio = spreadOverStated<PhotonMapSolver>(plain);
        qInfo("variance over seeds / stated: %.3f", ratio);
        QVERIFY(std::abs(ratio - 1.0) <= 0.1);
        // how far a plane counts is chosen by photons as well: that noise is stated, that of choosing a kernel is not
        const double chosen = spreadOverStated<PhotonMapSolver>();
        qInfo("with planes and adaptive K: %.3f", chosen);
        QVERIFY(std::abs(chosen - 1.0) <= 0.1);
    }
    void octreeStatesItsSpread()
    {
        const double ratio = spreadOverStated<OctreeSolver>();
        qInfo("variance over seeds / stated: %.3f", ratio);
        QVERIFY(std::abs(ratio - 1.0) <= 0.15); // neighbours share photons, though not all of them
    }

    void followsTheLamps()
    {
        const auto baked = bakeOctree(scene_, smallBake());
        const auto bright = baked.field->withMix(Mix(std::vector<glm::vec3>(1, glm::vec3(4.0f)))),
                   off = baked.field->withMix(Mix(std::vector<glm::vec3>(1, glm::vec3(0.0f))));
        for (const SurfacePoint& point : points_) {
            const auto at = [&](const IndirectField& field) { return field.noise(point.position, point.normal); };
            QVERIFY(at(*baked.field) && *at(*baked.field) > 0.0f);
            QVERIFY(std::abs(*at(*bright) / (4.0f * *at(*baked.field)) - 1.0f) <= 1e-5f);
            QCOMPARE(*at(*off), 0.0f);
        }
        QVERIFY(!baked.field->noise(scene_->bounds.centre(), {0, 1, 0})); // mid-air: no answer
    }

    void theMapIsTheNoiseOfWhatPixelsSee()
    {
        constexpr int kWidth = 40, kHeight = 30;
        const auto rays = *RayScene::build(scene_);
        const auto field = bakeOctree(scene_, smallBake()).field;
        Workers workers(2), one(1);
        const Camera& camera = scene_->cameras.front();
        const ScalarImage map = noiseMap(*rays, *field, camera, kWidth, kHeight, workers, {});
        RunningMean light;
        std::vector<float> noise;
        const ViewJob job{camera, kWidth, kHeight};
        const Lens lens(job);
        for (int i = 0; i < kWidth * kHeight; ++i) {
            glm::vec3 origin, travel;
            lens.ray(i % kWidth, i / kWidth, {0.5f, 0.5f}, origin, travel);
            Hit hit;
            noise.push_back(0.0f);
            if (!rays->intersect(origin, travel, 1e9f, hit)) continue;
            if (surfaceAt(*rays, hit).diffuse == glm::vec3(0.0f)) continue; // the lamp itself
            const float lux = luminance(field->irradiance(hit.position, hit.facing()));
            if (lux > 0.0f) light.add(static_cast<double>(lux));
            noise.back() = field->noise(hit.position, hit.facing()).value_or(0.0f);
        }
        for (std::size_t i = 0; i < noise.size(); ++i) {
            const float expected = noise[i] / static_cast<float>(light.mean());
            QVERIFY2(std::abs(map.values[i] - expected) <= 1e-5f * expected, qPrintable(QString::number(i)));
        }
        QVERIFY(std::ranges::count_if(map.values, [](float v) { return v > 0.0f; }) > kWidth * kHeight / 2);
        QVERIFY(noiseMap(*rays, *field, camera, kWidth, kHeight, one, {}).values == map.values);
        std::stop_source stop;
        stop.request_stop();
        QVERIFY(noiseMap(*rays, *field, camera, kWidth, kHeight, workers, stop.get_token()).values.empty());
    }
    void theMapLooksIntoMirrors() // the gallery's ring: as much noise in it as on what it shows
    {
        const auto scene = share(gallery());
        const auto rays = *RayScene::build(scene);
        BakeParams params = smallBake();
        const auto field = bakeOctree(scene, params).field;
        Workers workers(2);
        const auto camera = std::ranges::find(scene->cameras, "Golden ring", &Camera::name);
        QVERIFY(camera != scene->cameras.end());
        const ScalarImage map = noiseMap(*rays, *field, *camera, 80, 60, workers, {});
        const ViewJob job{*camera, 80, 60};
        const Lens lens(job);
        int mirrors = 0, noisy = 0;
        for (int i = 0; i < 80 * 60; ++i) {
            glm::vec3 origin, travel;
            lens.ray(i % 80, i / 80, {0.5f, 0.5f}, origin, travel);
            Hit hit;
            if (!rays->intersect(origin, travel, 1e9f, hit)) continue;
            if (surfaceAt(*rays, hit).diffuse != glm::vec3(0.0f)) continue;
            ++mirrors;
            noisy += map.values[static_cast<std::size_t>(i)] > 0.0f ? 1 : 0;
        }
        QVERIFY2(mirrors > 20 && noisy > mirrors / 2, qPrintable(QString("%1 of %2").arg(noisy).arg(mirrors)));
    }
};

QTEST_APPLESS_MAIN(NoiseTest)
#include "tst_noise.moc"
