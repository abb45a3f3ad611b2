// SPDX-License-Identifier: Apache-2.0
// Claims: rows are entries wall by wall; they hold what walking the lines finds, two or four bytes each, as many as
// fit; a bounce is the sum of what partners send times cosine over all cosines; bounces have the same bits with stored
// rows, with a part of them and with none, on any number of threads; each light group's are those that it has alone.
#include "core/scene/sample_scenes.h"
#include "voxel_helpers.h"
#include <QtTest>
#include <algorithm>
#include <set>
#include <tuple>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// What walking the lines finds, an exact ray where they lose their way.
std::vector<std::uint32_t> walked(const Voxels& voxels, LinePartners& lines, const LineDirection& d, int number)
{
    const std::span<std::uint32_t> found = lines.find(d, static_cast<std::uint32_t>(number));
    ExactPartners(*voxels.rays, *voxels.surface).complete(d, found);
    return {found.begin(), found.end()};
}

/// Light of `groups` light groups, each its own; the groups reflect alike.
EntryValues anyLight(const Voxels& voxels, int groups)
{
    EntryValues light{3 * groups, {}};
    for (const Orientation& o : voxels.entries()) {
        for (int g = 0; g < groups; ++g) {
            const float phase = static_cast<float>(g + 1);
            for (int c = 0; c < 3; ++c)
                light.values.push_back(
                    glm::max(0.0f, std::sin(phase * o.centroid.x + static_cast<float>(c)) + o.normal.y * 0.1f * phase));
        }
    }
    return light;
}

std::vector<glm::vec3> anyAlbedo(const Voxels& voxels)
{
    std::vector<glm::vec3> albedo;
    for (const Orientation& o : voxels.entries())
        albedo.push_back(glm::vec3(0.7f, 0.2f, 0.5f) * (1.0f + 0.2f * o.normal));
    return albedo;
}

/// One bounce as its formula has it, in double.
std::vector<double> oneBounce(const Voxels& voxels, const EntryValues& light, int directions)
{
    const auto channels = static_cast<std::size_t>(light.channels);
    std::vector<double> lux(light.values.size(), 0.0), cosines(voxels.entries().size(), 0.0);
    LinePartners lines(*voxels.surface, *voxels.orders);
    const std::vector<LineDirection> set = directionSet(directions);
    for (int d = 0; d < directions; ++d) {
        const LineDirection& direction = set[static_cast<std::size_t>(d)];
        const std::vector<std::uint32_t> partners = walked(voxels, lines, direction, d);
        for (std::size_t e = 0; e < partners.size(); ++e) {
            const double cosine =
                std::abs(glm::dot(glm::dvec3(voxels.entries()[e].normal), glm::dvec3(direction.unit)));
            cosines[e] += cosine;
            if (partners[e] == LinePartners::kNothing) continue;
            for (std::size_t c = 0; c < channels; ++c)
                lux[e * channels + c] += cosine * static_cast<double>(light.values[partners[e] * channels + c]);
        }
    }
    for (std::size_t i = 0; i < lux.size(); ++i) lux[i] /= cosines[i / channels];
    return lux;
}

} // namespace

class PartnerTableTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void rowsStandWallByWall()
    {
        const Voxels voxels(*sampleScene("cornell"), 48);
        const RowOrder& order = *voxels.orders->rows();
        const std::vector<Orientation>& entries = voxels.entries();
        QCOMPARE(order.size(), entries.size());
        QCOMPARE(order.rowOf.size(), entries.size() + 1);
        QCOMPARE(order.rowOf.back(), static_cast<std::uint32_t>(entries.size()));
        std::set<std::tuple<float, float, float>> begun;
        std::size_t alike = 0, turns = 0;
        for (std::size_t r = 0; r < order.size(); ++r) {
            const std::uint32_t e = order.entryOf[r];
            QCOMPARE(order.rowOf[e], static_cast<std::uint32_t>(r)); // so that each has a row of its own
            QVERIFY(order.orientations[r].centroid == entries[e].centroid);
            const glm::vec3 n = entries[e].normal;
            if (r > 0 && n == order.orientations[r - 1].normal) {
                QVERIFY(e > order.entryOf[r - 1]);
                ++alike;
            } else {
                turns += begun.insert({n.x, n.y, n.z}).second ? 0 : 1;
            }
        }
        qInfo("%zu of %zu rows are like the one before, %zu normals met again", alike, order.size(), turns);
        QVERIFY(alike > order.size() * 9 / 10 && turns < order.size() / 20);
    }

    void rowsHoldWhatWalkingFinds_data()
    {
        QTest::addColumn<int>("cells");
        QTest::addColumn<int>("directions");
        QTest::newRow("two bytes") << 32 << 40;
        QTest::newRow("four bytes") << 128 << 18;
    }
    void rowsHoldWhatWalkingFinds()
    {
        QFETCH(int, cells);
        QFETCH(int, directions);
        const Voxels voxels(cornellBox(), cells);
        const std::size_t count = voxels.entries().size();
        const auto table = voxels.stored(directions);
        QCOMPARE(table->directions(), directions);
        QCOMPARE(table->entries(), count);
        const std::size_t blocks = static_cast<std::size_t>(directions + 15) / 16, bytes = count > 65'535 ? 4 : 2;
        QCOMPARE(table->memoryBytes(), blocks * 16 * count * bytes);
        QCOMPARE(PartnerTable::bytesFor(count, directions), table->memoryBytes());
        LinePartners lines(*voxels.surface, *voxels.orders);
        const std::vector<LineDirection> set = directionSet(directions);
        std::size_t seeing = 0;
        for (int d = 0; d < directions; ++d) {
            const auto number = static_cast<std::size_t>(d);
            const std::vector<std::uint32_t> found = walked(voxels, lines, set[number], d);
            for (std::size_t e = 0; e < count; ++e) {
                const std::uint32_t partner = table->partner(e, number);
                if (found[e] == LinePartners::kNothing)
                    QCOMPARE(partner, static_cast<std::uint32_t>(count));
                else
                    QCOMPARE(partner, found[e]);
                seeing += found[e] != LinePartners::kNothing ? 1 : 0;
            }
        }
        QVERIFY(seeing > count * number(directions) / 2);
    }

    void asManyAsFit()
    {
        const Voxels voxels(cornellBox(), 16);
        const std::size_t block = PartnerBlock::bytesFor(voxels.entries().size());
        QCOMPARE(voxels.stored(100, 7 * block)->directions(), 100);
        QCOMPARE(voxels.stored(100, 7 * block - 1)->directions(), 96);
        QCOMPARE(voxels.stored(100, 3 * block)->directions(), 48);
        QCOMPARE(voxels.stored(100, block - 1)->directions(), 0);
        QCOMPARE(voxels.stored(100, block - 1)->memoryBytes(), std::size_t(0));
    }

    void aBounceIsTheSumOfWhatPartnersSend()
    {
        const Voxels voxels(cornellBox(), 24, 0.3f);
        BounceParams params;
        params.directions = 72; // not whole blocks
        params.mostBounces = 1;
        for (const int groups : {1, 2, 4, 5, 7}) { // every width of the sums, and more than one strip
            const EntryValues light = anyLight(voxels, groups), lux = voxels.bounced(light, anyAlbedo(voxels), params);
            const std::vector<double> expected = oneBounce(voxels, light, params.directions);
            for (std::size_t i = 0; i < expected.size(); ++i)
                QVERIFY(std::abs(static_cast<double>(lux.values[i]) - expected[i]) <= 1e-5 * (0.1 + expected[i]));
        }
    }

    void sameBitsStoredOrWalked()
    {
        const Voxels voxels(cornellBox(), 32);
        EntryValues light = anyLight(voxels, 2);
        light.values[6 * 1000 + 4] = 1e6f; // the second group has a bright entry, which shadow rays connect
        const std::vector<glm::vec3> albedo = anyAlbedo(voxels);
        BounceParams params;
        params.directions = 250; // 125 and 64 next
        const EntryValues plain = voxels.bounced(light, albedo, params, 1);
        QVERIFY(!plain.values.empty());
        QVERIFY(voxels.bounced(light, albedo, params, 3).values == plain.values);
        for (const int directions : {250, 400, 130, 16}) { // all, more than are wanted, parts
            for (const int threads : {1, 3}) {
                const auto table = voxels.stored(directions, 1u << 30, threads);
                QVERIFY(voxels.bounced(light, albedo, params, threads, table.get()).values == plain.values);
            }
        }
    }

    void inTurnThreadsDoNotMatter() // Gauss-Seidel goes over fixed parts of the surface
    {
        const Voxels voxels(cornellBox(), 32);
        const auto table = voxels.stored(96);
        BounceParams params;
        params.directions = 96;
        params.order = VoxelBounces::gaussSeidel;
        const EntryValues light = anyLight(voxels, 6);
        const std::vector<glm::vec3> albedo = anyAlbedo(voxels);
        const EntryValues one = voxels.bounced(light, albedo, params, 1, table.get());
        QVERIFY(voxels.bounced(light, albedo, params, 3, table.get()).values == one.values);
        params.order = VoxelBounces::halving;
        QVERIFY(voxels.bounced(light, albedo, params, 1, table.get()).values != one.values);
    }

    void lampsDoNotMix_data()
    {
        QTest::addColumn<VoxelBounces>("order");
        QTest::newRow("halving") << VoxelBounces::halving;
        QTest::newRow("gauss-seidel") << VoxelBounces::gaussSeidel;
    }
    void lampsDoNotMix()
    {
        QFETCH(VoxelBounces, order);
        // seven light groups in one pass are what each is alone, to the bit, though they end after different numbers of
        // bounces; a red one stays red
        const Voxels voxels(cornellBox(), 24);
        const auto table = voxels.stored(128);
        EntryValues light = anyLight(voxels, 7);
        for (std::size_t e = 0; e < voxels.entries().size(); ++e) {
            light.values[21 * e + 1] = light.values[21 * e + 2] = 0.0f;
            light.values[21 * e + 9] = light.values[21 * e + 11] = 0.0f; // a green one ends earlier
        }
        BounceParams params;
        params.directions = 128;
        params.order = order;
        const std::vector<glm::vec3> albedo = anyAlbedo(voxels);
        const EntryValues together = voxels.bounced(light, albedo, params, 2, table.get());
        std::set<int> counts;
        Workers workers(2);
        for (std::size_t g = 0; g < 7; ++g) {
            EntryValues one;
            for (std::size_t e = 0; e < voxels.entries().size(); ++e) {
                const float* from = &light.values[21 * e + 3 * g];
                one.values.insert(one.values.end(), from, from + 3);
            }
            int bounces = 0;
            const EntryValues alone = bounceLight(*voxels.rays, *voxels.surface, *voxels.orders, one, albedo, params,
                                                  workers, {}, &bounces, table.get());
            counts.insert(bounces);
            for (std::size_t i = 0; i < alone.values.size(); ++i)
                QVERIFY(alone.values[i] == together.values[21 * (i / 3) + 3 * g + i % 3]);
            for (std::size_t i = 0; g == 0 && i < alone.values.size(); i += 3)
                QVERIFY(alone.values[i + 1] == 0.0f && alone.values[i + 2] == 0.0f);
        }
        QVERIFY(counts.size() > 1);
    }

    void stopsWhenAsked()
    {
        const Voxels voxels(cornellBox(), 32);
        const auto table = voxels.stored(64);
        std::stop_source source;
        source.request_stop();
        Workers workers(2);
        QVERIFY(!PartnerTable::make(*voxels.rays, *voxels.surface, *voxels.orders, 64, 1u << 30, workers,
                                    source.get_token()));
        for (const PartnerTable* stored : {static_cast<const PartnerTable*>(nullptr), table.get()})
            QVERIFY(bounceLight(*voxels.rays, *voxels.surface, *voxels.orders, anyLight(voxels, 1), anyAlbedo(voxels),
                                {}, workers, source.get_token(), nullptr, stored)
                        .values.empty());
    }

private:
    static std::size_t number(int value) { return static_cast<std::size_t>(value); }
};

QTEST_APPLESS_MAIN(PartnerTableTest)
#include "tst_partner_table.moc"
