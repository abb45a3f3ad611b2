// SPDX-License-Identifier: Apache-2.0
// Claims: what a bake of voxels says of the scene is so: a gap narrower than two voxels is found, with its width and
// its share of the surface, a wider one is not; a lamp that lights a small patch is named, with as many emitters as it
// lights, one that lights all around is not.
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
        return voxelAdvice(*at.rays, samplePoints(*at.rays, *at.lights, *at.reach, 4000, 1), field,
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
