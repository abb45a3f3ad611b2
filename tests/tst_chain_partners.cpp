// SPDX-License-Identifier: Apache-2.0
// Claims of the papers' walk (voxel.lines=paper): whom entries see is what looking through each line one by one says,
// in random voxels, on a single line, in a scene, direction after direction; a wall of several steps does not hide
// itself; rows that are stored hold the same, and bounces have the same bits with them; a closed room keeps its light
// as far as the prototypes' did; a bake takes one entry a voxel.
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/transport/line_slots.h"
#include "core/voxel/voxel_solver.h"
#include "tests/bake_helpers.h"
#include "tests/line_helpers.h"
#include "tests/voxel_helpers.h"
#include <QtTest>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr auto kPaper = VoxelLines::paper;

enum class Faces { forth, back, aside };

Faces facesOf(const SurfaceVoxels& voxels, std::uint32_t i, const LineDirection& d)
{
    const float cosine = glm::dot(voxels.entries[i].normal, d.unit);
    return cosine > kAlongSurface ? Faces::forth : cosine < -kAlongSurface ? Faces::back : Faces::aside;
}

/// The rule as it reads, for each entry by itself: one that faces forth sees the next that faces back. One that faces
/// back looks the other way: where the last that is not aside faces forth it sees that; where it faces back, in one of
/// the two slices before, it sees the same.
std::vector<std::uint32_t> lookedThrough(const SurfaceVoxels& voxels, const LineDirection& d)
{
    std::vector<std::uint32_t> partners(voxels.voxels.size(), PartnerFinder::kNothing);
    for (const std::vector<std::uint32_t>& line : voxelsByLine(voxels, d)) {
        const auto faces = [&](std::size_t i) { return facesOf(voxels, line[i], d); };
        for (std::size_t i = 0; i < line.size(); ++i) {
            if (faces(i) == Faces::forth) {
                for (std::size_t j = line.size(); j-- > i + 1;)
                    if (faces(j) == Faces::back) partners[line[i]] = line[j];
            } else if (faces(i) == Faces::back) {
                for (std::size_t j = 0; j < i; ++j) {
                    const int apart = voxels.voxels[line[i]][d.major] - voxels.voxels[line[j]][d.major];
                    if (faces(j) == Faces::forth)
                        partners[line[i]] = line[j];
                    else if (faces(j) == Faces::back)
                        partners[line[i]] = apart <= 2 ? partners[line[j]] : PartnerFinder::kNothing;
                }
            }
        }
    }
    return partners;
}

/// How many entries have a partner along the directions; -1 where one is another than looking through lines says.
int countLikeLookedThrough(const SurfaceVoxels& voxels, const std::vector<LineDirection>& directions)
{
    const VoxelOrders orders(voxels, kPaper);
    const auto lines = partnerFinder(voxels, orders);
    int count = 0;
    for (const LineDirection& d : directions) {
        const auto found = lines->find(d, 0);
        if (!std::ranges::equal(found, lookedThrough(voxels, d))) return -1;
        count += static_cast<int>(found.size() - std::size_t(std::ranges::count(found, PartnerFinder::kNothing)));
    }
    return count;
}

/// A normal in any direction, one in four along an axis: some lines run along it.
glm::vec3 normalFrom(Rng& rng)
{
    const float turn = 6.2831853f * rng.uniform(), z = 2.0f * rng.uniform() - 1.0f, r = std::sqrt(1.0f - z * z);
    glm::vec3 n(r * std::cos(turn), r * std::sin(turn), z);
    if (rng.uniform() < 0.25f) {
        const int axis = static_cast<int>(2.999f * rng.uniform());
        const float way = n[axis] < 0.0f ? -1.0f : 1.0f;
        n = glm::vec3(0.0f), n[axis] = way;
    }
    return n;
}

} // namespace

class ChainPartnersTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void partnersAreThoseOfEachLine_data()
    {
        QTest::addColumn<int>("n");
        QTest::addColumn<int>("cells");
        QTest::newRow("one") << 1 << 1;
        QTest::newRow("sparse") << 16 << 200;
        QTest::newRow("dense") << 9 << 700;
        QTest::newRow("slices of several chunks") << 32 << 20'000;
    }
    void partnersAreThoseOfEachLine()
    {
        QFETCH(int, n);
        QFETCH(int, cells);
        Rng rng(3, 4, static_cast<std::uint64_t>(n));
        std::set<std::uint64_t> codes; // voxels come in the order of Morton codes
        for (int i = 0; i < cells; ++i)
            codes.insert(mortonCode(glm::uvec3(glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) * float(n))));
        HandMade made(n);
        for (const std::uint64_t code : codes) made.add(glm::ivec3(mortonCell(code)), normalFrom(rng));
        const int count = countLikeLookedThrough(made.finish(), allDirections(n > 16 ? 2 : 4));
        qInfo("%zu voxels, %d partners", codes.size(), count);
        QVERIFY(count >= (n == 1 ? 0 : static_cast<int>(codes.size())));
    }

    void everyVoxelOnOneLine()
    {
        // all that 7 voxels in a row can face, with and without gaps
        const glm::vec3 faced[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}};
        for (const int gap : {1, 2, 3}) {
            for (int code = 0; code < 2187; ++code) {
                HandMade made(20);
                for (int i = 0, rest = code; i < 7; ++i, rest /= 3) made.add({i * gap, 3, 5}, faced[rest % 3]);
                const SurfaceVoxels voxels = made.finish();
                QVERIFY2(countLikeLookedThrough(voxels, {lineAlong({1, 0, 0})}) >= 0,
                         qPrintable(QString("%1, every %2 cells").arg(code).arg(gap)));
            }
        }
    }

    void wallsDoNotHideThemselves()
    {
        HandMade made(12);
        made.add({0, 1, 1}, {1, 0, 0});
        made.add({1, 1, 1}, {1, 0, 0});
        made.add({4, 1, 1}, {-1, 0, 0});
        made.add({6, 1, 1}, {-1, 0, 0});
        made.add({9, 1, 1}, {-1, 0, 0}); // three slices on: another wall, behind this one
        const std::vector<std::uint32_t> expected{2, 2, 1, 1, PartnerFinder::kNothing};
        QCOMPARE(made.partnersAlong({1, 0, 0}, kPaper), expected);
    }

    void scenesAreLookedThrough()
    {
        Workers workers(2);
        for (const char* name : {"cornell", "two_rooms"}) {
            const Scene scene = *sampleScene(name);
            const auto rays = *RayScene::build(std::make_shared<const Scene>(scene));
            const auto reach = LightReach::find(*rays, LightSampler(rays), workers, {});
            const auto voxels = voxelsFor(kPaper, voxelise(scene.bounds, *reach, 30, 0.0f, workers, {}));
            const int count = countLikeLookedThrough(*voxels, directionSet(48));
            const double share = count / (48.0 * static_cast<double>(voxels->entries.size()));
            qInfo("%s: %.3f have a partner", name, share);
            QVERIFY(share > 0.7); // cornell is open in front
        }
    }

    void storedRowsAreWhatIsWalked()
    {
        Workers workers(2);
        const Scene scene = *sampleScene("cornell");
        const auto rays = *RayScene::build(std::make_shared<const Scene>(scene));
        const auto reach = LightReach::find(*rays, LightSampler(rays), workers, {});
        const auto voxels = voxelsFor(kPaper, voxelise(scene.bounds, *reach, 24, 0.0f, workers, {}));
        const VoxelOrders orders(*voxels, kPaper);
        const auto table = PartnerTable::make(*rays, *voxels, orders, 64, 1u << 30, workers, {});
        const auto lines = partnerFinder(*voxels, orders);
        const std::vector<LineDirection> set = directionSet(64);
        for (std::size_t d = 0; d < set.size(); ++d) {
            const auto found = lines->find(set[d], 0);
            for (std::uint32_t e = 0; e < found.size(); ++e) {
                const std::uint32_t stored = table->partner(e, d);
                QCOMPARE(stored, std::min(found[e], static_cast<std::uint32_t>(found.size())));
            }
        }
        const std::vector<glm::vec3> albedo(voxels->entries.size(), glm::vec3(0.5f));
        EntryValues light{3, {}};
        for (std::size_t i = 0; i < 3 * voxels->entries.size(); ++i) light.values.push_back(float(i % 7));
        BounceParams params;
        params.directions = 64;
        const auto bounced = [&](int threads, const PartnerTable* stored) {
            Workers some(threads);
            return bounceLight(*rays, *voxels, orders, light, albedo, params, some, {}, nullptr, stored).values;
        };
        const std::vector<float> all = bounced(1, table.get());
        QVERIFY(all == bounced(2, table.get()) && all == bounced(2, nullptr));
    }

    void closedRoomsKeepTheirLight()
    {
        // prototypes of this rule had 1.98 of 2 in a room like it
        Workers workers(2);
        const Scene scene = cavityL(0.5f);
        const auto rays = *RayScene::build(std::make_shared<const Scene>(scene));
        const auto reach = LightReach::find(*rays, LightSampler(rays), workers, {});
        const auto voxels = voxelsFor(kPaper, voxelise(scene.bounds, *reach, 64, 0.0f, workers, {}));
        const VoxelOrders orders(*voxels, kPaper);
        const EntryValues one{3, std::vector<float>(3 * voxels->entries.size(), 1.0f)};
        const std::vector<glm::vec3> half(voxels->entries.size(), glm::vec3(0.5f));
        const EntryValues lux = bounceLight(*rays, *voxels, orders, one, half, {}, workers, {});
        double sum = 0.0, area = 0.0;
        for (std::size_t e = 0; e < voxels->entries.size(); ++e) {
            const auto a = static_cast<double>(voxels->entries[e].area);
            sum += a * (1.0 + 0.5 * static_cast<double>(lux.values[3 * e])), area += a;
        }
        qInfo("%.4f of 2", sum / area);
        QVERIFY(sum / area >= 1.96 && sum / area <= 2.02);
    }

    void bakesTakeOneEntryAVoxel()
    {
        const auto scene = std::make_shared<const Scene>(*sampleScene("cornell"));
        BakeParams params;
        params.voxelSize = 20, params.voxelDirections = 64, params.voxelLookup = VoxelLookup::field;
        VoxelSolver solver;
        BakeProducts products;
        const Baked covered = runSolver(solver, {scene, params, {}}, products);
        params.voxelLines = kPaper;
        const Baked paper = runSolver(solver, {scene, params, {}}, products);
        QVERIFY2(paper.error.empty(), paper.error.c_str());
        QVERIFY(covered.counters.entries > covered.counters.voxels);
        QCOMPARE(paper.counters.entries, paper.counters.voxels);
        QCOMPARE(paper.counters.voxels, covered.counters.voxels);
    }
};

QTEST_APPLESS_MAIN(ChainPartnersTest)
#include "tst_chain_partners.moc"
