// SPDX-License-Identifier: Apache-2.0
// Claims: photons of a sun are aimed at openings, their weights make up for it everywhere, and nothing is left out.
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/trace/sun_aim.h"
#include <QtTest>
#include <cmath>

using namespace lightloom;

namespace {

/// A hall of 10 x 10 m, 4 m high, whose roof of four slabs leaves a hole of 1 x 1 m in the middle. Seen from above the
/// walls do not show.
std::shared_ptr<const RayScene> hallWithAHole()
{
    SceneBuilder builder("hall");
    const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
    builder.add("Floor", boxMesh({-5.0f, -0.1f, -5.0f}, {5.0f, 0.0f, 5.0f}), grey);
    builder.add("Walls", boxMesh({-5.0f, 0.0f, -5.0f}, {5.0f, 4.0f, -4.9f}), grey);
    builder.add("Roof/1", boxMesh({-5.0f, 4.0f, -5.0f}, {-0.5f, 4.1f, 5.0f}), grey);
    builder.add("Roof/2", boxMesh({0.5f, 4.0f, -5.0f}, {5.0f, 4.1f, 5.0f}), grey);
    builder.add("Roof/3", boxMesh({-0.5f, 4.0f, -5.0f}, {0.5f, 4.1f, -0.5f}), grey);
    builder.add("Roof/4", boxMesh({-0.5f, 4.0f, 0.5f}, {0.5f, 4.1f, 5.0f}), grey);
    return *RayScene::build(std::make_shared<const Scene>(builder.finish()));
}

} // namespace

class SunAimTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void weightsMakeUpForTheAim()
    {
        const auto rays = hallWithAHole();
        const Bounds bounds = rays->scene().bounds;
        const float radius = 0.5f * bounds.diagonal();
        const SunAim aim(*rays, {0.0f, -1.0f, 0.0f}, bounds.centre(), radius);
        const double disc = M_PI * static_cast<double>(radius) * static_cast<double>(radius);
        constexpr int kPhotons = 200'000;
        double through = 0.0, throughSquares = 0.0, roof = 0.0, past = 0.0, all = 0.0;
        int aimed = 0;
        for (int i = 0; i < kPhotons; ++i) {
            Rng rng(3, 4, static_cast<std::uint64_t>(i));
            float weight = 0.0f;
            const glm::vec3 from = aim.pick(rng, weight);
            const auto area = static_cast<double>(weight) * disc / kPhotons; // what the photon stands for, m2
            all += area;
            Hit hit;
            if (!rays->intersect(from, {0.0f, -1.0f, 0.0f}, 100.0f, hit)) {
                past += area;
            } else if (rays->scene().toFile(hit.position).y < 1.0) {
                through += area, throughSquares += area * area, ++aimed;
            } else {
                roof += area;
            }
        }
        // hole, roof and what passes the house by, each as large as it is: 1, 99 m2 and the rest of the disc
        QVERIFY2(std::abs(through - 1.0) <= 4.9 * std::sqrt(throughSquares), qPrintable(QString::number(through)));
        QVERIFY2(std::abs(roof - 99.0) <= 2.0, qPrintable(QString::number(roof)));
        QVERIFY2(std::abs(all - disc) <= 0.01 * disc, qPrintable(QString("%1 of %2").arg(all).arg(disc)));
        QVERIFY(past > 0.8 * (disc - 100.0));
        // shot evenly, one in `disc` photons would go through
        const double share = static_cast<double>(aimed) / kPhotons;
        qInfo("%.1f %% of the photons go through the hole, %.2f %% of the disc", 100.0 * share, 100.0 / disc);
        QVERIFY2(share > 20.0 / disc, qPrintable(QString::number(share)));
    }

    void whereNothingPassesLightOnItIsEven() // a plain floor: all light goes back to the sky
    {
        SceneBuilder builder("floor");
        builder.add("Floor", boxMesh({-5.0f, -0.1f, -5.0f}, {5.0f, 0.0f, 5.0f}),
                    builder.addMaterial("grey", glm::vec3(0.6f)));
        const auto rays = *RayScene::build(std::make_shared<const Scene>(builder.finish()));
        const SunAim aim(*rays, {0.0f, -1.0f, 0.0f}, rays->scene().bounds.centre(), 7.2f);
        for (std::uint64_t i = 0; i < 1000; ++i) {
            Rng rng(3, 4, i);
            float weight = 0.0f;
            const glm::vec3 from = aim.pick(rng, weight);
            QVERIFY(std::abs(weight - 1.0f) <= 1e-6f);
            QVERIFY(std::isfinite(from.x) && glm::length(glm::vec2(from.x, from.z)) <= 7.3f);
        }
    }
};

QTEST_APPLESS_MAIN(SunAimTest)
#include "tst_sun_aim.moc"
