// SPDX-License-Identifier: Apache-2.0
// Claims: voxel bakes are the same bits on any number of threads and come back from files; lamps are linear and kept: a
// lamp that was moved is lit anew alone, with the light it would get if all were; a rough picture comes first and
// changes nothing; a stopped bake says so; volumes hold what voxels do; extremes stay finite.
#include "bake_helpers.h"
#include "core/bake/bake_file.h"
#include "core/bake/gpu_layout.h"
#include "core/bake/vdb_file.h"
#include "core/bake/voxel_volume.h"
#include "core/base/units.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/voxel/voxel_solver.h"
#include "light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

BakeParams voxelParams(int cells, int directions)
{
    BakeParams p;
    p.voxelSize = cells;
    p.voxelDirections = directions;
    p.voxelSamples = 2;
    p.voxelRays = 8;
    return p;
}

Baked bakeVoxels(const std::shared_ptr<const Scene>& scene, const BakeParams& p, int threads = 2, Mix mix = {})
{
    VoxelSolver solver;
    BakeProducts products;
    return runSolver(solver, {scene, p, std::move(mix)}, products, threads);
}

const VoxelField& voxelsOf(const Baked& baked) { return dynamic_cast<const VoxelField&>(*baked.field); }

BakeInfo infoOf(const Scene& scene, const BakeParams& params)
{
    BakeInfo info;
    info.method = Method::voxelLightcuts;
    info.params = params;
    info.sceneHash = sceneHash(scene);
    for (const LightGroup& group : scene.groups) info.groups.push_back(group.id);
    return info;
}

bool isSame(const VoxelLayer& a, const VoxelLayer& b)
{
    const auto isSameLight = [](const Vdl& x, const Vdl& y) { return x.colour == y.colour && x.toLight == y.toLight; };
    return std::ranges::equal(a.indirect->vdls, b.indirect->vdls, isSameLight) && !a.indirect->vdls.empty() &&
           a.direct == b.direct && a.indirect->scalar == b.indirect->scalar && a.byRays == b.byRays &&
           a.specular == b.specular;
}

} // namespace

class VoxelFieldTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void filesGiveBackEveryBitOnAnyThreads()
    {
        const auto scene = share(*sampleScene("two_rooms"));
        const BakeParams p = voxelParams(20, 64);
        const Baked baked = bakeVoxels(scene, p, 1);
        QVERIFY2(baked.error.empty(), baked.error.c_str());
        const BakeInfo info = infoOf(*scene, p);
        const auto bytes = bakeBytes(*baked.field, info, *scene);
        QVERIFY2(static_cast<bool>(bytes), bytes ? "" : bytes.error().message.c_str());
        const auto again = bakeBytes(*bakeVoxels(scene, p, 5).field, info, *scene);
        QVERIFY(again && *again == *bytes);
        const Result<BakeFile> file = bakeFromBytes(*bytes, *scene);
        QVERIFY2(static_cast<bool>(file) && file->voxels, file ? "" : file.error().message.c_str());
        QCOMPARE(file->voxels->surface().cells, 20);
        QVERIFY(file->voxels->surface().albedo == voxelsOf(baked).surface().albedo);
        for (std::size_t g = 0; g < 2; ++g) QVERIFY(isSame(*file->voxels->layers()[g], *voxelsOf(baked).layers()[g]));
        for (const FacePoint& point : facePoints(*scene, 500, 2)) {
            glm::vec3 x, y;
            QCOMPARE(file->voxels->lookup(point.position, point.normal, x),
                     baked.field->lookup(point.position, point.normal, y));
            QVERIFY(x == y);
        }
    }

    void mirrorsPassLampsLightOn()
    {
        SceneBuilder builder("mirror");
        builder.add("Room", boxMesh({-1, 0, -1}, {1, 2, 1}, Facing::in), builder.addMaterial("grey", glm::vec3(0.5f)));
        builder.add("Mirror", quadMesh({-0.9f, 0.01f, -0.9f}, {0, 0, 1.8f}, {1.8f, 0, 0}),
                    builder.addMetal("mirror", glm::vec3(0.9f), 0.0f));
        builder.addPoint("Lamp", {0.2f, 1, 0}, glm::vec3(100.0f));
        const auto scene = share(builder.finish());
        BakeParams p = voxelParams(20, 256);
        p.voxelPhotons = 200'000;
        const Baked with = bakeVoxels(scene, p), again = bakeVoxels(scene, p, 5);
        p.voxelPhotons = 0;
        const Baked without = bakeVoxels(scene, p);
        QVERIFY(with.counters.causticPhotons > 10'000);
        QCOMPARE(without.counters.causticPhotons, std::uint64_t{0});
        QVERIFY(voxelsOf(without).layers()[0]->specular.empty());
        QVERIFY(isSame(*voxelsOf(with).layers()[0], *voxelsOf(again).layers()[0]));
        // either way no lumen is made or lost but by Schlick's share: what the mirror sends arrives somewhere
        double sums[2] = {}, ceilings[2] = {};
        for (const bool hasPhotons : {false, true}) {
            const VoxelField& field = voxelsOf(hasPhotons ? with : without);
            for (std::size_t e = 0; e < field.surface().leaves->entries.size(); ++e) {
                const OctreeEntry& entry = field.surface().leaves->entries[e];
                // what rays brought is of the whole entry, the field's light of its open part: floor under the mirror
                // has none
                const glm::vec3 lux = field.direct(e) + field.mixed(&VoxelLayer::byRays, e);
                const auto lumen = static_cast<double>(entry.area * luminance(lux));
                sums[hasPhotons] += lumen;
                if (entry.normal.y < -0.9f && glm::length(entry.centroid - glm::vec3(0.2f, 2.0f, 0.0f)) < 0.3f)
                    ceilings[hasPhotons] += lumen;
            }
        }
        qInfo("all light %.3f, above the lamp %.3f of what an even floor makes", sums[1] / sums[0],
              ceilings[1] / ceilings[0]);
        QVERIFY(std::abs(sums[1] / sums[0] - 1.0) <= 0.05);
        p.voxelPhotons = 200'000;
        const auto bytes = bakeBytes(*with.field, infoOf(*scene, p), *scene);
        QVERIFY(static_cast<bool>(bytes));
        const Result<BakeFile> file = bakeFromBytes(*bytes, *scene);
        QVERIFY(static_cast<bool>(file) && file->voxels);
        QVERIFY(file->voxels->surface().matt == voxelsOf(with).surface().matt);
        QVERIFY(isSame(*file->voxels->layers()[0], *voxelsOf(with).layers()[0]));
    }

    void anEditedSceneIsAsIfNew() // voxels are made from those of the scene before; the light is the same to the bit
    {
        const auto room = [](float x) {
            SceneBuilder builder("edited");
            const int grey = builder.addMaterial("grey", glm::vec3(0.5f));
            builder.add("Room", boxMesh({-1, 0, -1}, {1, 2, 1}, Facing::in), grey);
            builder.add("Block", boxMesh({x, 0.1f, -0.2f}, {x + 0.4f, 0.5f, 0.2f}, Facing::out), grey);
            builder.addPoint("Lamp", {0.2f, 1.5f, 0}, glm::vec3(100.0f));
            return share(builder.finish());
        };
        VoxelSolver solver;
        BakeProducts products;
        const BakeParams p = voxelParams(20, 64);
        const Baked before = runSolver(solver, {room(-0.5f), p, {}}, products),
                    edited = runSolver(solver, {room(0.3f), p, {}}, products), fresh = bakeVoxels(room(0.3f), p);
        QVERIFY(voxelsOf(edited).surface().leaves->cells == voxelsOf(fresh).surface().leaves->cells);
        QVERIFY(voxelsOf(edited).surface().leaves->cells != voxelsOf(before).surface().leaves->cells);
        QVERIFY(isSame(*voxelsOf(edited).layers()[0], *voxelsOf(fresh).layers()[0]));
    }

    void bouncesInTurnWantTheirPartners()
    {
        const auto scene = share(*sampleScene("cornell"));
        BakeParams p = voxelParams(20, 256);
        const Baked halving = bakeVoxels(scene, p);
        p.voxelBounces = VoxelBounces::gaussSeidel;
        const Baked inTurn = bakeVoxels(scene, p);
        QVERIFY2(inTurn.error.empty(), inTurn.error.c_str());
        QVERIFY(inTurn.counters.bounces < halving.counters.bounces);
        double squares = 0.0, mean = 0.0;
        const std::vector<glm::vec3>& a = voxelsOf(halving).layers()[0]->indirect->scalar;
        for (std::size_t e = 0; e < a.size(); ++e) {
            const double v = static_cast<double>(luminance(a[e]));
            squares +=
                std::pow(static_cast<double>(luminance(voxelsOf(inTurn).layers()[0]->indirect->scalar[e])) - v, 2.0);
            mean += v;
        }
        const auto count = static_cast<double>(a.size());
        qInfo("differ by %.4f of the mean", std::sqrt(squares / count) / (mean / count));
        QVERIFY(std::sqrt(squares / count) <= 0.03 * mean / count);
        p.voxelPartnerMemory = 0;
        const Baked refused = bakeVoxels(scene, p);
        QVERIFY2(refused.error.find("voxel.partners=0") != std::string::npos, refused.error.c_str());
    }

    void lampsAddUp()
    {
        const auto scene = share(*sampleScene("two_rooms"));
        const Baked both = bakeVoxels(scene, voxelParams(16, 64));
        const Baked one = bakeVoxels(scene, voxelParams(16, 64), 2, {glm::vec3(1.0f), glm::vec3(0.0f)});
        QCOMPARE(one.counters.groupsOff, std::uint64_t{1});
        QVERIFY(!voxelsOf(one).layers()[1] && isSame(*voxelsOf(one).layers()[0], *voxelsOf(both).layers()[0]));
        const Baked other = bakeVoxels(scene, voxelParams(16, 64), 2, {glm::vec3(0.0f), glm::vec3(1.0f)});
        const auto tinted = both.field->withMix({glm::vec3(2.0f, 0.0f, 1.0f), glm::vec3(0.0f, 0.5f, 1.0f)});
        int asked = 0;
        for (const FacePoint& point : facePoints(*scene, 300, 1)) {
            glm::vec3 a, b, c;
            if (!one.field->lookup(point.position, point.normal, a)) continue;
            QVERIFY(other.field->lookup(point.position, point.normal, b));
            QVERIFY(tinted->lookup(point.position, point.normal, c));
            ++asked;
            const glm::vec3 wanted(2.0f * a.x, 0.5f * b.y, a.z + b.z);
            QVERIFY(glm::all(glm::lessThanEqual(glm::abs(wanted - c), glm::vec3(1e-5f * maxChannel(a + b)))));
        }
        QVERIFY(asked > 250);
        const VoxelField& mixed = dynamic_cast<const VoxelField&>(*tinted);
        const VoxelLayer &first = *mixed.layers()[0], &second = *mixed.layers()[1];
        for (std::size_t e = 0; e < first.direct.size(); e += 17) {
            // as lights entries send what came along rays
            const glm::vec3 lux = glm::vec3(2.0f, 0.0f, 1.0f) * (first.direct[e] + first.byRays[e]) +
                                  glm::vec3(0.0f, 0.5f, 1.0f) * (second.direct[e] + second.byRays[e]);
            const glm::vec3 sent = mixed.surface().albedo[e] * lux;
            QVERIFY(glm::length(mixed.exitance(e) - sent) <= 1e-5f * glm::length(sent));
        }
    }

    void aMovedLampIsLitAloneAndAsIfAllWere()
    {
        Scene moved = *sampleScene("two_rooms");
        const auto before = share(moved);
        std::size_t lamp = 0;
        while (lamp < moved.lights.size() && moved.lights[lamp].group != 1) ++lamp;
        QVERIFY(lamp < moved.lights.size());
        moved.lights[lamp].position.x += 0.3f;
        const auto after = share(std::move(moved));
        const BakeParams p = voxelParams(16, 64);
        VoxelSolver solver;
        BakeProducts products;
        const Baked first = runSolver(solver, {before, p, {}}, products);
        const Baked second = runSolver(solver, {after, p, {}}, products);
        QCOMPARE(second.counters.groupsReused, std::uint64_t{1});
        QVERIFY(voxelsOf(second).layers()[0] == voxelsOf(first).layers()[0]);
        QVERIFY(!isSame(*voxelsOf(second).layers()[1], *voxelsOf(first).layers()[1]));
        const Baked whole = bakeVoxels(after, p);
        for (std::size_t g = 0; g < 2; ++g)
            QVERIFY(isSame(*voxelsOf(second).layers()[g], *voxelsOf(whole).layers()[g]));
        for (const StageCost& stage : second.counters.stages)
            QVERIFY2(stage.stage != "voxels" || stage.isKept, "voxels were made anew");
    }

    void aRoughPictureComesFirst()
    {
        const auto scene = share(*sampleScene("cornell"));
        const BakeParams p = voxelParams(32, 128);
        BakeJob job{scene, p, {}};
        job.roughFirst = true;
        VoxelSolver solver;
        BakeProducts products;
        const Baked shown = runSolver(solver, job, products);
        QCOMPARE(shown.snapshots.size(), std::size_t{2});
        QVERIFY(shown.snapshots[0].isRough && !shown.snapshots[0].isFinal && shown.snapshots[0].level == 24);
        QVERIFY(!shown.snapshots[1].isRough && shown.snapshots[1].isFinal && shown.snapshots[1].level == 32);
        BakeParams walking = p; // lines anew each bounce
        walking.voxelPartnerMemory = 0;
        const Baked alone = bakeVoxels(scene, walking);
        QVERIFY(isSame(*voxelsOf(shown).layers()[0], *voxelsOf(alone).layers()[0]));
        QCOMPARE(shown.counters.entries, alone.counters.entries);
        QVERIFY(alone.counters.bounces > 3 && shown.counters.bounces == alone.counters.bounces);
    }

    void noRoughPictureWhereTheFieldIsThereAsSoon() // a lamp is moved, and all else is kept
    {
        Scene moved = *sampleScene("two_rooms");
        BakeJob job{share(moved), voxelParams(32, 128), {}};
        job.roughFirst = true;
        VoxelSolver solver;
        BakeProducts products;
        QCOMPARE(runSolver(solver, job, products).snapshots.size(), std::size_t{2});
        moved.lights.front().position.x += 0.2f;
        job.scene = share(std::move(moved));
        const Baked second = runSolver(solver, job, products);
        QCOMPARE(second.snapshots.size(), std::size_t{1});
        QVERIFY(second.snapshots[0].isFinal && !second.snapshots[0].isRough && second.snapshots[0].level == 32);
        const Baked whole = bakeVoxels(job.scene, job.params);
        for (std::size_t g = 0; g < job.scene->groups.size(); ++g)
            QVERIFY(isSame(*voxelsOf(second).layers()[g], *voxelsOf(whole).layers()[g]));
        job.params.voxelDirections = 256; // other partners
        QCOMPARE(runSolver(solver, job, products).snapshots.size(), std::size_t{2});
    }

    void aStoppedBakeSaysSo()
    {
        const auto scene = share(*sampleScene("cornell"));
        Workers workers(2);
        std::stop_source source;
        int published = 0;
        BakeControl control(workers,
                            {[&](const Snapshot&) { ++published; },
                             [&](const Progress& p) {
                                 if (p.fraction > 0.05) source.request_stop();
                             }},
                            source.get_token());
        BakeProducts products;
        products.beginRound();
        const Result<Done> done = VoxelSolver().bake({scene, voxelParams(48, 256), {}}, products, control);
        QVERIFY(!done && done.error().kind == Error::Kind::cancelled);
        QCOMPARE(published, 0);
    }

    void volumesHoldWhatVoxelsDo()
    {
        const auto scene = share(*sampleScene("cornell"));
        const BakeParams p = voxelParams(16, 64);
        const Baked baked = bakeVoxels(scene, p);
        const VoxelField& field = voxelsOf(baked);
        const auto bytes = voxelVolume(field, infoOf(*scene, p), *scene);
        QVERIFY2(static_cast<bool>(bytes), bytes ? "" : bytes.error().message.c_str());
        const VdbFile file(std::string(bytes->begin(), bytes->end()));
        QVERIFY(file.text("lightloom.method") == "voxel-lightcuts" && file.text("lightloom.unit") == "lux");
        const std::vector<glm::ivec3> cells = file.cells("irradiance");
        QCOMPARE(cells.size(), field.surface().leaves->cells.size());
        const auto areas = file.numbers("area", cells);
        const auto sent = file.vectors("radiosity", cells);
        glm::dvec3 lumen(0.0), wanted(0.0);
        for (std::size_t i = 0; i < cells.size(); ++i) lumen += double(areas[i]) * glm::dvec3(sent[i]);
        for (std::size_t e = 0; e < field.surface().leaves->entries.size(); ++e)
            wanted += double(field.surface().leaves->entries[e].area) * glm::dvec3(field.exitance(e));
        QVERIFY(wanted.x > 0.0 && glm::length(lumen - wanted) <= 1e-5 * glm::length(wanted));
    }

    void extremesStayFinite()
    {
        const auto cornell = share(*sampleScene("cornell"));
        for (const int cells : {4, 5, 33}) {
            const Baked baked = bakeVoxels(cornell, voxelParams(cells, 1));
            QVERIFY2(baked.error.empty(), baked.error.c_str());
            QVERIFY(makeGpuOctree(voxelsOf(baked).octree()));
            for (const FacePoint& point : facePoints(*cornell, 200, 1)) {
                const glm::vec3 lux = baked.field->irradiance(point.position, point.normal);
                QVERIFY(isFinite(lux) && glm::all(glm::greaterThanEqual(lux, glm::vec3(0.0f))));
            }
        }
        SceneBuilder dark("dark"); // no lamp at all; flat
        dark.add("Sheet", quadMesh({0, 0, 0}, {0, 0, 1}, {2, 0, 0}), dark.addMaterial("grey", glm::vec3(0.5f)));
        const Baked none = bakeVoxels(share(dark.finish()), voxelParams(8, 16));
        QVERIFY2(none.error.empty(), none.error.c_str());
        QVERIFY(none.field->irradiance({0.5f, 0.0f, 0.5f}, {0, 1, 0}) == glm::vec3(0.0f));
        glm::vec3 lux;
        QVERIFY(!none.field->lookup({100.0f, 0.0f, 0.0f}, {0, 1, 0}, lux));
    }
};

QTEST_APPLESS_MAIN(VoxelFieldTest)
#include "tst_voxel_field.moc"
