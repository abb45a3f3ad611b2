// SPDX-License-Identifier: Apache-2.0
// Claims: means over neighbours keep what is even and what rises evenly, take most of noise away, and mix neither the
// sides of a wall nor steps nor walls that meet; slivers take the mean by area of what they are joined to, which keeps
// the flux of each group; both are the same on any number of threads.
#include "core/base/sampling.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/transport/entry_means.h"
#include "voxel_helpers.h"
#include <QtTest>
#include <limits>

using namespace lightloom;
using namespace lightloom::test;

namespace {

std::shared_ptr<const EntryMeans> neighbours(const Voxels& voxels, int threads = 2)
{
    Workers workers(threads);
    return neighbourMeans(*voxels.surface, workers, {});
}
std::shared_ptr<const EntryMeans> slivers(const Voxels& voxels, float share, int threads = 2)
{
    Workers workers(threads);
    return sliverMeans(*voxels.surface, share, workers, {});
}
constexpr float kAll = std::numeric_limits<float>::infinity();

/// Of grey light.
std::vector<float> meansOf(const EntryMeans& means, const std::vector<float>& values, float within = kAll,
                           int threads = 2)
{
    EntryValues light;
    for (const float v : values) light.values.insert(light.values.end(), 3, v);
    Workers workers(threads);
    std::vector<float> first;
    for (std::size_t e = 0; const float v : means.of(light, within, workers, {}).values)
        if (e++ % 3 == 0) first.push_back(v);
    return first;
}
template<class Value>
std::vector<float> valuesOf(const Voxels& voxels, Value value)
{
    std::vector<float> values;
    for (const Orientation& o : voxels.entries()) values.push_back(static_cast<float>(value(o)));
    return values;
}

/// A room, a wall of 1 mm through its middle, a step of 1.2 voxels.
Scene edges()
{
    SceneBuilder builder("edges");
    const int white = builder.addMaterial("white", glm::vec3(0.6f));
    builder.add("Room", boxMesh({0.0f, 0.0f, 0.0f}, {4.0f, 2.0f, 2.0f}, Facing::in), white);
    builder.add("Wall", boxMesh({2.0f, -0.1f, -0.1f}, {2.001f, 2.1f, 2.1f}, Facing::out), white);
    builder.add("Step", boxMesh({0.5f, -0.1f, 0.5f}, {1.5f, 0.08f, 1.5f}, Facing::out), white);
    builder.addPoint("Left", {1.0f, 1.0f, 1.0f}, glm::vec3(1.0f));
    builder.addPoint("Right", {3.0f, 1.0f, 1.0f}, glm::vec3(1.0f));
    return builder.finish();
}

} // namespace

class EntryMeansTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void whatIsEvenStays()
    {
        const Voxels voxels(twoRooms(), 40, 0.3f);
        const std::vector<float> even = valuesOf(voxels, [](const auto&) { return 3.0; });
        for (const auto& means : {neighbours(voxels), slivers(voxels, 0.2f)})
            for (const float v : meansOf(*means, even)) QVERIFY(std::abs(v - 3.0f) <= 1e-5f);
    }

    void whatRisesEvenlyStays() // on a wall, two cells from its rim; cells of a wall all have the same area then
    {
        const Voxels voxels(furnaceBox(0.5f, 1.0f, {2.0f, 2.0f, 2.0f}), 32);
        const auto rising = [](const Orientation& o) {
            return 5.0f + o.centroid.x + 2.0f * o.centroid.y - o.centroid.z;
        };
        const std::vector<float> means = meansOf(*neighbours(voxels), valuesOf(voxels, rising));
        const float rim = 1.0f - 3.0f * voxels.surface->cellSize();
        int inner = 0;
        for (std::size_t e = 0; e < voxels.entries().size(); ++e) {
            const Orientation& o = voxels.entries()[e];
            const glm::vec3 along = glm::abs(o.centroid) * (1.0f - glm::abs(o.normal));
            if (glm::max(along.x, glm::max(along.y, along.z)) > rim) continue;
            ++inner;
            const float off = means[e] - rising(o);
            QVERIFY2(std::abs(off) <= 1e-5f, qPrintable(QString("off by %1").arg(off)));
        }
        QVERIFY(inner > 2000);
    }

    void noiseFades() // a tent of 1 2 1 along two axes leaves 3/8 of independent noise
    {
        const Voxels voxels(furnaceBox(0.5f, 1.0f, {2.0f, 2.0f, 2.0f}), 32);
        Rng rng(1, 2, 3);
        const std::vector<float> noise = valuesOf(voxels, [&](const auto&) { return rng.uniform() - 0.5f; });
        const std::vector<float> means = meansOf(*neighbours(voxels), noise);
        double before = 0.0, after = 0.0;
        for (std::size_t e = 0; e < noise.size(); ++e) {
            before += static_cast<double>(noise[e] * noise[e]);
            after += static_cast<double>(means[e] * means[e]);
        }
        const double left = std::sqrt(after / before);
        qInfo("%.4f of the noise is left", left);
        QVERIFY(left >= 0.36 && left <= 0.42); // a little more at rims, which have fewer neighbours
    }

    void edgesOfLightStay() // beside ripples that go
    {
        const Voxels voxels(furnaceBox(0.5f, 1.0f, {2.0f, 2.0f, 2.0f}), 32);
        const float cell = voxels.surface->cellSize();
        const auto lit = [&](const Orientation& o) { return o.centroid.x + o.centroid.z > 0.1f ? 2.0f : 1.0f; };
        const auto ripple = [&](const Orientation& o) {
            return 0.02f * std::cos(3.14159f * std::floor((o.centroid.x + o.centroid.y + o.centroid.z) / cell));
        };
        const std::vector<float> light =
            valuesOf(voxels, [&](const Orientation& o) { return lit(o) * (1.0f + ripple(o)); });
        const std::vector<float> means = meansOf(*neighbours(voxels), light, 0.3f);
        double before = 0.0, after = 0.0;
        for (std::size_t e = 0; e < light.size(); ++e) {
            const float clear = lit(voxels.entries()[e]);
            before += static_cast<double>((light[e] / clear - 1.0f) * (light[e] / clear - 1.0f));
            after += static_cast<double>((means[e] / clear - 1.0f) * (means[e] / clear - 1.0f));
            QVERIFY(std::abs(means[e] / clear - 1.0f) <= 0.02f);
        }
        qInfo("%.3f of the ripples are left", std::sqrt(after / before));
        QVERIFY(after <= 0.1 * before);
    }

    void surfacesDoNotMix()
    {
        const Voxels voxels(edges(), 64, 0.25f); // cells of 6.4 cm
        const std::pair<const char*, std::function<bool(const Orientation&)>> parts[] = {
            {"left of the wall", [](const Orientation& o) { return o.centroid.x < 2.0005f && o.normal.x < -0.9f; }},
            {"on the step", [](const Orientation& o) { return o.centroid.y > 0.05f && o.normal.y > 0.9f; }},
            {"a wall", [](const Orientation& o) { return o.normal.z > 0.9f; }}};
        for (const auto& [name, isPart] : parts) {
            const std::vector<float> part = valuesOf(voxels, [&](const auto& o) { return isPart(o) ? 1.0 : 0.0; });
            QVERIFY(std::ranges::count(part, 1.0f) > 50);
            const std::vector<float> means = meansOf(*neighbours(voxels), part);
            for (std::size_t e = 0; e < part.size(); ++e) QVERIFY2(std::abs(means[e] - part[e]) <= 1e-5f, name);
        }
    }

    void sliversTakeTheMean()
    {
        const Voxels voxels(twoRooms(), 40, 0.3f);
        constexpr float kShare = 0.2f;
        const float least = kShare * voxels.surface->cellSize() * voxels.surface->cellSize();
        Rng rng(1, 2, 3);
        const std::vector<float> values = valuesOf(voxels, [&](const auto&) { return rng.uniform(); });
        const auto slivers = ::slivers(voxels, kShare);
        const std::vector<float> means = meansOf(*slivers, values);
        double before = 0.0, after = 0.0;
        int joined = 0, small = 0;
        for (std::uint32_t e = 0; e < values.size(); ++e) {
            const auto area = static_cast<double>(voxels.entries()[e].area);
            before += area * static_cast<double>(values[e]);
            after += area * static_cast<double>(means[e]);
            double sum = 0.0, areas = 0.0;
            int large = 0;
            for (std::uint32_t i = slivers->first[e]; i < slivers->first[e + 1]; ++i) {
                const Orientation& o = voxels.entries()[slivers->from[i]];
                QVERIFY(glm::dot(o.normal, voxels.entries()[e].normal) >= 0.0f);
                sum += static_cast<double>(o.area * values[slivers->from[i]]);
                areas += static_cast<double>(o.area);
                large += o.area >= least;
            }
            QVERIFY(large <= 1);
            QVERIFY(std::abs(sum / areas - static_cast<double>(means[e])) <= 1e-5);
            small += voxels.entries()[e].area < least;
            joined += voxels.entries()[e].area < least && large == 1;
        }
        qInfo("%d of %d slivers joined", joined, small);
        QVERIFY(joined > 20 && joined > small / 2);
        QVERIFY(std::abs(after / before - 1.0) <= 1e-6);
    }

    void threadsDoNotMatter()
    {
        const Voxels voxels(twoRooms(), 40, 0.3f);
        Rng rng(1, 2, 3);
        const std::vector<float> values = valuesOf(voxels, [&](const auto&) { return rng.uniform(); });
        for (const float within : {0.3f, kAll})
            QCOMPARE(meansOf(*neighbours(voxels, 1), values, within, 1),
                     meansOf(*neighbours(voxels, 3), values, within, 3));
        QCOMPARE(meansOf(*slivers(voxels, 0.1f, 1), values, kAll, 1),
                 meansOf(*slivers(voxels, 0.1f, 3), values, kAll, 3));
    }
};

QTEST_APPLESS_MAIN(EntryMeansTest)
#include "tst_entry_means.moc"
