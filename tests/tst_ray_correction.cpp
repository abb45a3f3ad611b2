// SPDX-License-Identifier: Apache-2.0
// Claims: where rays say over a neighbourhood what lines do not, lines follow them; noise of rays alone hardly changes
// them; what is hidden does not count, and has the light of what is open around it; nothing becomes negative; light
// groups and threads change no bit; in two rooms with a door light of lines comes nearer to that of many rays; rays
// know what a block hides.
#include "core/base/rng.h"
#include "core/lightcuts/ray_partners.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/voxel/ray_correction.h"
#include "voxel_helpers.h"
#include <QtTest>
#include <cmath>

using namespace lightloom;
using namespace lightloom::test;

namespace {

EntryValues grey(const Voxels& voxels, auto value)
{
    EntryValues light;
    for (std::size_t e = 0; e < voxels.entries().size(); ++e)
        light.values.insert(light.values.end(), 3, static_cast<float>(value(e)));
    return light;
}
EntryValues corrected(const Voxels& voxels, const EntryValues& lines, const EntryValues& rays, int threads = 2)
{
    Workers workers(threads);
    const std::vector<float> open(voxels.entries().size(), 1.0f);
    return correctedByRays(lines, rays, open, *neighbourMeans(*voxels.surface, workers, {}), workers, {});
}
/// RMS over the mean of `truth`.
double off(const EntryValues& values, const EntryValues& truth)
{
    double squares = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < values.values.size(); ++i) {
        squares += std::pow(double(values.values[i]) - double(truth.values[i]), 2.0);
        mean += double(truth.values[i]);
    }
    const auto count = double(values.values.size());
    return std::sqrt(squares / count) / (mean / count);
}

} // namespace

class RayCorrectionTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void linesFollowWhatRaysSayTogether()
    {
        const Voxels voxels(*sampleScene("cornell"), 32);
        const EntryValues lines = grey(voxels, [](std::size_t) { return 1.0; });
        const EntryValues rays = grey(voxels, [](std::size_t) { return 1.2; });
        QVERIFY(off(corrected(voxels, lines, rays), rays) <= 1e-3);
    }

    void noiseAloneHardlyCounts()
    {
        const Voxels voxels(*sampleScene("cornell"), 32);
        Rng rng(1, 2, 3);
        const EntryValues lines = grey(voxels, [](std::size_t) { return 1.0; });
        const EntryValues rays = grey(voxels, [&](std::size_t) { return 0.6 + 0.8 * double(rng.uniform()); });
        const double noise = off(rays, lines), left = off(corrected(voxels, lines, rays), lines);
        qInfo("noise %.3f, left of it %.4f", noise, left);
        QVERIFY(noise > 0.2 && left <= 0.12 * noise); // their means as they are would leave a quarter
    }

    void whatIsHiddenDoesNotCount() // rays find every third entry dark, none of which is in the open
    {
        const Voxels voxels(*sampleScene("cornell"), 32);
        Workers workers(2);
        const auto around = neighbourMeans(*voxels.surface, workers, {});
        const auto isHidden = [](std::size_t e) { return e % 3 == 0; };
        const EntryValues lines = grey(voxels, [&](std::size_t e) { return isHidden(e) ? 0.3 : 1.0; });
        const EntryValues rays = grey(voxels, [&](std::size_t e) { return isHidden(e) ? 0.0 : 1.2; });
        std::vector<float> open;
        for (std::size_t e = 0; e < voxels.entries().size(); ++e) open.push_back(isHidden(e) ? 0.0f : 1.0f);
        const EntryValues put =
            spreadIntoHidden(correctedByRays(lines, rays, open, *around, workers, {}), open, *around, workers, {});
        std::size_t right = 0, alone = 0; // slivers at edges have no open neighbours
        for (std::size_t e = 0; e < open.size(); ++e) {
            right += std::abs(put.values[3 * e] - 1.2f) <= 1e-3f;
            alone += isHidden(e) && std::abs(put.values[3 * e] - 1.2f) > 1e-3f;
        }
        qInfo("%zu of %zu right, %zu of the others hidden", right, open.size(), alone);
        QVERIFY(right > open.size() * 98 / 100 && right + alone == open.size());
        Workers three(3);
        QCOMPARE(spreadIntoHidden(lines, open, *around, three, {}).values,
                 spreadIntoHidden(lines, open, *around, workers, {}).values);
    }

    void raysKnowWhatABlockHides()
    {
        constexpr float kEdge = 0.414f; // within a voxel, and within what reach tells apart
        SceneBuilder builder("block");
        const int grey = builder.addMaterial("grey", glm::vec3(0.5f));
        builder.add("Room", boxMesh({0, 0, 0}, {1, 1, 1}, Facing::in), grey);
        builder.add("Block", boxMesh({kEdge, 0, 0.3f}, {0.8f, 0.3f, 0.7f}, Facing::out), grey);
        builder.addPoint("Lamp", {0.2f, 0.9f, 0.5f}, glm::vec3(100.0f));
        const Voxels voxels(builder.finish(), 60);
        Workers workers(2);
        const auto reach = LightReach::find(*voxels.rays, LightSampler(voxels.rays), workers, {});
        const auto rays = RayPartners::trace(*voxels.rays, *reach, *voxels.surface, 64, 1, workers, {});
        const SurfaceVoxels& surface = *voxels.surface;
        const float cell = surface.cellSize();
        double found = 0.0, wanted = 0.0;
        int parted = 0;
        for (std::size_t v = 0; v < surface.voxels.size(); ++v) {
            const glm::vec3 low = surface.lattice.lowest + cell * glm::vec3(surface.voxels[v]);
            for (std::uint32_t e = surface.firstEntry[v]; e < surface.firstEntry[v + 1]; ++e) {
                const Orientation& o = surface.entries[e];
                const bool isBeside = std::abs(o.centroid.z - 0.5f) < 0.12f && low.x < kEdge && low.x + cell > kEdge;
                if (o.centroid.x < 0.3f) QCOMPARE(rays->open()[e], 1.0f);
                if (!isBeside || o.normal.y < 0.9f || o.centroid.y > 0.1f) continue;
                const float open = (kEdge - low.x) * cell / o.area; // reach ends a little further in
                ++parted, found += double(rays->open()[e]), wanted += double(open);
                QVERIFY(std::abs(rays->open()[e] - open) <= 0.2f);
            }
        }
        qInfo("%d voxels at its foot, %.3f of them open, %.3f by area", parted, found / parted, wanted / parted);
        QVERIFY(parted >= 10 && wanted < 0.9 * parted && std::abs(found - wanted) <= 0.03 * parted);
        const EntryValues some{3, std::vector<float>(3 * voxels.entries().size(), 2.0f)};
        const EntryValues back = rays->ofAll(rays->ofOpen(some));
        for (std::size_t i = 0; i < some.values.size(); ++i)
            QVERIFY(rays->open()[i / 3] == 0.0f || std::abs(back.values[i] - 2.0f) <= 1e-5f);
    }

    void nothingBecomesNegative() // where light ends between neighbours, and rays say less
    {
        const Voxels voxels(*sampleScene("cornell"), 32);
        const auto isLit = [&](std::size_t e) { return voxels.entries()[e].centroid.x > 0.3f; };
        const EntryValues lines = grey(voxels, [&](std::size_t e) { return isLit(e) ? 1.0 : 0.001; });
        const EntryValues rays = grey(voxels, [](std::size_t) { return 0.0; });
        const EntryValues made = corrected(voxels, lines, rays);
        for (const float v : made.values) QVERIFY(v >= 0.0f);
        QVERIFY(off(made, lines) > 0.5);
    }

    void groupsAndThreadsChangeNoBit()
    {
        const Voxels voxels(*sampleScene("cornell"), 32);
        Rng rng(4, 5, 6);
        const EntryValues lines = grey(voxels, [](std::size_t) { return 1.0; });
        const EntryValues rays = grey(voxels, [&](std::size_t) { return 1.1 + 0.2 * double(rng.uniform()); });
        const EntryValues one = corrected(voxels, lines, rays, 1);
        QCOMPARE(corrected(voxels, lines, rays, 3).values, one.values);
        EntryValues bothLines{6, {}}, bothRays{6, {}};
        for (std::size_t i = 0; i < lines.values.size(); i += 3) {
            for (const std::size_t times : {1, 7}) {
                for (std::size_t k = 0; k < 3; ++k) {
                    bothLines.values.push_back(lines.values[i + k]);
                    bothRays.values.push_back(rays.values[i + k] * float(times));
                }
            }
        }
        const EntryValues both = corrected(voxels, bothLines, bothRays);
        for (std::size_t i = 0, e = 0; i < both.values.size(); i += 6, e += 3) QCOMPARE(both.values[i], one.values[e]);
    }

    void twoRoomsComeNearerToManyRays()
    {
        const Voxels voxels(*sampleScene("two_rooms"), 48);
        Workers workers(2);
        const auto reach = LightReach::find(*voxels.rays, LightSampler(voxels.rays), workers, {});
        const EntryValues leaving = grey(voxels, [&](std::size_t e) { // a patch of floor in one room shines
            const glm::vec3 at = voxels.entries()[e].centroid;
            return voxels.entries()[e].normal.y > 0.9f && at.y < 0.1f && at.x < 2.5f ? 1.0 : 0.0;
        });
        const std::vector<glm::vec3> albedo(voxels.entries().size(), glm::vec3(0.5f));
        const EntryValues lines = voxels.bounced(leaving, albedo);
        const auto bounced = [&](int count, std::uint64_t seed) {
            return RayPartners::trace(*voxels.rays, *reach, *voxels.surface, count, seed, workers, {})
                ->bounced(leaving, albedo, lines, workers, {});
        };
        const EntryValues truth = bounced(1024, 1);
        const double before = off(lines, truth), after = off(corrected(voxels, lines, bounced(64, 2)), truth);
        qInfo("off by %.4f, corrected %.4f", before, after);
        QVERIFY(after <= 0.9 * before);
    }
};

QTEST_APPLESS_MAIN(RayCorrectionTest)
#include "tst_ray_correction.moc"
