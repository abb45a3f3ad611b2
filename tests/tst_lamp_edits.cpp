// SPDX-License-Identifier: Apache-2.0
// Claims: a lamp that is moved, turned or dimmed in the file's sense is retraced alone, everything kept for the others
// stays; a bake is the same bytes whether its scene came by edits or was opened so; a lamp that shines into another
// room changes what is reached, and only then; what a drag leaves does not pile up.
#include "core/bake/bake_file.h"
#include "core/bake/bake_session.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "tests/bake_helpers.h"
#include <QtTest>
#include <cstring>

using namespace lightloom;
using namespace lightloom::test;

namespace {

BakeParams quick(int depth = 5, int detail = 0)
{
    BakeParams params;
    params.photonCount = 5'000;
    params.gatherCount = 30;
    params.octreeDepth = depth;
    params.octreeDetail = detail; // 0: gathers are counted by entries; tst_octree_detail looks at deeper leaves
    return params;
}

std::size_t lampNamed(const Scene& scene, const std::string& part)
{
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        if (scene.lights[i].node.find(part) != std::string::npos) return i;
    }
    qFatal("no lamp %s", part.c_str());
}

std::shared_ptr<const Scene> edited(const std::shared_ptr<const Scene>& scene, const std::function<void(Scene&)>& edit)
{
    auto copy = std::make_shared<Scene>(*scene);
    edit(*copy);
    return copy;
}

std::shared_ptr<const Scene> moved(const std::shared_ptr<const Scene>& scene, std::size_t lamp, glm::vec3 shift)
{
    return edited(scene, [&](Scene& s) { s.lights[lamp].position += shift; });
}

std::vector<std::uint8_t> bytesOf(const Baked& baked, const Scene& scene)
{
    BakeInfo info;
    info.params = quick(4, 1);
    info.sceneHash = sceneHash(scene);
    info.isa = "avx2";
    info.program = "test";
    const auto bytes = bakeBytes(*baked.field, info, scene);
    if (!bytes) qFatal("%s", bytes.error().message.c_str());
    return *bytes;
}

/// Rooms of 4 x 3 x 4 m side by side without an opening, the first with two lamps.
std::shared_ptr<const Scene> closedRooms()
{
    SceneBuilder builder("closed rooms");
    const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
    CellPlan plan;
    plan.xs = {0.0f, 4.0f, 4.2f, 8.2f};
    plan.ys = {0.0f, 3.0f};
    plan.zs = {0.0f, 4.0f};
    plan.isAir = [](glm::vec3 p) { return p.x < 4.0f || p.x > 4.2f; };
    plan.materialOf = [=](glm::vec3, glm::vec3) { return grey; };
    builder.add("Rooms", cellShell(plan));
    builder.add("Chest", boxMesh({2.0f, -0.005f, 1.0f}, {3.0f, 0.8f, 2.0f}), grey);
    builder.addPoint("Still", {1.0f, 2.5f, 1.0f}, glm::vec3(100.0f));
    builder.addPoint("Moved", {2.0f, 2.0f, 3.0f}, glm::vec3(60.0f));
    return share(builder.finish());
}

/// Two rooms of 4 x 1.5 x 4 m that no light joins, on one floor of 10 cm triangles that goes through under the wall,
/// with a lamp in each.
std::shared_ptr<const Scene> roomsOnOneFloor(const std::string& firstGroup, const std::string& secondGroup)
{
    SceneBuilder builder("rooms on one floor");
    const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
    CellPlan plan;
    plan.xs = {0.0f, 4.0f, 4.2f, 8.2f};
    plan.ys = {-0.1f, 1.5f};
    plan.zs = {0.0f, 4.0f};
    plan.isAir = [](glm::vec3 p) { return p.x < 4.0f || p.x > 4.2f; };
    plan.materialOf = [=](glm::vec3, glm::vec3) { return grey; };
    builder.add("Rooms", cellShell(plan));
    Mesh floor;
    constexpr std::uint32_t kWide = 84, kDeep = 42;
    for (std::uint32_t z = 0; z <= kDeep; ++z) {
        for (std::uint32_t x = 0; x <= kWide; ++x) {
            floor.positions.emplace_back(0.1f * static_cast<float>(x) - 0.1f, 0.0f,
                                         0.1f * static_cast<float>(z) - 0.1f);
            if (x == kWide || z == kDeep) continue;
            const std::uint32_t at = z * (kWide + 1) + x, below = at + kWide + 1;
            floor.triangles.emplace_back(at, below, at + 1);
            floor.triangles.emplace_back(at + 1, below, below + 1);
        }
    }
    builder.add("Floor", std::move(floor), grey);
    builder.addPoint("First", {1.0f, 1.2f, 1.0f}, glm::vec3(100.0f), firstGroup);
    builder.addPoint("Second", {6.2f, 1.0f, 3.0f}, glm::vec3(60.0f), secondGroup);
    return share(builder.finish());
}

std::shared_ptr<const LightReach> reachOf(const std::shared_ptr<const Scene>& scene)
{
    const auto rays = *RayScene::build(scene);
    Workers workers(2);
    return LightReach::find(*rays, LightSampler(rays), workers, {});
}

bool areAlike(const LightReach& a, const LightReach& b)
{
    const auto alike = [](const ReachedFacet& x, const ReachedFacet& y) {
        return x.side == y.side && x.a == y.a && x.b == y.b && x.c == y.c;
    };
    return std::ranges::equal(a.facets(), b.facets(), alike);
}

} // namespace

class LampEditsTest : public QObject {
    Q_OBJECT
    const std::shared_ptr<const Scene> gallery_ = share(gallery());
    const std::size_t bench_ = lampNamed(*gallery_, "bench");

private Q_SLOTS:
    void hashesTellLampsFromSurface()
    {
        const auto base = gallery_;
        const int group = base->lights[bench_].group;
        const auto differs = [&](const Scene& other) {
            std::vector<int> groups;
            for (int g = 0; g < static_cast<int>(base->groups.size()); ++g) {
                if (lampHash(*base, g) != lampHash(other, g)) groups.push_back(g);
            }
            return groups;
        };
        const std::vector<std::function<void(PunctualLight&)>> edits{[](PunctualLight& l) { l.position.x += 0.1f; },
                                                                     [](PunctualLight& l) {
                                                                         l.travel = {1, 0, 0};
                                                                     },
                                                                     [](PunctualLight& l) { l.intensity *= 1.5f; },
                                                                     [](PunctualLight& l) { l.outerCone = 0.3f; }};
        for (const auto& edit : edits) {
            const auto other = edited(base, [&](Scene& s) { edit(s.lights[bench_]); });
            QVERIFY(isSameSurface(*base, *other));
            QVERIFY(surfaceHash(*base) == surfaceHash(*other));
            QVERIFY(sceneHash(*base) != sceneHash(*other));
            QCOMPARE(differs(*other), std::vector<int>{group});
        }
        // a panel's glow is its lamp's; its place is surface
        std::size_t panel = 0;
        while (base->instances[panel].group < 0) ++panel;
        const auto mesh = static_cast<std::size_t>(base->instances[panel].mesh);
        const auto material = static_cast<std::size_t>(base->meshes[mesh].material);
        const auto brighter = edited(base, [&](Scene& s) { s.materials[material].emission *= 2.0f; });
        QVERIFY(isSameSurface(*base, *brighter) && surfaceHash(*base) == surfaceHash(*brighter));
        QCOMPARE(differs(*brighter), std::vector<int>{base->instances[panel].group});
        const auto lower = edited(base, [&](Scene& s) { s.instances[panel].toWorld[3].y -= 0.1f; });
        QVERIFY(!isSameSurface(*base, *lower) && surfaceHash(*base) != surfaceHash(*lower));
        const auto darker = edited(base, [&](Scene& s) { s.materials[0].baseColor *= 0.5f; });
        QVERIFY(!isSameSurface(*base, *darker) && surfaceHash(*base) != surfaceHash(*darker));
    }

    void copiesShareMeshesUntilOneChanges()
    {
        const auto copy = edited(gallery_, [&](Scene& s) { s.lights[0].position.x = 1.0f; });
        QVERIFY(copy->meshes.isSharedWith(gallery_->meshes) && copy->images.isSharedWith(gallery_->images));
        const glm::vec3 before = gallery_->meshes[0].positions[0];
        const auto other = edited(gallery_, [&](Scene& s) { s.meshes[0].positions[0] += glm::vec3(1.0f); });
        QVERIFY(gallery_->meshes[0].positions[0] == before && other->meshes[0].positions[0] != before);
        QVERIFY(!other->meshes.isSharedWith(gallery_->meshes));
    }

    void aMovedLampIsRetracedAlone()
    {
        BakeProducts products;
        OctreeSolver solver;
        const Baked before = runSolver(solver, {gallery_, quick(), {}}, products);
        QVERIFY2(before.error.empty(), before.error.c_str());
        const Baked after = runSolver(solver, {moved(gallery_, bench_, {0.4f, -0.2f, 0.1f}), quick(), {}}, products);
        const auto groups = gallery_->groups.size();
        const WorkCounters& did = after.counters;
        QCOMPARE(did.photonsShot, std::uint64_t(5'000));
        QCOMPARE(did.groupsReused, std::uint64_t(groups - 1));
        QCOMPARE(did.photonsReused, std::uint64_t((groups - 1) * 5'000));
        std::uint64_t entries = 0; // of one lamp, over the depths
        for (const Snapshot& s : after.snapshots) {
            entries += std::static_pointer_cast<const LightOctree>(s.field)->geometry().entries.size();
        }
        QCOMPARE(did.gathers, entries);
        for (const StageCost& s : did.stages) {
            const bool isOfLamp = s.stage == "shoot" || s.stage == "tree" || s.stage.starts_with("gather") ||
                                  s.stage == "lamps" || s.stage == "reach"; // that this lamp stands in the same room
            QVERIFY2(s.isKept || isOfLamp, s.stage.c_str());
        }
        const auto old = before.octree(), now = after.octree();
        QCOMPARE(&old->geometry(), &now->geometry());
        for (std::size_t g = 0; g < groups; ++g) {
            QCOMPARE(old->layers()[g] == now->layers()[g], static_cast<int>(g) != gallery_->lights[bench_].group);
        }
    }

    void editsAndAFreshStartGiveTheSameBytes_data()
    {
        QTest::addColumn<std::shared_ptr<const Scene>>("scene");
        QTest::addRow("gallery") << gallery_;
        QTest::addRow("closed rooms") << closedRooms();
        QTest::addRow("atrium") << share(atrium());
    }
    void editsAndAFreshStartGiveTheSameBytes()
    {
        QFETCH(std::shared_ptr<const Scene>, scene);
        const std::size_t last = scene->lights.size() - 1;
        std::vector<std::shared_ptr<const Scene>> steps{scene};
        steps.push_back(moved(scene, last, {0.3f, 0.0f, 0.1f}));
        steps.push_back(edited(steps.back(), [&](Scene& s) { s.lights[last].intensity *= 0.5f; }));
        steps.push_back(moved(scene, last, {4.0f, -0.1f, 0.0f})); // in closed rooms: through the wall
        steps.push_back(edited(steps.back(), [&](Scene& s) {
            s.lights[last].travel = glm::normalize(s.lights[last].travel + glm::vec3(0.1f, 0.0f, 0.2f));
        }));
        steps.push_back(moved(steps.back(), 0, {0.0f, -0.3f, 0.2f}));
        BakeProducts kept;
        OctreeSolver solver;
        for (const auto& step : steps) {
            const Baked byEdit = runSolver(solver, {step, quick(4, 1), {}}, kept, 2);
            QVERIFY2(byEdit.error.empty(), byEdit.error.c_str());
            BakeProducts none; // read anew: nothing is shared with what was edited
            const Baked fresh = runSolver(solver, {share(Scene(*step)), quick(4, 1), {}}, none, 3);
            QVERIFY(bytesOf(byEdit, *step) == bytesOf(fresh, *step));
        }
    }

    void reachIsTheSameWhereverALampStandsInARoom()
    {
        const auto first = reachOf(gallery_);
        for (int i = 1; i <= 12; ++i) {
            const auto step = static_cast<float>(i);
            const auto other = reachOf(moved(gallery_, bench_, {0.5f * step, -0.12f * step, -0.03f * step}));
            QVERIFY2(areAlike(*first, *other), qPrintable(QString("step %1").arg(i)));
        }
    }

    void aLampThatShinesIntoAnotherRoomReachesMore()
    {
        const auto scene = closedRooms();
        const auto crossed = moved(scene, 1, {4.0f, 0.0f, 0.0f}), back = moved(crossed, 1, {-4.0f, 0.0f, 0.0f});
        const auto one = reachOf(scene), both = reachOf(crossed);
        // 80 m2 of room less the chest's foot, its sides and top; the other room is bare
        const double room = 80.0 - 1.0 + 1.0 + 4.0 * 0.8;
        // elements are 13 cm wide: those under the chest's sides count whole
        QVERIFY2(std::abs(one->area() - room) < 0.6, qPrintable(QString::number(one->area())));
        QVERIFY2(std::abs(both->area() - one->area() - 80.0) < 1e-3, qPrintable(QString::number(both->area())));
        BakeProducts products;
        OctreeSolver solver;
        const Baked a = runSolver(solver, {scene, quick(), {}}, products);
        const Baked b = runSolver(solver, {crossed, quick(), {}}, products);
        QCOMPARE(b.counters.photonsShot, std::uint64_t(5'000)); // photons of the still one stay all the same
        QCOMPARE(b.counters.gathers,
                 2 * (b.counters.entries +
                      std::static_pointer_cast<const LightOctree>(b.snapshots[0].field)->geometry().entries.size()));
        const Baked c = runSolver(solver, {back, quick(), {}}, products);
        QCOMPARE(c.counters.photonsShot, std::uint64_t(0)); // undo: all of it is there
        QCOMPARE(c.counters.gathers, std::uint64_t(0));
        QVERIFY(c.octree()->layers() == a.octree()->layers());
    }

    /// What the rooms share is one element, which each reaches; the group must find the other room all the same.
    void aGroupReachesBothRoomsThatShareAFloor()
    {
        const auto joint = reachOf(roomsOnOneFloor("both", "both"));
        const auto apart = reachOf(roomsOnOneFloor("first", "second"));
        const double rooms = 2.0 * (16.0 + 4.0 * 6.0) + 8.4 * 4.2; // walls and ceilings, and all of the floor's top
        // elements of the walls that the floor cuts count whole
        QVERIFY2(std::abs(apart->area() - rooms) < 4.0, qPrintable(QString::number(apart->area())));
        QVERIFY2(areAlike(*joint, *apart), qPrintable(QString("%1 m2 for %2").arg(joint->area()).arg(apart->area())));
    }

    /// The key of a sun's photons knows its own group alone.
    void photonsOfASunDoNotDependOnOtherSuns()
    {
        const auto hall = [](float others) {
            SceneBuilder builder("hall");
            const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
            builder.add("Floor", boxMesh({-5.0f, -0.1f, -5.0f}, {5.0f, 0.0f, 5.0f}), grey);
            builder.add("Roof/1", boxMesh({-5.0f, 4.0f, -5.0f}, {-0.5f, 4.1f, 5.0f}), grey);
            builder.add("Roof/2", boxMesh({0.5f, 4.0f, -5.0f}, {5.0f, 4.1f, 5.0f}), grey);
            builder.addDirectional("Sun", {0.1f, -1.0f, 0.0f}, glm::vec3(100.0f));
            for (int i = 0; i < 5; ++i) {
                builder.addDirectional("Other/" + std::to_string(i), {0.0f, -1.0f, 0.2f * static_cast<float>(i)},
                                       glm::vec3(others + static_cast<float>(i)));
            }
            return share(builder.finish());
        };
        const auto dim = hall(1.0f), strong = hall(1'000.0f);
        const int group = dim->lights[0].group;
        QVERIFY(lampHash(*dim, group) == lampHash(*strong, group));
        const LightSampler byDim(*RayScene::build(dim)), byStrong(*RayScene::build(strong));
        for (std::uint64_t i = 0; i < 200; ++i) {
            Rng one(1, 2, i), two(1, 2, i);
            EmittedPhoton a, b;
            QVERIFY(byDim.emit(group, one, a) && byStrong.emit(group, two, b));
            QVERIFY(a.position == b.position && a.travel == b.travel && a.flux == b.flux);
        }
    }

    void aRoughPictureKeepsTheOthersLayers()
    {
        const auto scene = closedRooms();
        BakeProducts products;
        OctreeSolver solver;
        BakeJob job{scene, quick(), {}};
        job.params.photonCount = 50'000;
        job.params.octreeDepth = 4;
        const Baked before = runSolver(solver, job, products);
        job.scene = moved(scene, 1, {0.4f, 0.0f, 0.0f});
        job.roughFirst = true;
        const Baked after = runSolver(solver, job, products);
        QCOMPARE(after.snapshots.size(), std::size_t(2));
        QVERIFY(after.snapshots[0].isRough && after.snapshots[1].isFinal);
        const auto rough = std::static_pointer_cast<const LightOctree>(after.snapshots[0].field);
        const auto group = static_cast<std::size_t>(scene->lights[1].group);
        for (std::size_t g = 0; g < rough->layers().size(); ++g) {
            QVERIFY(rough->layers()[g] != nullptr);
            QCOMPARE(rough->layers()[g] == before.octree()->layers()[g], g != group);
        }
        QCOMPARE(after.counters.photonsShot, std::uint64_t(50'000 + 10'000));
        // the same again: nothing is missing, so nothing rough is shown
        const Baked again = runSolver(solver, job, products);
        QCOMPARE(again.snapshots.size(), std::size_t(1));
        QCOMPARE(again.counters.photonsShot, std::uint64_t(0));
    }

    void whatADragLeavesDoesNotPileUp()
    {
        const auto scene = closedRooms();
        Workers workers(2);
        std::atomic<int> shown = 0;
        std::atomic<std::uint64_t> ended = 0; // serial of the newest bake that came to its end
        BakeSession session(workers, std::make_unique<OctreeSolver>(),
                            {[&](const Snapshot&) { ++shown; },
                             {},
                             [&](std::uint64_t serial, const Result<Done>&) { ended = serial; }});
        BakeJob job{scene, quick(), {}};
        job.params.photonCount = 50'000;
        job.roughFirst = true;
        std::uint64_t last = session.post(job);
        QTRY_COMPARE_WITH_TIMEOUT(ended.load(), last, 120'000);
        const std::size_t atRest = session.products().count();
        for (int step = 1; step <= 30; ++step) {
            job.scene = moved(scene, 1, {0.02f * static_cast<float>(step), 0.0f, 0.0f});
            const int before = shown;
            last = session.post(job);
            QTRY_VERIFY_WITH_TIMEOUT(
                shown > before, 60'000); // its rough picture; the rest is cut short by the next, unless it is quick
        }
        QTRY_COMPARE_WITH_TIMEOUT(ended.load(), last, 120'000);
        const WorkCounters did = session.counters();
        const auto others = static_cast<std::uint64_t>(scene->groups.size() - 1);
        QCOMPARE(did.photonsReused, others * 50'000); // bakes that were cut short dropped nothing
        QCOMPARE(did.groupsReused, others);
        // at most what three whole bakes have of the moved lamp, and two rough ones
        const std::size_t after = session.products().count();
        QVERIFY2(after <= atRest + 40, qPrintable(QString("%1 products, %2 at rest").arg(after).arg(atRest)));
    }

    void lampsTakenOverFromAnEarlierSceneShineAlike()
    {
        for (const auto& scene : {gallery_, share(atrium())}) {
            const std::size_t last = scene->lights.size() - 1;
            const auto rays = *RayScene::build(scene);
            const LightSampler earlier(rays);
            const auto edit = moved(scene, last, {0.2f, 0.1f, 0.0f});
            const auto shared = rays->withScene(edit);
            QCOMPARE(shared->embreeScene(), rays->embreeScene());
            const LightSampler taken(shared, &earlier), made(*RayScene::build(edit));
            QCOMPARE(taken.emitters().size(), made.emitters().size());
            for (int g = 0; g < static_cast<int>(scene->groups.size()); ++g) {
                QVERIFY(taken.groupFlux(g) == made.groupFlux(g));
                for (std::uint64_t i = 0; i < 200; ++i) {
                    Rng one(1, 2, i), two(1, 2, i);
                    EmittedPhoton a, b;
                    QCOMPARE(taken.emit(g, one, a), made.emit(g, two, b));
                    QVERIFY(a.position == b.position && a.travel == b.travel && a.flux == b.flux);
                }
            }
        }
    }
};

QTEST_GUILESS_MAIN(LampEditsTest)
#include "tst_lamp_edits.moc"
