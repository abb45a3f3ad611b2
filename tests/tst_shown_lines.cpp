// SPDX-License-Identifier: Apache-2.0
// Claims: lines that are shown are discrete lines of their direction, about as many as asked for, spread over the
// scene; pairs along them are those that a bake's bounces have, told once.
#include "core/scene/sample_scenes.h"
#include "core/voxel/shown_lines.h"
#include "voxel_helpers.h"
#include <set>

using namespace lightloom;
using namespace lightloom::test;

class ShownLinesTest : public QObject {
    Q_OBJECT

    const Scene scene_ = cornellBox();
    Voxels voxels_{scene_, 24};
    std::shared_ptr<const PartnerTable> table_ = voxels_.stored(32);

private Q_SLOTS:
    void pairsAreThoseOfBounces_data()
    {
        QTest::addColumn<int>("number");
        for (const int n : {0, 1, 15, 16, 31}) QTest::addRow("direction %d", n) << n;
    }
    void pairsAreThoseOfBounces()
    {
        QFETCH(int, number);
        const ShownLines shown = shownLines(*voxels_.rays, *voxels_.surface, VoxelLines::covered, number, 1'000'000);
        QCOMPARE(shown.every, 1);
        QCOMPARE(shown.lines.size(), shown.allLines);
        const auto partner = [&](std::uint32_t e) { return table_->partner(e, std::size_t(number)); };
        std::set<std::pair<std::uint32_t, std::uint32_t>> told;
        std::size_t exact = 0;
        for (const ShownLines::Pair& pair : shown.pairs) {
            QCOMPARE(partner(pair.entry), pair.partner);
            QVERIFY(told.insert({pair.entry, pair.partner}).second);
            exact += pair.isExact ? 1 : 0;
        }
        for (std::uint32_t e = 0; e < voxels_.entries().size(); ++e) {
            const std::uint32_t p = partner(e);
            if (p >= voxels_.entries().size()) continue;
            const bool isBoth = partner(p) == e;
            QCOMPARE(told.contains({e, p}) || (isBoth && told.contains({p, e})), true);
            if (isBoth && told.contains({e, p})) QVERIFY(!told.contains({p, e}));
        }
        qInfo("%zu lines, %zu pairs, %zu by exact rays", shown.lines.size(), shown.pairs.size(), exact);
        QVERIFY(exact < shown.pairs.size() / 5);
    }

    void someOfManyAreShown()
    {
        const ShownLines all = shownLines(*voxels_.rays, *voxels_.surface, VoxelLines::covered, 7, 1'000'000),
                         some = shownLines(*voxels_.rays, *voxels_.surface, VoxelLines::covered, 7, 40);
        QCOMPARE(some.allLines, all.allLines);
        QVERIFY(some.every > 1 && some.lines.size() >= 15 && some.lines.size() <= 80);
        QVERIFY(some.pairs.size() >= 5 && some.pairs.size() < all.pairs.size() / 5);
        const float cell = voxels_.surface->cellSize();
        glm::vec3 low(1e9f), high(-1e9f);
        for (const ShownLines::Line& line : some.lines) {
            const glm::vec3 way = line.to - line.from;
            QVERIFY(glm::length(glm::cross(way, some.direction.unit)) <= 1e-4f * glm::length(way) + 1e-6f);
            low = glm::min(low, glm::min(line.from, line.to)), high = glm::max(high, glm::max(line.from, line.to));
        }
        QVERIFY(glm::all(glm::greaterThan(high - low, 0.7f * scene_.bounds.size())));
        // an entry of a pair lies on one of the lines, as voxels go: within a cell each way
        for (const ShownLines::Pair& pair : some.pairs) {
            float nearest = 1e9f;
            for (const ShownLines::Line& line : some.lines) {
                const glm::vec3 to = voxels_.entries()[pair.entry].centroid - line.from;
                nearest = glm::min(nearest, glm::length(to - glm::dot(to, some.direction.unit) * some.direction.unit));
            }
            QVERIFY2(nearest <= 1.75f * cell, qPrintable(QString("%1 cells").arg(double(nearest / cell))));
        }
    }
};

QTEST_APPLESS_MAIN(ShownLinesTest)
#include "tst_shown_lines.moc"
