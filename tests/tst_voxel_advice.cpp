// SPDX-License-Identifier: Apache-2.0
// Claims: what a bake of voxels says of the scene is so: a gap narrower than two voxels is found, with its width and
// its share of the surface, a wider one is not; so is a wall thinner than a voxel between a bright and a dark room, a
// sheet too, but not what is as bright behind; a lamp that lights a small patch is named, with as many emitters as it
// lights, one that lights all around is not, several share a line.
#include "bake_helpers.h"
#include "core/base/units.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/scene_builder.h"
#include "core/voxel/voxel_advice.h"
#include "core/voxel/voxel_solver.h"
#include "light_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// 2 m a side; a board of 1.2 m stands `gap` before the wall at z = -1. A spot of `outer` half angle, or a lamp all
/// around.
std::shared_ptr<const Scene> room(float gap, std::optional<float> outer = {})
{
    SceneBuilder builder("room");
    const int white = builder.addMaterial("white", glm::vec3(0.5f));
    builder.add("Box", boxMesh(glm::vec3(-1.0f), glm::vec3(1.0f), Facing::in), white);
    builder.add("Board", boxMesh({-0.6f, -0.6f, -1.0f + gap}, {0.6f, 0.6f, -0.9f + gap}, Facing::out), white);
    if (outer) {
        builder.addSpot("Lamp", {0, 0.9f, 0}, {0, -1.0f, 0}, glm::vec3(1000.0f), 0.9f * *outer, *outer);
    } else {
        builder.addPoint("Lamp", {0.1f, 0.5f, 0.3f}, glm::vec3(100.0f));
    }
    return share(builder.finish());
}

/// The same room, parted at x = 0 by a wall `thickness` thick (0: a sheet) that leaves `door` open, and lit on the
/// left.
std::shared_ptr<const Scene> parted(float thickness, float door)
{
    SceneBuilder builder("parted");
    const int white = builder.addMaterial("white", glm::vec3(0.5f));
    builder.add("Box", boxMesh(glm::vec3(-1.0f), glm::vec3(1.0f), Facing::in), white);
    if (thickness > 0.0f) {
        builder.add("Wall", boxMesh({0.0f, -1.0f, -1.0f}, {thickness, 1.0f, 1.0f - door}, Facing::out), white);
    } else {
        builder.add("Wall", quadMesh({0.0f, -1.0f, -1.0f}, {0.0f, 2.0f, 0.0f}, {0.0f, 0.0f, 2.0f - door}), white);
    }
    builder.addPoint("Lamp", {-0.5f, 0.1f, -0.4f}, glm::vec3(100.0f));
    return share(builder.finish());
}

} // namespace

class VoxelAdviceTest : public QObject {
    Q_OBJECT

    static VoxelAdvice adviceOn(const std::shared_ptr<const Scene>& scene)
    {
        BakeParams params;
        params.voxelSize = 32; // .0626 m
        params.voxelDirections = 128;
        params.voxelRays = 0;
        VoxelSolver solver;
        BakeProducts products;
        const BakeJob job{scene, params, {}};
        const Baked baked = runSolver(solver, job, products);
        [&] { QVERIFY2(baked.error.empty(), baked.error.c_str()); }();
        Workers workers(2);
        BakeControl quiet(workers, {});
        const SceneProducts at = *sceneProducts(job, products, quiet);
        const auto& field = dynamic_cast<const VoxelField&>(*baked.field);
        return voxelAdvice(*at.rays, *at.reach, samplePoints(*at.rays, *at.lights, *at.reach, 4000, 1), field,
                           params.voxelDirections);
    }

private Q_SLOTS:
    void narrowGapsAreFound_data()
    {
        QTest::addColumn<double>("gap");
        QTest::addColumn<bool>("isNarrow");
        QTest::newRow("a voxel") << 0.06 << true;
        QTest::newRow("three voxels") << 0.19 << false;
    }
    void narrowGapsAreFound()
    {
        QFETCH(double, gap);
        QFETCH(bool, isNarrow);
        const auto scene = room(float(gap));
        const VoxelAdvice advice = adviceOn(scene);
        const std::vector<std::string> lines = adviceLines(advice, *scene);
        QCOMPARE(lines.size(), std::size_t(isNarrow ? 1 : 0));
        QVERIFY(advice.gap.has_value() == isNarrow);
        if (!isNarrow) return;
        // board's back and the wall behind it, of all: 6 walls and the board
        const double side = 1.2 * 1.2, truth = 2.0 * side / (24.0 + 2.0 * side + 4.0 * 1.2 * 0.1);
        qInfo("%.3f of the surface in gaps, %.3f in truth; %s", advice.inGaps, truth, lines[0].c_str());
        QVERIFY(std::abs(advice.inGaps - truth) <= 4.9 * std::sqrt(truth / 4000.0));
        QVERIFY(std::abs(double(advice.gap->width) - gap) <= 1e-4);
        QVERIFY(QString::fromStdString(lines[0]).contains("voxel.size"));
    }

    void thinWallsBeforeTheDarkAreFound_data()
    {
        QTest::addColumn<double>("thickness");
        QTest::addColumn<double>("door");
        QTest::addColumn<bool>("isThin");
        QTest::addColumn<bool>("isDark");
        QTest::newRow("half a voxel") << 0.03 << 0.15 << true << true;
        QTest::newRow("a sheet") << 0.0 << 0.15 << true << true;
        QTest::newRow("two voxels") << 0.13 << 0.15 << false << false;
        QTest::newRow("half a voxel, bright behind") << 0.03 << 1.6 << true << false;
    }
    void thinWallsBeforeTheDarkAreFound()
    {
        QFETCH(double, thickness);
        QFETCH(double, door);
        QFETCH(bool, isThin);
        QFETCH(bool, isDark);
        const auto scene = parted(float(thickness), float(door));
        const VoxelAdvice advice = adviceOn(scene);
        const std::vector<std::string> lines = adviceLines(advice, *scene);
        QCOMPARE(lines.size(), std::size_t(isDark ? 1 : 0));
        QCOMPARE(advice.thin.has_value(), isDark);
        // both sides of the wall; of all: 6 walls less what it stands on, it, and its end
        const double side = 2.0 * (2.0 - door), foot = thickness * (2.0 * (2.0 - door) + 2.0);
        const double truth = isThin ? 2.0 * side / (24.0 - foot + 2.0 * side + 2.0 * thickness) : 0.0;
        qInfo("%.3f of the surface on thin things, %.3f in truth, %.3f before the dark; %s", advice.onThin, truth,
              advice.onThinBeforeDark, isDark ? lines[0].c_str() : "no line");
        QVERIFY(std::abs(advice.onThin - truth) <= 4.9 * std::sqrt(truth / 4000.0));
        if (!isDark) return;
        QVERIFY(advice.onThinBeforeDark > 0.7 * truth && advice.onThinBeforeDark <= advice.onThin);
        QVERIFY(std::abs(double(advice.thin->width) - thickness) <= 1e-4);
        QVERIFY(QString::fromStdString(lines[0]).contains("walls, boards or columns"));
    }

    void lampsOfSmallPatchesShareALine()
    {
        VoxelAdvice advice;
        for (int group = 0; group < 2; ++group) advice.lamps.push_back({group, 60.0 + 20.0 * group, true});
        Scene scene = *room(0.19f);
        scene.groups.resize(2);
        scene.groups[0].label = "Left", scene.groups[1].label = "Right";
        const auto lines = adviceLines(advice, scene);
        QCOMPARE(lines.size(), std::size_t(1));
        QVERIFY2(lines[0].starts_with("Left and Right light small patches, equal to 60 to 80"), lines[0].c_str());
        scene.groups.push_back(scene.groups[0]);
        advice.lamps.push_back({2, 70.0, true});
        QVERIFY(
            QString::fromStdString(adviceLines(advice, scene)[0]).startsWith("Left, Right and one more lamp light"));
    }

    void smallBrightPatchesAreNamed()
    {
        const float outer = 0.12f;
        const auto scene = room(0.19f, outer);
        const VoxelAdvice advice = adviceOn(scene);
        QCOMPARE(advice.lamps.size(), std::size_t(1));
        // even light within nine tenths of the cone, falling off to its edge: about that part of the floor, in voxels
        const double radius = 1.9 * std::tan(0.95 * double(outer));
        const double truth = kPiD * radius * radius / double(advice.cellSize * advice.cellSize);
        qInfo("%.1f emitters, about %.1f in truth", advice.lamps[0].emitters, truth);
        QVERIFY(std::abs(advice.lamps[0].emitters / truth - 1.0) <= 0.25 && advice.lamps[0].isConnected);
        const std::vector<std::string> lines = adviceLines(advice, *scene);
        QVERIFY(lines.size() == 1 && QString::fromStdString(lines[0]).startsWith("Lamp lights a small patch"));
        const auto wide = room(0.19f);
        const VoxelAdvice other = adviceOn(wide);
        QVERIFY(!other.lamps[0].isConnected && other.lamps[0].emitters > 500.0);
        QVERIFY(adviceLines(other, *wide).empty());
    }
};

QTEST_APPLESS_MAIN(VoxelAdviceTest)
#include "tst_voxel_advice.moc"
