// SPDX-License-Identifier: Apache-2.0
// Claims: directions are nested, distinct and even; every voxel is on exactly one discrete line per direction, which no
// number leaves; what entries see along lines is what looking through each line one by one says; corners that are open
// inwards, sheets and walls several voxels thick along a line do what surface does; voxels hold the reached surface.
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/transport/line_partners.h"
#include "tests/line_helpers.h"
#include <QtTest>
#include <algorithm>
#include <map>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// One line, voxels of one entry each, looked through pair by pair: O(n^2).
class OneLine {
public:
    OneLine(const SurfaceVoxels& voxels, const LineDirection& d, std::vector<std::uint32_t> line)
        : voxels_(voxels), direction_(d), line_(std::move(line))
    {
    }
    void setPartners(std::vector<std::uint32_t>& partners) const
    {
        for (std::size_t i = 0; i < line_.size(); ++i) {
            const std::size_t seen = facesForth(line_[i]) ? endOf(i) : emitterOf(i);
            if (seen < line_.size()) partners[line_[i]] = line_[seen];
        }
    }

private:
    [[nodiscard]] int slice(std::uint32_t i) const { return voxels_.voxels[i][direction_.major]; }
    [[nodiscard]] double cosine(std::uint32_t i) const
    {
        return glm::dot(glm::dvec3(voxels_.entries[i].normal), glm::dvec3(direction_.unit));
    }
    [[nodiscard]] bool facesForth(std::uint32_t i) const { return cosine(i) > 0.0; }
    /// Whether `other` lies before the plane of `i`, or the line has left that plane behind.
    [[nodiscard]] bool isBefore(std::uint32_t i, std::uint32_t other) const
    {
        const glm::vec3 between = voxels_.entries[other].centroid - voxels_.entries[i].centroid;
        const double way = glm::abs(slice(i) - slice(other)) / static_cast<double>(direction_.unit[direction_.major]);
        return glm::dot(between, voxels_.entries[i].normal) > 1e-3f || way * std::abs(cosine(i)) > 1.5;
    }
    /// The place where the way of one that faces forth ends: the first that faces back and sees it.
    [[nodiscard]] std::size_t endOf(std::size_t i) const
    {
        for (std::size_t j = i + 1; j < line_.size(); ++j) {
            if (!facesForth(line_[j]) && isBefore(line_[i], line_[j]) && isBefore(line_[j], line_[i])) return j;
        }
        return line_.size();
    }
    /// What one that faces back sees: the last whose way ends there, or what the step of the same wall before it sees.
    [[nodiscard]] std::size_t emitterOf(std::size_t j) const
    {
        for (std::size_t i = j; i-- > 0;) {
            if (facesForth(line_[i]) && endOf(i) == j) return i;
        }
        for (std::size_t k = j; k-- > 0;) {
            if (!facesForth(line_[k])) return slice(line_[j]) - slice(line_[k]) <= 2 ? emitterOf(k) : line_.size();
        }
        return line_.size();
    }

    const SurfaceVoxels& voxels_;
    const LineDirection& direction_;
    std::vector<std::uint32_t> line_;
};

std::vector<std::uint32_t> lookedThrough(const SurfaceVoxels& voxels, const LineDirection& d)
{
    std::vector<std::uint32_t> partners(voxels.voxels.size(), LinePartners::kNothing);
    for (auto& line : voxelsByLine(voxels, d)) OneLine(voxels, d, std::move(line)).setPartners(partners);
    return partners;
}

} // namespace

class VoxelLinesTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void directionsAreNestedAndEven()
    {
        const std::vector<LineDirection> all = directionSet(kMostDirections);
        QCOMPARE(all.size(), std::size_t(kMostDirections));
        std::set<std::tuple<int, int, int>> seen;
        for (const LineDirection& d : all) {
            const int largest = d.step[d.major];
            QVERIFY(largest > 0 && largest <= kLargestStep);
            for (int axis = 0; axis < 3; ++axis) QVERIFY(glm::abs(d.step[axis]) <= largest);
            QVERIFY(seen.insert({d.step.x, d.step.y, d.step.z}).second);
        }
        for (const int count : {1, 64, 100, 512}) {
            const std::vector<LineDirection> some = directionSet(count);
            QCOMPARE(some.size(), std::size_t(count));
            for (std::size_t i = 0; i < some.size(); ++i) QVERIFY(some[i].step == all[i].step);
        }
        for (const int count : {64, 512, 4096}) {
            // the mean of d d^T over the sphere is a third of the unit matrix; .001 for the rounding to integers
            glm::dmat3 mean(0.0);
            for (int i = 0; i < count; ++i) {
                const glm::dvec3 d(all[static_cast<std::size_t>(i)].unit);
                mean += glm::outerProduct(d, d) / static_cast<double>(count);
            }
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j)
                    QVERIFY(std::abs(mean[i][j] - (i == j ? 1.0 / 3.0 : 0.0)) <=
                            1e-3 + 1.0 / static_cast<double>(count));
            }
        }
    }

    void everyVoxelIsOnOneLine()
    {
        constexpr int n = 9;
        for (const LineDirection& d : allDirections(4)) {
            const LineNumbers numbers(d, n);
            std::map<std::uint32_t, std::pair<int, int>> lines;
            std::set<std::pair<std::uint32_t, int>> taken; // line, slice
            for (int x = 0; x < n; ++x) {
                for (int y = 0; y < n; ++y) {
                    for (int z = 0; z < n; ++z) {
                        const glm::ivec3 cell(x, y, z);
                        const auto at = [&](int axis) { return static_cast<std::uint16_t>(cell[axis % 3]); };
                        const std::uint32_t line = numbers.of({at(d.major), at(d.major + 1), at(d.major + 2), 0});
                        QVERIFY(line < numbers.count());
                        QVERIFY(lines.try_emplace(line, lineOf(cell, d)).first->second == lineOf(cell, d));
                        QVERIFY(taken.insert({line, cell[d.major]}).second); // one cell in each slice at most
                    }
                }
            }
            std::set<std::pair<int, int>> distinct;
            for (const auto& [number, line] : lines) QVERIFY(distinct.insert(line).second);
        }
    }

    void numbersStayInBounds()
    {
        const int last = kMostVoxels - 1;
        for (LineDirection d : directionSet(kMostDirections)) {
            const LineNumbers numbers(d, kMostVoxels);
            QVERIFY(numbers.count() <= 4u * kMostVoxels * kMostVoxels);
            for (int corner = 0; corner < 8; ++corner) {
                const auto at = [&](int bit) { return static_cast<std::uint16_t>(corner & bit ? last : 0); };
                QVERIFY(numbers.of({at(1), at(2), at(4), 0}) < numbers.count());
            }
        }
    }

    void partnersAreThoseOfEachLine()
    {
        const std::vector<LineDirection> directions = allDirections(4);
        for (const int n : {2, 5, 16}) {
            Rng rng(1, 2, static_cast<std::uint64_t>(n));
            HandMade made(n);
            std::set<std::uint64_t> cells; // voxels come in the order of Morton codes
            for (int i = 0; i < n * n * 2; ++i)
                cells.insert(mortonCode(glm::uvec3(glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) * float(n))));
            for (const std::uint64_t code : cells) made.add(glm::ivec3(mortonCell(code)), anyNormal(rng, directions));
            const SurfaceVoxels voxels = made.finish();
            const VoxelOrders orders(voxels);
            LinePartners lines(voxels, orders);
            std::uint32_t number = 0;
            for (const LineDirection& d : directions) {
                const auto found = lines.find(d, number++);
                QVERIFY(std::ranges::equal(found, lookedThrough(voxels, d)));
            }
        }
    }

    void cornersSeeThemselves()
    {
        // floor and wall meet in the voxel (3, 0, 0); light goes along (1, -1, 0) from the wall down to the floor
        HandMade made(8);
        made.add({1, 0, 0}, {0, 1, 0});
        made.add({3, 0, 0}, {{{3.5f, 0.0f, 0.5f}, {0, 1, 0}, 1.0f}, {{3.0f, 0.5f, 0.5f}, {1, 0, 0}, 1.0f}});
        made.add({3, 2, 0}, {1, 0, 0});
        const std::vector<std::uint32_t> found = made.partnersAlong({1, -1, 0});
        QCOMPARE(found[1], 2u);
        QCOMPARE(found[2], 1u);
    }

    void sheetsHideWhatIsBehind()
    {
        // two walls face each other with a sheet between them, both of its sides in one voxel
        HandMade made(8);
        made.add({0, 1, 1}, {1, 0, 0});
        made.add({4, 1, 1}, {{{4.5f, 1.5f, 1.5f}, {1, 0, 0}, 1.0f}, {{4.5f, 1.5f, 1.5f}, {-1, 0, 0}, 1.0f}});
        made.add({7, 1, 1}, {-1, 0, 0});
        const std::vector<std::uint32_t> expected{2, 3, 0, 1};
        QCOMPARE(made.partnersAlong({1, 0, 0}), expected);
    }

    void slabsThinnerThanAVoxelDoNotHideThemselves()
    {
        // a table's top and its underside in one row of voxels, a floor and a ceiling; the line rises by a third
        HandMade made(16);
        for (int x = 4; x <= 9; ++x) {
            const glm::vec3 middle(float(x) + 0.5f, 5.9f, 0.5f);
            made.add({x, 5, 0}, {{middle, {0, 1, 0}, 1.0f}, {middle - glm::vec3(0, 0.4f, 0), {0, -1, 0}, 1.0f}});
        }
        for (int x = 10; x < 16; ++x) made.add({x, 7, 0}, {0, -1, 0});
        for (int x = 0; x < 4; ++x) made.add({x, 3, 0}, {0, 1, 0});
        const std::vector<std::uint32_t> found = made.partnersAlong({3, 1, 0});
        for (std::uint32_t e = 0; e < 12; ++e) {
            if (found[e] == LinePartners::kNothing) continue;
            // the top sees the ceiling, the underside the floor
            QCOMPARE(found[e] >= 12 && found[e] < 18, e % 2 == 0);
            QVERIFY(found[e] >= 12);
        }
        QVERIFY(std::count_if(found.begin(), found.begin() + 12, [](std::uint32_t p) { return p >= 12 && p < 18; }) >=
                3);
        QVERIFY(std::count_if(found.begin(), found.begin() + 12, [](std::uint32_t p) { return p >= 18 && p < 22; }) >=
                3);
    }

    void wallsDoNotHideThemselves()
    {
        // two walls of two steps each: all see the other wall, none its neighbour
        HandMade made(8);
        made.add({0, 1, 1}, {1, 0, 0});
        made.add({1, 1, 1}, {1, 0, 0});
        made.add({5, 1, 1}, {-1, 0, 0});
        made.add({6, 1, 1}, {-1, 0, 0});
        const std::vector<std::uint32_t> expected{2, 2, 1, 1};
        QCOMPARE(made.partnersAlong({1, 0, 0}), expected);
    }

    void severalEntriesAreDrawnByWhatIsSeen()
    {
        // a voxel of two entries that face back, of 1 and 3 m2: over many directions one in four draws the smaller
        HandMade made(8);
        made.add({0, 0, 0}, {1, 0, 0});
        made.add({6, 0, 0}, {{{6.5f, 0.5f, 0.5f}, {-1, 0, 0}, 1.0f}, {{6.5f, 0.5f, 0.5f}, {-1, 0, 0}, 3.0f}});
        const SurfaceVoxels voxels = made.finish();
        const VoxelOrders orders(voxels);
        LinePartners lines(voxels, orders);
        int smaller = 0;
        constexpr int kDraws = 4000;
        for (std::uint32_t i = 0; i < kDraws; ++i) smaller += lines.find(lineAlong({1, 0, 0}), i)[0] == 1 ? 1 : 0;
        QVERIFY(std::abs(smaller - kDraws / 4) <= 140); // five standard deviations
    }

    void voxelsHoldTheReachedSurface()
    {
        Workers workers(2);
        for (const Scene& scene : {cornellBox(), cavityL(0.5f)}) {
            const auto rays = RayScene::build(std::make_shared<const Scene>(scene));
            QVERIFY(rays);
            const auto reach = LightReach::find(**rays, LightSampler(*rays), workers, {});
            for (const int cells : {1, 2, 7, 33, 64}) {
                for (const float shift : {0.0f, 0.4f}) {
                    const auto voxels = voxelise(scene.bounds, *reach, cells, shift, workers, {});
                    QVERIFY(voxels);
                    double area = 0.0;
                    for (const Orientation& o : voxels->entries) area += static_cast<double>(o.area);
                    QVERIFY(std::abs(area / reach->area() - 1.0) <= 1e-4);
                    meansHoldTheSame(*voxels, area);
                    for (std::size_t v = 0; v < voxels->voxels.size(); ++v) {
                        const glm::ivec3 cell = voxels->voxels[v];
                        QVERIFY(glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))));
                        QVERIFY(glm::all(glm::lessThan(cell, glm::ivec3(cells))));
                        for (std::uint32_t e = voxels->firstEntry[v]; e < voxels->firstEntry[v + 1]; ++e) {
                            double own = 0.0;
                            for (std::uint32_t p = voxels->firstPiece[e]; p < voxels->firstPiece[e + 1]; ++p) {
                                QVERIFY(voxels->pieces[p].cell == mortonCode(glm::uvec3(cell)));
                                own += static_cast<double>(voxels->pieces[p].area);
                            }
                            QVERIFY(std::abs(own - static_cast<double>(voxels->entries[e].area)) <= 1e-5 * own);
                        }
                    }
                }
            }
        }
    }

    void ordersAreLexicographic()
    {
        Workers workers(2);
        const Scene scene = cornellBox();
        const auto rays = RayScene::build(std::make_shared<const Scene>(scene));
        const auto reach = LightReach::find(**rays, LightSampler(*rays), workers, {});
        const auto voxels = voxelise(scene.bounds, *reach, 40, 0.0f, workers, {});
        const VoxelOrders orders(*voxels);
        for (int axis = 0; axis < 3; ++axis) {
            const std::vector<VoxelPlace>& places = orders.along(axis).places;
            QCOMPARE(places.size(), voxels->voxels.size());
            std::vector<bool> seen(places.size());
            for (std::size_t i = 0; i < places.size(); ++i) {
                const VoxelPlace& p = places[i];
                const glm::ivec3 cell = voxels->voxels[p.voxel];
                QVERIFY(p.slice == cell[axis] && p.u == cell[(axis + 1) % 3] && p.v == cell[(axis + 2) % 3]);
                QVERIFY(!seen[p.voxel]);
                seen[p.voxel] = true;
                if (i == 0) continue;
                const VoxelPlace& q = places[i - 1];
                QVERIFY(std::tie(q.slice, q.u, q.v) < std::tie(p.slice, p.u, p.v));
            }
        }
    }

private:
    /// One entry per voxel, with all of its surface.
    static void meansHoldTheSame(const SurfaceVoxels& voxels, double area)
    {
        const SurfaceVoxels means = withMeanNormals(voxels);
        QCOMPARE(means.entries.size(), voxels.voxels.size());
        double all = 0.0;
        for (std::size_t v = 0; v < means.entries.size(); ++v) {
            QCOMPARE(means.firstEntry[v], static_cast<std::uint32_t>(v));
            QCOMPARE(means.firstPiece[v], voxels.firstPiece[voxels.firstEntry[v]]);
            QVERIFY(std::abs(glm::length(means.entries[v].normal) - 1.0f) <= 1e-5f);
            all += static_cast<double>(means.entries[v].area);
        }
        QVERIFY(std::abs(all / area - 1.0) <= 1e-5);
    }
};

QTEST_APPLESS_MAIN(VoxelLinesTest)
#include "tst_voxel_lines.moc"
