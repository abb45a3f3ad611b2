// SPDX-License-Identifier: Apache-2.0
// Claims: probe points are uniform over what light reaches: none under furniture, some behind it where a gap lets light
// in; in the open, all that a lamp lights is reached, and its backs are not, nor the inside of a closed body; reach and
// points are the same on any number of threads; joined to fewer facets it is the same surface.
#include "bake_helpers.h"
#include "core/photonmap/surface_area.h"
#include "core/scene/gltf_reader.h"
#include "core/scene/gltf_writer.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/trace/light_reach.h"
#include "core/trace/light_spaces.h"
#include "core/trace/side_elements.h"
#include "light_helpers.h"
#include <QTemporaryDir>
#include <QTest>
#include <array>
#include <map>
#include <numbers>

using namespace lightloom;
using namespace lightloom::test;

namespace {

constexpr float kGap = 0.05f; ///< between the cupboard and the wall behind it, metres

/// 4 x 3 x 4 m with a lamp, a bench whose back board is pushed into it, and a cupboard that stands a little off the
/// wall. All stand 5 mm deep in the floor.
Scene furnishedRoom()
{
    SceneBuilder builder("furnished room");
    const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
    CellPlan plan;
    plan.xs = {0.0f, 4.0f};
    plan.ys = {0.0f, 3.0f};
    plan.zs = {0.0f, 4.0f};
    plan.isAir = [](glm::vec3) { return true; };
    plan.materialOf = [=](glm::vec3, glm::vec3) { return grey; };
    builder.add("Room", cellShell(plan));
    builder.add("Bench", boxMesh({1.0f, -0.005f, 1.0f}, {2.0f, 0.4f, 2.0f}), grey);
    builder.add("Back board", boxMesh({1.0f, -0.005f, 1.7f}, {2.0f, 0.8f, 2.1f}), grey);
    builder.add("Cupboard", boxMesh({2.5f, -0.005f, 3.5f}, {3.5f, 1.0f, 4.0f - kGap}), grey);
    builder.addPoint("Lamp", {2.0f, 2.5f, 1.5f}, glm::vec3(100.0f));
    return builder.finish();
}

struct Box {
    glm::dvec3 low, high;
    [[nodiscard]] bool holds(glm::dvec3 p) const
    {
        return glm::all(glm::greaterThan(p, low + 1e-4)) && glm::all(glm::lessThan(p, high - 1e-4));
    }
};
// down to -1: the floor under a body is in it
const Box kBench{{1.0, -1.0, 1.0}, {2.0, 0.4, 2.0}}, kBoard{{1.0, -1.0, 1.7}, {2.0, 0.8, 2.1}},
    kCupboard{{2.5, -1.0, 3.5}, {3.5, 1.0, 4.0 - double(kGap)}};

/// `columns` x `rows` tiles of `size` metres from the origin, which face up.
Mesh tiles(int columns, int rows, float size)
{
    Mesh floor;
    for (int i = 0; i < columns; ++i) {
        for (int k = 0; k < rows; ++k) {
            const glm::vec3 corner(static_cast<float>(i) * size, 0.0f, static_cast<float>(k + 1) * size);
            append(floor, quadMesh(corner, {size, 0.0f, 0.0f}, {0.0f, 0.0f, -size}));
        }
    }
    return floor;
}

/// Area of what is reached and faces up, and of the rest.
struct Lit {
    double up = 0.0, other = 0.0;
    std::map<long, double> upAt; ///< of `up`, by height in millimetres
};
Lit litArea(SceneBuilder& builder)
{
    const auto rays = *RayScene::build(share(builder.finish()));
    Workers workers(2);
    Lit lit;
    const auto reach = LightReach::find(*rays, LightSampler(rays), workers, {});
    for (const ReachedFacet& f : reach->facets()) {
        const double area = 0.5 * glm::length(glm::cross(glm::dvec3(f.b) - glm::dvec3(f.a), glm::dvec3(f.c - f.a)));
        (f.normal.y > 0.99f ? lit.up : lit.other) += area;
        if (f.normal.y > 0.99f) lit.upAt[std::lround(1000.0 * rays->scene().toFile(f.a).y)] += area;
    }
    return lit;
}

struct Sampled {
    std::shared_ptr<const LightReach> reach;
    std::vector<SurfacePoint> points;
};

Sampled sampleScene(const Scene& scene, std::uint64_t count, int threads)
{
    const auto rays = *RayScene::build(share(scene));
    const LightSampler lights(rays);
    Workers workers(threads);
    Sampled sampled{LightReach::find(*rays, lights, workers, {}), {}};
    sampled.points = samplePoints(*rays, lights, *sampled.reach, count, 1);
    return sampled;
}

} // namespace

class LightReachTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void noProbeLiesInADarkBody()
    {
        const Scene scene = furnishedRoom();
        std::uint64_t behind = 0, ceiling = 0;
        const auto points = sampleScene(scene, 8'000, 2).points;
        QCOMPARE(points.size(), std::size_t(8'000));
        for (const SurfacePoint& point : points) {
            const glm::dvec3 p = scene.toFile(point.position);
            QVERIFY2(!kBench.holds(p) && !kBoard.holds(p) && !kCupboard.holds(p),
                     qPrintable(QString("%1 %2 %3").arg(p.x).arg(p.y).arg(p.z)));
            behind += p.x > 2.5 && p.x < 3.5 && p.y < 1.0 && p.z > 3.9;
            ceiling += p.y > 2.999;
        }
        // area: the room's 80 m2 less what stands on the floor, plus the bodies' outsides
        const double bench = 2 * 0.7 * 0.4 + 0.4 + 0.7, board = 0.8 + 0.4 + 2 * 0.4 * 0.8 + 0.4,
                     cupboard = 2 * 1.0 + 2 * 0.45 + 0.45;
        const double all = 80.0 - 1.1 - 0.45 + bench + board + cupboard;
        const auto expect = [&](std::uint64_t found, double area, const char* what) {
            const double share = area / all, sigma = std::sqrt(8'000.0 * share * (1.0 - share));
            QVERIFY2(std::abs(static_cast<double>(found) - 8'000.0 * share) <= 4.9 * sigma,
                     qPrintable(QString("%1: %2 for %3").arg(what).arg(found).arg(8'000.0 * share)));
        };
        expect(ceiling, 16.0, "ceiling");
        expect(behind, 2.0 + double(kGap), "behind the cupboard"); // its back, the wall, the floor between
    }

    /// A body of small facets is one surface inside: a single ray that goes astray in a crease would light all of it.
    void creasedBodiesStayDarkInside()
    {
        const QTemporaryDir folder;
        const std::string file = folder.filePath("figure.glb").toStdString();
        const Result<Scene> figure = lightloom::sampleScene("figure", 24'000);
        QVERIFY(figure && writeGltf(*figure, file)); // as it is read it lies a little differently, in the wrong place
        const auto read = readScene(file);
        QVERIFY(bool(read));
        for (const Scene& made : {*figure, **read}) {
            const LitScene scene(made);
            Workers workers(2);
            const auto reach = LightReach::find(*scene.rays, *scene.lights, workers, {});
            QVERIFY(reach->facets().size() > 24'000);
            for (const ReachedFacet& f : reach->facets()) QVERIFY(f.side % 2 == 0);
        }
    }

    void allOfAnOpenFloorIsReached_data()
    {
        QTest::addColumn<double>("tile");
        QTest::addColumn<QString>("lamp");
        for (const double tile : {0.05, 0.1, 0.3, 3.0}) QTest::addRow("point, %g m", tile) << tile << "point";
        for (const char* lamp : {"spots", "sun", "panel"}) QTest::addRow("%s", lamp) << 0.1 << lamp;
    }
    void allOfAnOpenFloorIsReached() // no room around it: its parts see each other nowhere, only the lamp
    {
        QFETCH(double, tile);
        QFETCH(QString, lamp);
        SceneBuilder builder("open floor");
        const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
        const int across = static_cast<int>(std::lround(3.0 / tile));
        builder.add("Floor", tiles(across, across, static_cast<float>(tile)), grey);
        if (lamp == "point") builder.addPoint("Lamp", {1.0f, 1.0f, 1.0f}, glm::vec3(10.0f));
        if (lamp == "sun") builder.addDirectional("Sun", {1.0f, -2.0f, 0.5f}, glm::vec3(100.0f));
        if (lamp == "panel") {
            const int glow = builder.addEmitter("glow", glm::vec3(50.0f));
            builder.add("Panel", quadMesh({1.0f, 2.0f, 1.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}), glow);
        }
        for (int i = 0; i < 36 && lamp == "spots"; ++i) { // one group; each lights its own piece
            const glm::vec3 at(0.25f + 0.5f * static_cast<float>(i % 6), 1.0f,
                               0.25f + 0.5f * static_cast<float>(i / 6));
            builder.addSpot("Spot " + std::to_string(i), at, at - glm::vec3(0.0f, 1.0f, 0.0f), glm::vec3(10.0f), 0.4f,
                            0.42f, "Spots");
        }
        const Lit lit = litArea(builder);
        QVERIFY2(std::abs(lit.up - 9.0) <= 0.009, qPrintable(QString("%1 of 9 m2").arg(lit.up)));
        const double panel = lamp == "panel" ? 1.0 : 0.0;
        QVERIFY2(lit.other <= panel + 1e-5, qPrintable(QString("%1 m2 of backs").arg(lit.other)));
    }

    void anOpenFloorCountsUnderKernels() // or densities there come out too high
    {
        SceneBuilder builder("open floor");
        builder.add("Floor", tiles(30, 30, 0.1f), builder.addMaterial("grey", glm::vec3(0.6f)));
        builder.addPoint("Lamp", {1.0f, 1.0f, 1.0f}, glm::vec3(10.0f));
        const auto rays = *RayScene::build(share(builder.finish()));
        Workers workers(2);
        const auto reach = LightReach::find(*rays, LightSampler(rays), workers, {});
        const auto area = SurfaceArea::build(*reach);
        const std::array radii{0.02f, 0.1f, 0.3f};
        for (const SurfacePoint& at : samplePoints(*rays, LightSampler(rays), *reach, 500, 1)) {
            const glm::dvec3 p = rays->scene().toFile(at.position);
            if (!(std::max(std::abs(p.x - 1.5), std::abs(p.z - 1.5)) < 1.2))
                continue; // the widest disc ends at the rim
            std::array<AreaMoments, 3> under;
            area->under({at.position, at.normal, 1.0f, 0.5f}, radii, under);
            for (std::size_t i = 0; i < radii.size(); ++i) {
                const double disc = std::numbers::pi * std::pow(static_cast<double>(radii[i]), 2.0);
                QVERIFY2(std::abs(under[i].area - disc) <= 0.005 * disc,
                         qPrintable(QString::number(under[i].area / disc)));
            }
        }
    }

    void whatStandsInTheOpenIsReached() // its sides see the floor; tops see the lamp only
    {
        SceneBuilder builder("open place");
        const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
        builder.add("Floor", tiles(60, 60, 0.1f), grey);
        builder.add("Chest", boxMesh({1.0f, -0.005f, 4.0f}, {2.0f, 0.4f, 5.0f}), grey);
        builder.addPoint("Lamp", {2.0f, 1.5f, 3.5f}, glm::vec3(100.0f));
        const Lit lit = litArea(builder);
        const auto expect = [](double found, double area, double more, const char* what) {
            QVERIFY2(found >= 0.999 * area && found <= area + more + 1e-4,
                     qPrintable(QString("%1 of %2 m2: %3").arg(found).arg(area).arg(what)));
        };
        expect(lit.upAt.at(0), 35.0, 1.0, "floor"); // one element for its small tiles, what is hidden of it as well
        expect(lit.upAt.contains(400) ? lit.upAt.at(400) : 0.0, 1.0, 0.0, "top");
        expect(lit.other, 4.0 * 0.4, 4.0 * 0.005, "sides");
    }

    /// The quick refusal must never refuse what a sampled point would have seen before itself.
    void refusedElementsFaceNothing()
    {
        const auto rays = *RayScene::build(share(furnishedRoom()));
        Workers workers;
        const auto made = SideElements::build(*rays, SpaceDetail{}.depth, workers, {});
        const SideElements& elements = *made;
        Rng rng(7, 0, 0);
        std::uint64_t refused = 0, facing = 0;
        for (int i = 0; i < 200'000; ++i) {
            const auto pick = [&] { return static_cast<std::uint32_t>(rng.bits() % elements.count()); };
            const std::uint32_t element = pick();
            glm::vec3 p, n, q, m;
            if (!elements.sample(element, rng, p, n) || !elements.sample(pick(), rng, q, m)) continue;
            p = rays->leave(p, n), q = rays->leave(q, m);
            const bool isFacing = glm::dot(q - p, n) > 0.0f && glm::dot(q - p, m) < 0.0f;
            const bool canFace = elements.canFace(element, q, m);
            refused += !canFace;
            facing += isFacing;
            QVERIFY2(canFace || !isFacing, qPrintable(QString("element %1").arg(element)));
        }
        QVERIFY2(refused > 50'000 && facing > 20'000, qPrintable(QString("%1 %2").arg(refused).arg(facing)));
    }

    void joinedPartsAreTheSameSurface()
    {
        const Sampled sampled = sampleScene(furnishedRoom(), 0, 2);
        const std::vector<ReachedFacet>& fine = sampled.reach->facets();
        const std::vector<ReachedFacet> fewer = sampled.reach->fewerFacets();
        QVERIFY2(fewer.size() * 4 < fine.size(), qPrintable(QString("%1 of %2").arg(fewer.size()).arg(fine.size())));
        // per side: area, and its first moments
        const auto momentsOf = [](const std::vector<ReachedFacet>& facets) {
            std::map<std::uint32_t, glm::dvec4> sums;
            for (const ReachedFacet& f : facets) {
                const glm::dvec3 a(f.a), b(f.b), c(f.c);
                const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
                sums[f.side] += area * glm::dvec4((a + b + c) / 3.0, 1.0);
            }
            return sums;
        };
        const auto before = momentsOf(fine), after = momentsOf(fewer);
        QCOMPARE(after.size(), before.size());
        for (const auto& [side, sum] : before) QVERIFY(glm::length(after.at(side) - sum) <= 1e-5 * sum.w);
    }

    void anyNumberOfThreadsFindsTheSame()
    {
        const Scene scene = furnishedRoom();
        const Sampled one = sampleScene(scene, 500, 1), three = sampleScene(scene, 500, 3);
        QCOMPARE(one.reach->facets().size(), three.reach->facets().size());
        for (std::size_t i = 0; i < one.reach->facets().size(); ++i) {
            const ReachedFacet &a = one.reach->facets()[i], &b = three.reach->facets()[i];
            QVERIFY(a.a == b.a && a.b == b.b && a.c == b.c && a.side == b.side);
        }
        for (std::size_t i = 0; i < 500; ++i) QVERIFY(one.points[i].position == three.points[i].position);
    }

    void roughlyIsNearlyTheSame() // good enough for a first picture: what lies half in the open counts whole
    {
        for (const char* name : {"cornell", "two_rooms", "gallery"}) {
            const test::LitScene lit(*sampleScene(name));
            const Scene& scene = lit.rays->scene();
            Workers workers;
            const auto areaOf = [&](SpaceDetail detail) {
                const auto spaces = LightSpaces::build(lit.rays, detail, workers, {});
                std::vector<std::shared_ptr<const GroupReach>> groups;
                for (int g = 0; g < static_cast<int>(scene.groups.size()); ++g)
                    groups.push_back(spaces->ofGroup(scene, *lit.lights, g, workers, {}));
                return LightReach::of(spaces->elements(), spaces->united(groups, workers, {}), {})->area();
            };
            const double more = areaOf(SpaceDetail::rough()) / areaOf({}) - 1.0;
            QVERIFY2(more > 0.0 && more < 0.04, qPrintable(QString("%1: %2").arg(name).arg(more)));
        }
    }
};

QTEST_APPLESS_MAIN(LightReachTest)
#include "tst_light_reach.moc"
