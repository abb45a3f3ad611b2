// SPDX-License-Identifier: Apache-2.0
// Claims: what a screen hides is hidden from photons and from surface alike, to rounding; walls are found and a room's
// own surface, seen from anywhere in it, is not hidden; a dark room keeps its own light up to the foot of a wall with
// a bright one behind it, wherever the lattice lies.
#include "core/base/sampling.h"
#include "core/base/units.h"
#include "core/octree/entry_screens.h"
#include "core/octree/entry_side.h"
#include "core/octree/octree_blend.h"
#include "core/octree/octree_build.h"
#include "core/octree/octree_solver.h"
#include "core/photonmap/density.h"
#include "core/photonmap/screen_finder.h"
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/trace/reference.h"
#include "tests/bake_helpers.h"
#include "tests/light_helpers.h"
#include <QtTest>

using namespace lightloom;
using namespace lightloom::test;

namespace {

const glm::vec3 kUp(0.0f, 1.0f, 0.0f);

/// A room of 8 x 2.8 x 4 m parted at x = 4 by a wall, its other face at 4 + `thick`; a bright lamp before it, one of a
/// two-hundredth of its light behind.
Scene partedRoom(float thick, bool hasDoor = false)
{
    SceneBuilder builder("parted");
    const int white = builder.addMaterial("white", glm::vec3(0.6f));
    builder.add("Room", boxMesh({0.0f, 0.0f, 0.0f}, {8.0f, 2.8f, 4.0f}, Facing::in), white);
    const float end = hasDoor ? 2.0f : 4.1f;
    builder.add("Wall", boxMesh({4.0f, -0.1f, -0.1f}, {4.0f + thick, 2.9f, end}, Facing::out), white);
    builder.addPoint("Bright", {2.0f, 1.8f, 2.0f}, glm::vec3(800.0f / (4.0f * kPi)));
    builder.addPoint("Dim", {6.0f, 1.8f, 2.0f}, glm::vec3(4.0f / (4.0f * kPi)));
    return builder.finish();
}

/// A room with a floor of square tiles.
Scene tiledFloor(float tile)
{
    SceneBuilder builder("tiles");
    Mesh floor;
    for (float x = 0.0f; x < 3.0f; x += tile) {
        for (float z = 0.0f; z < 3.0f; z += tile)
            append(floor, quadMesh({x, 0.0f, z + tile}, {tile, 0.0f, 0.0f}, {0.0f, 0.0f, -tile}));
    }
    const int white = builder.addMaterial("white", glm::vec3(0.6f));
    builder.add("Room", boxMesh({0.0f, -0.5f, 0.0f}, {3.0f, 2.5f, 3.0f}, Facing::in), white);
    builder.add("Floor", std::move(floor), white);
    builder.addPoint("Lamp", {1.0f, 1.0f, 1.0f}, glm::vec3(10.0f));
    return builder.finish();
}

struct Ready {
    explicit Ready(Scene made) : scene(std::move(made))
    {
        reach = LightReach::find(*scene.rays, *scene.lights, workers, {});
        area = SurfaceArea::build(*reach);
        finder = std::make_unique<ScreenFinder>(*scene.rays, *reach, *area);
        shift = scene.scene->toFile(glm::vec3(0.0f));
    }
    [[nodiscard]] glm::vec3 at(glm::dvec3 file) const { return glm::vec3(file - shift); }
    [[nodiscard]] std::vector<Screen> screensAt(glm::dvec3 file, glm::vec3 n = kUp) const
    {
        std::vector<Screen> screens;
        if (!finder->find(at(file), n, 0.03f, 2.0f, screens)) qWarning("buried");
        return screens;
    }
    Workers workers{2};
    LitScene scene;
    std::shared_ptr<const LightReach> reach;
    std::shared_ptr<const SurfaceArea> area;
    std::unique_ptr<ScreenFinder> finder;
    glm::dvec3 shift{0.0};
};

Screen wedge(float turn, float wide, float behind)
{
    const auto direction = [](float angle) { return glm::vec3(std::cos(angle), 0.0f, -std::sin(angle)); };
    Screen screen;
    screen.away = direction(turn), screen.behind = behind;
    screen.sides = {glm::cross(kUp, direction(turn - wide)), glm::cross(direction(turn + wide), kUp)};
    return screen;
}

} // namespace

class TestScreens : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void wedgesHideWhatIsInThem()
    {
        const Screen screen = wedge(0.3f, 0.4f, 1.0f);
        const auto at = [](float angle, float far) { return far * glm::vec3(std::cos(angle), 0.3f, -std::sin(angle)); };
        QVERIFY(screen.hides(at(0.3f, 1.01f)) && !screen.hides(at(0.3f, 0.99f)));
        QVERIFY(screen.hides(at(0.69f, 2.0f)) && !screen.hides(at(0.71f, 2.0f)));
        QVERIFY(screen.hides(at(-0.09f, 2.0f)) && !screen.hides(at(-0.11f, 2.0f)));
        QVERIFY(!screen.hides(at(0.3f, -2.0f)));
    }

    void areaIsWhatIsSeen_data()
    {
        QTest::addColumn<double>("facets");
        QTest::addColumn<double>("off"); // of areas and first moments, of second moments
        QTest::addColumn<double>("offSecond");
        QTest::addColumn<bool>("overlap"); // of what is hidden in all directions with wedges
        for (const bool overlap : {false, true}) {
            const auto row = [&](const char* facets) -> QTestData& {
                return QTest::addRow("%s%s", facets, overlap ? ", overlap" : "");
            };
            row("large") << 0.0 << 2e-3 << 2e-3 << overlap;
            row("10 cm") << 0.1 << 3e-2 << 8e-2 << overlap;   // cut one by one; patches, where nothing hides them
            row("3 cm") << 0.03 << 5e-3 << 1.5e-2 << overlap; // patches
        }
    }
    /// Against a fine raster, on a floor: cut facets, whole ones, many radii at once, and a strip of 2 cm along a wall.
    void areaIsWhatIsSeen()
    {
        QFETCH(double, facets);
        QFETCH(double, off);
        QFETCH(double, offSecond);
        QFETCH(bool, overlap);
        const Ready room(facets > 0.0 ? tiledFloor(float(facets)) : partedRoom(0.2f));
        const glm::dvec3 centre(1.3, 0.0, 1.1);
        std::vector<Screen> screens{wedge(0.2f, 0.5f, 0.3f), wedge(2.2f, 0.3f, 0.8f), wedge(-1.5f, 1.0f, 0.02f)};
        if (overlap) screens.push_back(Screen::beyond(wedge(-0.3f, 0.1f, 0.0f).away, 0.2f));
        const std::array<float, 3> radii{0.25f, 0.7f, 1.0f};
        std::array<AreaMoments, 3> moments;
        room.area->under({room.at(centre), kUp, 1.0f, 0.5f, screens}, radii, moments);
        const Frame frame(kUp);
        std::array<AreaMoments, 3> seen{};
        constexpr int kSteps = 1600;
        const double step = 2.2 / kSteps;
        for (int i = 0; i < kSteps; ++i) {
            for (int k = 0; k < kSteps; ++k) {
                const glm::vec3 d(float((i + 0.5) * step - 1.1), 0.0f, float((k + 0.5) * step - 1.1));
                if (isHidden(screens, d)) continue;
                const double x = double(glm::dot(d, frame.tangent)), y = double(glm::dot(d, frame.bitangent));
                const double a = step * step;
                for (std::size_t j = 0; j < radii.size(); ++j) {
                    if (glm::length(d) < radii[j]) seen[j] += {a, {a * x, a * y}, a * x * x, a * x * y, a * y * y};
                }
            }
        }
        for (std::size_t j = 0; j < radii.size(); ++j) {
            const double r = double(radii[j]), most = off * r * r;
            const AreaMoments &m = moments[j], &s = seen[j];
            QVERIFY2(std::abs(m.area - s.area) <= most && glm::length(m.first - s.first) <= most * r &&
                         std::abs(m.xx - s.xx) + std::abs(m.xy - s.xy) + std::abs(m.yy - s.yy) <=
                             offSecond * r * r * r * r,
                     qPrintable(QString("radius %1: %2 of %3 m2, %4 %5")
                                    .arg(r)
                                    .arg(m.area)
                                    .arg(s.area)
                                    .arg(glm::length(m.first - s.first) / (r * r * r))
                                    .arg((std::abs(m.xx - s.xx) + std::abs(m.xy - s.xy) + std::abs(m.yy - s.yy)) /
                                         (r * r * r * r))));
        }
        QVERIFY(moments[1].area < 0.95 * kPiD * 0.49); // there is something to hide at all
    }

    void gathersTakeWhatIsSeen()
    {
        auto paths = std::make_shared<PhotonPaths>();
        for (std::uint64_t i = 0; i < 5'000; ++i) {
            Rng rng(1, 7, i);
            const glm::vec3 p(rng.uniform() * 2.0f - 1.0f, 0.0f, rng.uniform() * 2.0f - 1.0f);
            paths->photons.push_back({p, kUp, glm::vec3(1.0f), kUp});
        }
        const auto map = PhotonMap::build(paths);
        const std::vector<Screen> screens{wedge(0.2f, 0.5f, 0.1f), wedge(3.0f, 0.7f, 0.2f)};
        for (const std::uint32_t count : {5u, 200u, 6'000u}) {
            Gathered gathered;
            map->gather({glm::vec3(0.1f, 0.0f, 0.0f), kUp, 0.8f, 1.0f, 0.5f, count, screens}, gathered);
            std::vector<std::pair<float, std::uint32_t>> seen;
            for (std::uint32_t i = 0; i < map->size(); ++i) {
                const glm::vec3 d = map->photon(i).position - glm::vec3(0.1f, 0.0f, 0.0f);
                if (glm::length(d) <= 0.8f && !isHidden(screens, d)) seen.push_back({glm::length(d), i});
            }
            std::ranges::sort(seen);
            seen.resize(std::min<std::size_t>(seen.size(), count));
            std::vector<std::uint32_t> expected, found = gathered.photons;
            for (const auto& [far, number] : seen) expected.push_back(number);
            std::ranges::sort(expected), std::ranges::sort(found);
            QVERIFY(!expected.empty() && found == expected);
        }
    }

    void wallsAreFound_data()
    {
        QTest::addColumn<float>("thick");
        for (const float thick : {0.2f, 0.05f, 0.01f}) QTest::addRow("%g m", double(thick)) << thick;
    }
    void wallsAreFound()
    {
        QFETCH(float, thick);
        const Ready room(partedRoom(thick));
        const double foot = 4.0 + double(thick);
        for (const double away : {0.02, 0.1, 0.5, 1.0}) {
            const glm::dvec3 p(foot + away, 0.0, 1.7);
            const std::vector<Screen> screens = room.screensAt(p);
            for (int i = 0; i < 400; ++i) {
                const double x = 2.3 + 0.2 * (i % 20), z = 0.1 + 0.2 * (i / 20);
                const glm::dvec3 q(x, 0.0, z);
                if (glm::length(q - p) > 1.9 || (x > 4.0 && x < foot)) continue;
                const bool isHere = x > foot;
                QVERIFY2(isHidden(screens, glm::vec3(q - p)) == !isHere,
                         qPrintable(QString("%1 %2 from %3: %4").arg(x).arg(z).arg(p.x).arg(isHere)));
            }
        }
    }

    void whatLiesOverAndUnderHidesTheRest() // a table with a thin top
    {
        SceneBuilder builder("table");
        const int white = builder.addMaterial("white", glm::vec3(0.6f));
        builder.add("Room", boxMesh({0, 0, 0}, {4.0f, 2.8f, 4.0f}, Facing::in), white);
        builder.add("Top", boxMesh({1.0f, 0.9f, 1.0f}, {3.0f, 0.92f, 3.0f}, Facing::out), white);
        builder.addPoint("Lamp", {1.5f, 2.0f, 1.5f}, glm::vec3(10.0f));
        builder.addPoint("Below", {1.5f, 0.3f, 1.5f}, glm::vec3(1.0f));
        const Ready room(builder.finish());
        const glm::dvec3 floor(2.0, 0.0, 2.0), top(2.0, 0.92, 2.0), bottom(2.0, 0.9, 2.0);
        const auto isHiddenAt = [&](glm::dvec3 from, glm::vec3 n, glm::dvec3 at) {
            return isHidden(room.screensAt(from, n), glm::vec3(at - from));
        };
        QVERIFY(isHiddenAt(floor, kUp, top) && isHiddenAt(top, kUp, floor));
        QVERIFY(isHiddenAt(bottom, -kUp, {2.0, 2.8, 2.0}));
        for (const double x : {0.2, 0.9, 1.5, 2.5})
            QVERIFY(!isHiddenAt(floor, kUp, {x, 0.0, 2.0}) && !isHiddenAt(top, kUp, {std::max(x, 1.0), 0.92, 2.0}));
        const float r = 1.1f; // the floor alone, without the table's top over it
        const double disc = kPiD * double(r) * double(r);
        const auto under = [&](Screens screens) {
            return room.area->under({room.at(floor), kUp, 1.0f, 0.5f, screens}, r);
        };
        QVERIFY(std::abs(under(room.screensAt(floor)) / disc - 1.0) < 1e-3 && under({}) / disc > 1.2);
        QVERIFY(room.screensAt({0.5, 0.0, 0.5}).empty()); // beside the table nothing is hidden
    }

    void doorsAreLookedThrough() // the wall ends at z = 2
    {
        const Ready room(partedRoom(0.2f, true));
        const glm::dvec3 p(4.7, 0.0, 2.0);
        const std::vector<Screen> screens = room.screensAt(p);
        QVERIFY(isHidden(screens, {-1.0f, 0.0f, -0.6f}) && isHidden(screens, {-1.5f, 0.0f, -1.0f}));
        QVERIFY(!isHidden(screens, {-1.0f, 0.0f, 0.5f}) && !isHidden(screens, {-0.4f, 0.0f, -0.6f}));
    }

    void nothingIsHiddenInConvexRooms()
    {
        SceneBuilder builder("vault");
        const int white = builder.addMaterial("white", glm::vec3(0.6f));
        builder.add("Room", boxMesh({0, 0, 0}, {2, 2, 2}, Facing::in), white);
        builder.add("Ball", sphereMesh({1.0f, 1.0f, 1.0f}, 0.3f, 48), white);
        builder.addPoint("Lamp", {0.3f, 1.8f, 0.3f}, glm::vec3(10.0f));
        const Ready room(builder.finish());
        for (const double x : {0.01, 0.4, 1.99}) QVERIFY(room.screensAt({x, 0.0, 0.7}).empty());
        for (const glm::dvec3 at : {glm::dvec3(1.0, 0.0, 1.0), glm::dvec3(1.0, 1.3, 1.0)}) // below the ball and on it
            QVERIFY(std::ranges::all_of(room.screensAt(at), &Screen::isInAllDirections));
    }

    void crampedPlacesStaySane() // boxes at random, with strips, gaps and wedges of all sizes between them
    {
        SceneBuilder builder("cramped");
        const int white = builder.addMaterial("white", glm::vec3(0.6f));
        builder.add("Room", boxMesh({0, 0, 0}, {4.0f, 2.8f, 4.0f}, Facing::in), white);
        Rng rng(4, 9, 0);
        for (int i = 0; i < 25; ++i) {
            const glm::vec3 at(3.4f * rng.uniform(), i % 3 == 0 ? 1.5f * rng.uniform() : -0.01f, 3.4f * rng.uniform());
            const glm::vec3 size(0.1f + 0.5f * rng.uniform(), 0.1f + rng.uniform(), 0.1f + 0.5f * rng.uniform());
            builder.add("Box", boxMesh(at, at + size), white);
        }
        for (int i = 0; i < 6; ++i) {
            const glm::vec3 at(0.3f + 3.4f * rng.uniform(), 0.3f + 2.0f * rng.uniform(), 0.3f + 3.4f * rng.uniform());
            builder.add("Ball", sphereMesh(at, 0.1f + 0.2f * rng.uniform(), 16), white);
        }
        builder.addPoint("Lamp", {2.0f, 2.6f, 2.0f}, glm::vec3(100.0f));
        BakeParams params;
        params.octreeFirstDepth = 6;
        const auto scene = share(builder.finish());
        const auto most = [&](Switch screens) {
            params.gatherScreens = screens;
            const Baked baked = bakeOctree(scene, params);
            float lux = 0.0f;
            for (const glm::vec3 e : baked.octree()->layers()[0]->scalar) lux = glm::max(lux, luminance(e));
            return std::pair(lux, baked.counters.degenerateEntries);
        };
        const auto with = most(Switch::on), without = most(Switch::off);
        QVERIFY2(with.first <= 3.0f * without.first && with.second == without.second,
                 qPrintable(QString("%1 of %2 lux, %3").arg(with.first).arg(without.first).arg(with.second)));
    }

    void sidesAreHalfSpaces() // 8 + 8 bits: to .01 cells and .7 degrees
    {
        Rng rng(5, 1, 0);
        int beyond = 0;
        for (int i = 0; i < 20'000; ++i) {
            const glm::vec3 n = sampleSphere(rng.uniform(), rng.uniform());
            const Frame frame(n);
            const float turn = 2.0f * kPi * rng.uniform(), least = 2.4f * rng.uniform() - 1.2f;
            const glm::vec3 towards = std::cos(turn) * frame.tangent + std::sin(turn) * frame.bitangent;
            const OctreeEntry entry{{}, n, 1.0f, packSide(n, towards, least)};
            QVERIFY(entry.side != 0);
            const glm::vec3 place = 2.0f * glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) - 1.0f;
            const float off = glm::dot(place, towards) - least;
            const bool is = isBeyond(entry, place);
            beyond += is ? 1 : 0;
            if (std::abs(off) > 0.01f + 0.03f * glm::length(place)) QCOMPARE(is, off < 0.0f);
        }
        QVERIFY(beyond > 5000 && beyond < 15'000);
        QCOMPARE(packSide(kUp, {1.0f, 0.0f, 0.0f}, -1.5f), std::uint16_t(0)); // no lookup goes as far
        QVERIFY(!isBeyond({{}, kUp, 1.0f, 0}, glm::vec3(1.0f)));
    }

    void thinWallsPartLeaves() // one entry of the floor on each side of a wall that stands within a leaf
    {
        const Ready room(partedRoom(0.01f));
        Workers workers(2);
        const auto octree = buildOctree(room.scene.scene->bounds, *room.reach, 6, 0.0f, workers, {});
        QVERIFY(findScreens(*octree, *room.finder, workers, {}));
        const auto entryAt = [&](double x, double z) -> const OctreeEntry& {
            const glm::vec3 p = room.at({x, 0.0, z});
            const glm::vec3 at = (p - octree->lowest) / octree->cellSize();
            std::int64_t leaf = octree->leafAt(glm::ivec3(glm::floor(at + 0.01f * kUp)));
            if (leaf < 0) leaf = octree->leafAt(glm::ivec3(glm::floor(at - 0.01f * kUp)));
            if (leaf < 0) qFatal("no leaf at %g %g", x, z);
            const EntryThere there = entryFor(*octree, leaf, kUp, at - glm::floor(at) - 0.5f);
            if (there.isBeyond) qWarning("beyond at %g %g", x, z);
            return octree->entries[static_cast<std::size_t>(there.entry)];
        };
        const float wall = room.at({4.005, 0.0, 0.0}).x;
        for (double z = 0.1; z < 3.9; z += 0.02) {
            for (const double off : {0.015, 0.03, 0.06}) {
                const OctreeEntry &before = entryAt(4.0 - off, z), &behind = entryAt(4.01 + off, z);
                QVERIFY2(before.centroid.x < wall && behind.centroid.x > wall, qPrintable(QString::number(z)));
                QVERIFY(before.side != 0 && behind.side != 0);
            }
            QCOMPARE(entryAt(3.0, z).side, 0u);
        }
    }

    void darkRoomsStayDark_data()
    {
        QTest::addColumn<int>("room");
        QTest::addColumn<float>("shift");
        for (int room = 0; room < static_cast<int>(kRooms.size()); ++room) {
            const auto [thick, hasDoor] = kRooms[static_cast<std::size_t>(room)];
            for (const float shift : {0.0f, 0.25f, 0.5f, 0.75f})
                QTest::addRow("%g cm, %s, shift %g", 100.0 * double(thick), hasDoor ? "door" : "closed", double(shift))
                    << room << shift;
        }
    }
    void darkRoomsStayDark()
    {
        QFETCH(int, room);
        QFETCH(float, shift);
        const auto [thick, hasDoor] = kRooms[static_cast<std::size_t>(room)];
        const Ready parted(partedRoom(thick, hasDoor));
        std::vector<ProbePoint> points;
        std::uint64_t stream = 0;
        for (const double x : {3.97, 3.9, 4.03 + double(thick), 4.1 + double(thick)}) {
            for (int i = 0; i < 24; ++i)
                points.push_back({parted.at({x, 0.0, hasDoor ? 0.3 + 0.05 * i : 0.3 + 0.145 * i}), kUp, stream++});
        }
        ReferenceJob job;
        job.paths = 1024;
        Workers workers(2);
        const auto truth =
            referenceIlluminance(*parted.scene.rays, *parted.scene.lights, {}, points, job, workers, {}).probes;
        double beyond = 0.0;
        const auto means = [&](Switch screens) {
            BakeParams params;
            params.photonCount = 1'000'000, params.octreeFirstDepth = 6;
            params.gridShift = shift, params.gatherScreens = screens;
            OctreeSolver solver;
            const Baked baked =
                runSolver(solver, {parted.scene.scene, params, {}}, products_[static_cast<std::size_t>(room)]);
            std::array<double, 4> ratio{}, lux{}, expected{};
            for (std::size_t i = 0; i < points.size(); ++i) {
                lux[i / 24] += double(luminance(baked.field->irradiance(points[i].position, kUp))) / 24.0;
                expected[i / 24] += double(luminance(truth[i].indirect)) / 24.0;
            }
            for (std::size_t i = 0; i < 4; ++i) ratio[i] = lux[i] / expected[i];
            qInfo("lit %.3f %.3f dark %.3f %.3f of the reference; beyond it %.4f %% of the lit side", ratio[0],
                  ratio[1], ratio[2], ratio[3], 100.0 * (lux[2] - expected[2]) / expected[0]);
            beyond = (lux[2] - expected[2]) / expected[0];
            return ratio;
        };
        for (const double ratio : means(Switch::on))
            QVERIFY2(std::abs(ratio - 1.0) <= 0.1, qPrintable(QString::number(ratio)));
        QVERIFY2(beyond < 0.01, qPrintable(QString::number(beyond))); // of the lit side
        if (room != 0 || shift > 0.0f) return;
        QVERIFY(std::abs(means(Switch::off)[2] - 1.0) > 0.1); // what this is all about
    }

private:
    struct Parted {
        float thick; // metres; cells have 13 cm
        bool hasDoor;
    };
    static constexpr std::array<Parted, 4> kRooms{{{0.2f, false}, {0.2f, true}, {0.05f, false}, {0.001f, false}}};
    std::array<BakeProducts, kRooms.size()> products_; // photons are shot once
};

QTEST_GUILESS_MAIN(TestScreens)
#include "tst_screens.moc"
