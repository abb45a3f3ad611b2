// SPDX-License-Identifier: Apache-2.0
// Claims: a million random segments, many in grid planes, along them and ending on them, cross as many planes as
// integers say, at the places they say; pieces in cells add up to the length inside the grid; a lattice covers its
// scene under any shift and has no plane on a wall.
#include "core/base/rng.h"
#include "core/ivg/grid_lattice.h"
#include "core/ivg/grid_walk.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "light_helpers.h"
#include <algorithm>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr int kUnits = 8; ///< per cell: coordinates that float and int both hold exactly
constexpr glm::ivec3 kCells{6, 5, 7};
constexpr int kSegments = 1'000'000;

struct ExactSegment {
    glm::ivec3 from, to; ///< units
    [[nodiscard]] glm::vec3 start() const { return glm::vec3(from) / float(kUnits); }
    [[nodiscard]] glm::vec3 end() const { return glm::vec3(to) / float(kUnits); }
};

/// Ends from two cells outside the grid to two cells outside; every fourth coordinate is on a plane, and every fourth
/// segment stays in a plane of some axis.
ExactSegment randomSegment(Rng& rng)
{
    ExactSegment s;
    for (int axis = 0; axis < 3; ++axis) {
        for (glm::ivec3* at : {&s.from, &s.to}) {
            (*at)[axis] = static_cast<int>(rng.uniform() * float(kUnits * (kCells[axis] + 4))) - 2 * kUnits;
            if (rng.uniform() < 0.25f) (*at)[axis] = (*at)[axis] / kUnits * kUnits;
        }
    }
    if (rng.uniform() < 0.25f) {
        const int axis = std::min(2, static_cast<int>(rng.uniform() * 3.0f));
        s.to[axis] = s.from[axis];
    }
    return s;
}

std::int64_t floorDiv(std::int64_t a, std::int64_t b) { return a / b - ((a % b != 0) && ((a < 0) != (b < 0)) ? 1 : 0); }

/// A quotient of integers, denominator positive.
struct Quotient {
    std::int64_t over, under;
    [[nodiscard]] double value() const { return double(over) / double(under); }
};
/// Coordinate along `across` in cells where the segment meets `plane` of `axis`.
Quotient coordinateAt(const ExactSegment& s, int axis, int plane, int across)
{
    const std::int64_t length = s.to[axis] - s.from[axis], way = std::int64_t(plane) * kUnits - s.from[axis];
    const std::int64_t sign = length < 0 ? -1 : 1;
    const std::int64_t over = std::int64_t(s.from[across]) * length + way * (s.to[across] - s.from[across]);
    return {sign * over, sign * length * kUnits};
}

/// The ways of a segment into cells, by cutting it at every half plane and sorting the cuts: slow and plain.
std::map<std::array<int, 3>, double> piecesByCuts(const ExactSegment& s)
{
    const glm::dvec3 from(s.start()), way = glm::dvec3(s.end()) - from;
    std::vector<double> cuts{0.0, 1.0};
    for (int axis = 0; axis < 3; ++axis) {
        if (way[axis] == 0.0) continue;
        cuts.push_back((0.0 - from[axis]) / way[axis]);
        for (int k = 0; k < kCells[axis]; ++k) cuts.push_back((k + 0.5 - from[axis]) / way[axis]);
        cuts.push_back((kCells[axis] - from[axis]) / way[axis]);
    }
    std::erase_if(cuts, [](double t) { return t < 0.0 || t > 1.0; });
    std::ranges::sort(cuts);
    std::map<std::array<int, 3>, double> pieces;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const glm::dvec3 middle = from + 0.5 * (cuts[i] + cuts[i + 1]) * way;
        if (glm::any(glm::lessThan(middle, glm::dvec3(0.0))) || glm::any(glm::greaterThan(middle, glm::dvec3(kCells))))
            continue;
        const glm::ivec3 v(glm::floor(middle + 0.5));
        pieces[{v.x, v.y, v.z}] += cuts[i + 1] - cuts[i];
    }
    return pieces;
}

} // namespace

class GridWalkTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void crossingsAreThoseThatIntegersCount()
    {
        Rng rng(1, hashName("crossings"), 0);
        std::int64_t found = 0, expected = 0, wrongPlaces = 0, inPlanes = 0;
        for (int i = 0; i < kSegments; ++i) {
            const ExactSegment s = randomSegment(rng);
            for (int axis = 0; axis < 3; ++axis) {
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                const PlaneRange planes{0, kCells[axis]};
                std::vector<int> crossed;
                forCrossings(s.start(), s.end(), axis, planes, [&](int plane, float atU, float atV) {
                    crossed.push_back(plane);
                    const double offU = double(atU) - coordinateAt(s, axis, plane, u).value();
                    const double offV = double(atV) - coordinateAt(s, axis, plane, v).value();
                    if (!(std::abs(offU) <= 1e-5 && std::abs(offV) <= 1e-5)) ++wrongPlaces;
                });
                std::vector<int> exact; // start left out, end counted
                for (int plane = 0; plane <= kCells[axis]; ++plane) {
                    const int at = plane * kUnits, a = s.from[axis], b = s.to[axis];
                    if ((a < at && at <= b) || (b <= at && at < a)) exact.push_back(plane);
                }
                inPlanes += s.from[axis] == s.to[axis] && floorDiv(s.from[axis], kUnits) * kUnits == s.from[axis];
                found += std::ssize(crossed);
                expected += std::ssize(exact);
                QVERIFY2(crossed == exact, qPrintable(QString("segment %1, axis %2: %3 crossings instead of %4")
                                                          .arg(i)
                                                          .arg(axis)
                                                          .arg(crossed.size())
                                                          .arg(exact.size())));
            }
        }
        qInfo("%lld crossings, %lld ways in a plane", static_cast<long long>(found), static_cast<long long>(inPlanes));
        QVERIFY(found == expected && found > 5'000'000 && inPlanes > 20'000);
        QCOMPARE(wrongPlaces, std::int64_t{0});
    }

    void pathsThatTurnOnAPlaneCrossItOnce()
    {
        // up to a plane, and on from there: one crossing; back from there: one, by the way that came
        QCOMPARE(crossedPlanes(0.5f, 2.0f).count(), 2);
        QCOMPARE(crossedPlanes(2.0f, 2.5f).count(), 0);
        QCOMPARE(crossedPlanes(2.0f, 1.5f).count(), 0);
        QCOMPARE(crossedPlanes(2.0f, 2.0f).count(), 0);
        QCOMPARE(crossedPlanes(2.0f, 1.0f).count(), 1);
        QCOMPARE(crossedPlanes(-0.5f, 0.0f).first, 0);
        QCOMPARE(crossedPlanes(-0.25f, -0.75f).count(), 0);
    }

    void piecesAddUp()
    {
        Rng rng(1, hashName("pieces"), 0);
        double worst = 0.0;
        for (int i = 0; i < kSegments / 10; ++i) {
            const ExactSegment s = randomSegment(rng);
            // a way along a border between cells belongs to either
            bool isOnBorder = false;
            for (int axis = 0; axis < 3; ++axis)
                isOnBorder |= s.from[axis] == s.to[axis] && s.from[axis] % (kUnits / 2) == 0;
            if (isOnBorder) continue;
            std::map<std::array<int, 3>, double> found;
            for (const PlaneRange layers : {PlaneRange{0, 2}, PlaneRange{3, 3}, PlaneRange{4, kCells.z}}) {
                forPieces(s.start(), s.end(), kCells, layers, [&](const glm::ivec3& v, float, float share) {
                    found[{v.x, v.y, v.z}] += double(share);
                });
            }
            for (const auto& [cell, share] : piecesByCuts(s)) {
                worst = std::max(worst, std::abs(found[cell] - share));
                found.erase(cell);
            }
            for (const auto& [cell, share] : found) worst = std::max(worst, share); // in cells that it is not in
        }
        QVERIFY2(worst <= 2e-5, qPrintable(QString("off by %1 of the length").arg(worst)));
    }

    void freePlaceKeepsClear()
    {
        QCOMPARE(freePlace(0.3f, {}, 0.02f), 0.3f);
        QCOMPARE(freePlace(0.3f, {0.0f, 0.5f}, 0.02f), 0.3f);
        QVERIFY(std::abs(freePlace(0.3f, {0.295f}, 0.02f) - 0.315f) <= 1e-6f);
        QVERIFY(std::abs(freePlace(0.99f, {0.005f}, 0.02f) - 0.985f) <= 1e-6f); // round the ring
        QVERIFY(std::abs(freePlace(0.3f, {0.28f, 0.31f, 0.6f}, 0.02f) - 0.33f) <= 1e-6f);
        std::vector<float> crowd; // no room anywhere but in the middle of the widest gap
        for (int i = 0; i < 100; ++i)
            if (i != 40) crowd.push_back(float(i) / 100.0f);
        QVERIFY(std::abs(freePlace(0.9f, crowd, 0.02f) - 0.40f) <= 1e-6f);
    }

    void noPlaneLiesOnAWall_data()
    {
        QTest::addColumn<QString>("name");
        QTest::addColumn<int>("cells");
        for (const QString name : {"cornell", "two_rooms", "atrium"}) {
            for (const int cells : {2, 16, 33}) QTest::addRow("%s %d", qPrintable(name), cells) << name << cells;
        }
    }
    void noPlaneLiesOnAWall()
    {
        QFETCH(QString, name);
        QFETCH(int, cells);
        const LitScene lit(*sampleScene(name.toStdString()));
        for (const float shift : {0.0f, 0.25f, 0.5f, 0.75f, 0.999f}) {
            const GridLattice lattice = placeGrid(*lit.rays, {cells}, shift);
            const glm::vec3 low = lattice.toGrid(lit.scene->bounds.low), high = lattice.toGrid(lit.scene->bounds.high);
            QVERIFY(glm::all(glm::greaterThanEqual(low, glm::vec3(0.0f))));
            QVERIFY(glm::all(glm::lessThanEqual(high, glm::vec3(lattice.cells))));
            QCOMPARE(glm::max(lattice.cells.x, glm::max(lattice.cells.y, lattice.cells.z)), cells);
            for (int axis = 0; axis < 3; ++axis) {
                for (const float wall : wallFractions(*lit.rays, axis, lattice.lowest[axis], lattice.cellSize[axis])) {
                    const float off = std::abs(wall - std::round(wall));
                    QVERIFY2(off >= 1e-3f, qPrintable(QString("shift %1, axis %2: a wall %3 cells from a plane")
                                                          .arg(double(shift))
                                                          .arg(axis)
                                                          .arg(double(off))));
                }
            }
        }
    }

    void flatSpotsOfCurvedSurfaceAreNoWalls() // or lattices of finely divided scenes would lie anywhere
    {
        SceneBuilder builder("ball in a room");
        const int grey = builder.addMaterial("grey", glm::vec3(0.5f));
        builder.add("Room", boxMesh({0.0f, 0.0f, 0.0f}, {2.0f, 1.5f, 1.8f}, Facing::in), grey);
        builder.add("Step", boxMesh({0.5f, 0.0f, 0.5f}, {0.9f, 0.233f, 0.9f}), grey);
        builder.add("Ball", sphereMesh({1.3f, 0.727f, 0.9f}, 0.3f, 200), grey);
        builder.addPoint("Lamp", {0.3f, 1.2f, 0.4f}, glm::vec3(1.0f));
        const LitScene lit(builder.finish());
        const float cell = 0.1f;
        const std::vector<float> found = wallFractions(*lit.rays, 1, 0.0f, cell);
        for (const float place : found) { // floor, ceiling and step
            const float room = std::min(place, 1.0f - place), step = std::abs(place - 0.33f);
            QVERIFY2(std::min(room, step) < 1e-3f, qPrintable(QString::number(double(place))));
        }
        QVERIFY(std::ranges::any_of(found, [](float place) { return std::abs(place - 0.33f) < 1e-3f; }));
    }

    void cellsAreCubesUnlessAskedOtherwise()
    {
        const LitScene lit(*sampleScene("two_rooms"));
        const GridLattice cubes = placeGrid(*lit.rays, {16}, 0.0f);
        QCOMPARE(cubes.cells.x, 16);
        QCOMPARE(cubes.cellSize, glm::vec3(cubes.cellSize.x));
        const GridLattice boxes = placeGrid(*lit.rays, {16, {20, 0, 9}}, 0.0f);
        QCOMPARE(boxes.cells.x, 20);
        QCOMPARE(boxes.cells.y, cubes.cells.y);
        QCOMPARE(boxes.cells.z, 9);
        SceneBuilder sheet("sheet");
        sheet.add("Sheet", quadMesh({0, 0, 0}, {0, 0, 1}, {2, 0, 0}), sheet.addMaterial("grey", glm::vec3(0.5f)));
        sheet.addPoint("Lamp", {0, 1, 0}, glm::vec3(1.0f));
        const LitScene flat(sheet.finish());
        const GridLattice thin = placeGrid(*flat.rays, {8, {0, 4, 0}}, 0.0f);
        QVERIFY(thin.cellSize.y > 0.0f && thin.cells.y == 4);
    }
};

QTEST_APPLESS_MAIN(GridWalkTest)
#include "tst_grid_walk.moc"
