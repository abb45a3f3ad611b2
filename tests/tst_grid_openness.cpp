// SPDX-License-Identifier: Apache-2.0
// Claims: vertices behind walls are told from those in the open; what is open of faces and cells is what geometry says,
// wherever walls cut them; a thin wall hides what is behind it; sight ends at surfaces; far from surface no ray is
// spent.
#include "core/ivg/grid_openness.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

struct Looked {
    GridLattice lattice;
    std::shared_ptr<const GridOpenness> open;
};

Looked look(const LitScene& lit, const GridLattice& lattice, int threads = 2)
{
    Workers workers(threads);
    const auto reach = LightReach::find(*lit.rays, *lit.lights, workers, {});
    return {lattice, findOpenness(*lit.rays, *reach, lattice, workers, {})};
}

/// How much of [at - 1/2, at + 1/2], cut off at 0 and `cells`, lies in [low, high]; all in cells.
double overlap(double at, double low, double high, int cells)
{
    const double begin = std::max(at - 0.5, 0.0), end = std::min(at + 0.5, double(cells));
    return std::max(0.0, std::min(end, high) - std::max(begin, low)) / (end - begin);
}

/// Two closed rooms side by side, a wall between them that is `thick` m; a lamp in each.
Scene twinRooms(float thick)
{
    SceneBuilder builder("twins");
    const int grey = builder.addMaterial("grey", glm::vec3(0.5f));
    builder.add("Left", boxMesh({-2.0f, -1.0f, -1.0f}, {-0.5f * thick, 1.0f, 1.0f}, Facing::in), grey);
    builder.add("Right", boxMesh({0.5f * thick, -1.0f, -1.0f}, {2.0f, 1.0f, 1.0f}, Facing::in), grey);
    builder.addPoint("Left lamp", {-1.0f, 0.1f, 0.2f}, glm::vec3(10.0f));
    builder.addPoint("Right lamp", {1.0f, 0.1f, 0.2f}, glm::vec3(10.0f));
    return builder.finish();
}

} // namespace

class GridOpennessTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void boxWallsCutFacesExactly_data()
    {
        QTest::addColumn<double>("shift");
        for (const double shift : {0.0, 0.13, 0.25, 0.5, 0.75, 0.97}) QTest::addRow("%g", shift) << shift;
    }
    void boxWallsCutFacesExactly()
    {
        QFETCH(double, shift);
        const LitScene lit(furnaceBox(0.5f, 1.0f, {2.0f, 1.7f, 2.3f}));
        const Looked found = look(lit, placeGrid(*lit.rays, {7}, float(shift)));
        const glm::dvec3 low(found.lattice.toGrid(lit.scene->bounds.low));
        const glm::dvec3 high(found.lattice.toGrid(lit.scene->bounds.high));
        std::size_t inside = 0;
        for (std::size_t i = 0; i < found.lattice.vertexCount(); ++i) {
            const glm::ivec3 v = found.lattice.vertex(i);
            const glm::dvec3 at(v);
            const bool isInside = glm::all(glm::greaterThan(at, low)) && glm::all(glm::lessThan(at, high));
            QVERIFY2((found.open->isOpen[i] != 0) == isInside,
                     qPrintable(QString("vertex %1 %2 %3").arg(v.x).arg(v.y).arg(v.z)));
            if (!isInside) continue;
            ++inside;
            glm::dvec3 share;
            for (int axis = 0; axis < 3; ++axis)
                share[axis] = overlap(at[axis], low[axis], high[axis], found.lattice.cells[axis]);
            for (int axis = 0; axis < 3; ++axis) {
                const double expected = share[(axis + 1) % 3] * share[(axis + 2) % 3];
                const double off = std::abs(double(found.open->faceShare[i][axis]) - expected);
                QVERIFY2(off <= 1e-4, qPrintable(QString("face off by %1").arg(off)));
            }
            QVERIFY(std::abs(double(found.open->cellShare[i]) - share.x * share.y * share.z) <= 1e-4);
            for (int axis = 0; axis < 3; ++axis) {
                for (const bool isHigh : {false, true}) {
                    const double way = isHigh ? high[axis] - at[axis] : at[axis] - low[axis];
                    const double sight = double(found.open->sight[i][std::size_t(2 * axis + (isHigh ? 1 : 0))]);
                    QVERIFY(std::abs(sight - std::min(255.0, way * double(GridOpenness::kSightUnits))) <= 1.01);
                }
            }
        }
        QVERIFY(inside > 100);
    }

    void slantedWallsCutFacesToAFewPercent()
    {
        const LitScene lit(concentricSpheres(0.5f, 0.5f)); // light between 0.5 and 1 m
        const GridLattice lattice = placeGrid(*lit.rays, {9}, 0.3f);
        const Looked found = look(lit, lattice);
        RunningMean off;
        Rng rng(1, hashName("areas"), 0);
        for (std::size_t i = 0; i < lattice.vertexCount(); ++i) {
            if (found.open->isOpen[i] == 0) continue;
            const glm::vec3 p = lattice.position(lattice.vertex(i));
            QVERIFY(glm::length(p) > 0.49f && glm::length(p) < 1.01f);
            // a face of which only one sphere cuts a part: no part of it hides behind another
            int open = 0, all = 4000;
            for (int k = 0; k < all; ++k) {
                const float y = rng.uniform() - 0.5f, z = rng.uniform() - 0.5f;
                const float r = glm::length(p + glm::vec3(0.0f, y, z) * lattice.cellSize);
                open += r > 0.5f && r < 1.0f;
            }
            const double share = double(open) / double(all);
            if (share < 0.3 || glm::length(p) < 0.75f) continue; // beside the inner one a part may be hidden
            off.add(double(found.open->faceShare[i].x) - share);
        }
        qInfo("faces off by %+.4f, spread %.4f", off.mean(), std::sqrt(off.variance()));
        QVERIFY(off.count() > 100 && std::abs(off.mean()) <= 0.01 && std::sqrt(off.variance()) <= 0.03);
    }

    void thinWallsHideWhatIsBehind()
    {
        const LitScene lit(twinRooms(0.01f));
        // planes at x = -0.1 and 0.4 m: the wall cuts the faces of the first a tenth of a metre behind it
        const GridLattice lattice{{-2.1f, -1.25f, -1.25f}, glm::vec3(0.5f), {9, 5, 5}};
        const Looked found = look(lit, lattice);
        const std::size_t i = lattice.index({4, 2, 2}); // x = -0.1
        QVERIFY(found.open->isOpen[i] != 0);
        // of a face that faces y, from z by x: open from half a cell before to 0.19 cells behind
        QVERIFY(std::abs(found.open->faceShare[i].y - 0.69f) <= 1e-3f);
        const std::uint64_t parts = found.open->faceParts[i][1]; // bits: z + 8 x
        for (int z = 0; z < 8; ++z) {
            for (int x = 0; x < 8; ++x) QCOMPARE((parts >> (z + 8 * x) & 1) != 0, x < 6);
        }
        QCOMPARE(found.open->sight[i][1], std::uint8_t(0.19f * GridOpenness::kSightUnits));
    }

    void insidesOfBodiesAreShut()
    {
        const LitScene lit(*sampleScene("cornell"));
        const GridLattice lattice = placeGrid(*lit.rays, {32}, 0.0f);
        const Looked found = look(lit, lattice);
        // in the tall block, whose floor is the box's own; in the open; behind the back wall
        const auto at = [&](glm::vec3 p) {
            return found.open->isOpen[lattice.index(glm::ivec3(lattice.toGrid(p) + 0.5f))];
        };
        QCOMPARE(int(at({0.3685f, 0.15f, 0.351f})), 0);
        QCOMPARE(int(at({0.186f, 0.08f, 0.169f})), 0);
        QCOMPARE(int(at({0.28f, 0.4f, 0.28f})), 1);
        QCOMPARE(int(at({0.28f, 0.3f, 0.57f})), 0);
    }

    void whatLiesUnderAFloorIsShut() // also where a body of small triangles, lit above, goes on through it
    {
        const LitScene lit(*figureScene(6000));
        for (const float shift : {0.0f, 0.5f}) {
            const GridLattice lattice = placeGrid(*lit.rays, {32}, shift);
            const Looked found = look(lit, lattice);
            int open = 0, all = 0;
            for (std::size_t v = 0; v < lattice.vertexCount(); ++v) {
                const glm::dvec3 p = lit.scene->toFile(lattice.position(lattice.vertex(v)));
                const bool isUnder = p.y < 0.0 && std::max(std::abs(p.x - 0.28), std::abs(p.z - 0.28)) < 0.2;
                if (!isUnder) continue;
                ++all;
                open += found.open->isOpen[v];
            }
            QVERIFY(all > 100);
            QVERIFY2(open == 0, qPrintable(QString("shift %1: %2 of %3").arg(shift).arg(open).arg(all)));
        }
    }

    void freeSpaceNeedsNoRays()
    {
        const LitScene lit(furnaceBox(0.5f));
        const Looked found = look(lit, placeGrid(*lit.rays, {16}, 0.25f));
        const double inside = std::pow(15.0, 3.0);
        QVERIFY2(double(found.open->nearVertices) <= 0.75 * inside, "vertices of two layers on each side at most");
        QVERIFY(found.open->nearVertices > 1000);
    }

    void threadsChangeNothingAndStopsAreSeen()
    {
        const LitScene lit(*sampleScene("two_rooms"));
        const GridLattice lattice = placeGrid(*lit.rays, {12}, 0.4f);
        const Looked one = look(lit, lattice, 1), five = look(lit, lattice, 5);
        QVERIFY(one.open->isOpen == five.open->isOpen && one.open->faceShare == five.open->faceShare &&
                one.open->faceParts == five.open->faceParts && one.open->cellShare == five.open->cellShare &&
                one.open->cellParts == five.open->cellParts && one.open->sight == five.open->sight);
        std::stop_source source;
        source.request_stop();
        Workers workers(2);
        const auto reach = LightReach::find(*lit.rays, *lit.lights, workers, {});
        QVERIFY(!findOpenness(*lit.rays, *reach, lattice, workers, source.get_token()));
    }
};

QTEST_APPLESS_MAIN(GridOpennessTest)
#include "tst_grid_openness.moc"
