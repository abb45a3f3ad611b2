// SPDX-License-Identifier: Apache-2.0
// Claims: the noise a bake states without any reference is the spread that other seeds show; it scales with the lamps
// and is unknown in mid-air.
#include "bake_helpers.h"
#include "core/base/statistics.h"
#include "core/base/units.h"
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
    double spreadOverStated() const
    {
        std::vector<RunningMean> values(points_.size());
        double stated = 0.0, spread = 0.0;
        SomeSolver solver;
        BakeProducts products;
        BakeParams params = smallBake();
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
        const double ratio = spreadOverStated<PhotonMapSolver>();
        qInfo("variance over seeds / stated: %.3f", ratio);
        QVERIFY(std::abs(ratio - 1.0) <= 0.1);
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
};

QTEST_APPLESS_MAIN(NoiseTest)
#include "tst_noise.moc"
