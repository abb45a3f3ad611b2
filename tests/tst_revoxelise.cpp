// SPDX-License-Identifier: Apache-2.0
// Claims: voxels of an edited scene, made from those of the scene before, are to the bit those made anew: with an
// object added, moved, turned or taken away, a door shut before the light, and another bound; and what was not touched
// is not cut up again.
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/transport/surface_voxels.h"
#include "light_helpers.h"
#include <QtTest>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

using namespace lightloom;
using namespace lightloom::test;

namespace {

enum class Block { none, there, elsewhere, turned, far };

/// Two rooms with a door between them, a block in the lit one, a fine ball beyond it in the scene's order.
Scene room(Block block, bool isShut = false)
{
    SceneBuilder builder("edited");
    const int white = builder.addMaterial("white", glm::vec3(0.6f));
    builder.add("Room", boxMesh({0.0f, 0.0f, 0.0f}, {4.0f, 2.0f, 2.0f}, Facing::in), white);
    builder.add("Wall", boxMesh({2.0f, -0.1f, -0.1f}, {2.1f, 2.1f, 1.2f}, Facing::out), white);
    const auto place = [&](glm::vec3 p, float turn) {
        const int cube = builder.addMesh(boxMesh({-0.2f, -0.2f, -0.2f}, {0.2f, 0.2f, 0.2f}, Facing::out), white);
        const glm::mat4 there = glm::translate(glm::mat4(1.0f), p);
        builder.place("Block", cube, glm::rotate(there, turn, glm::vec3(0.3f, 1.0f, 0.0f)));
    };
    if (block == Block::there) place({0.7f, 0.2f, 0.7f}, 0.0f);
    if (block == Block::elsewhere) place({1.2f, 0.5f, 0.8f}, 0.0f);
    if (block == Block::turned) place({0.7f, 0.2f, 0.7f}, 0.4f);
    if (block == Block::far) place({6.0f, 0.5f, 0.8f}, 0.0f);
    if (isShut) builder.add("Door", boxMesh({2.0f, -0.1f, 1.1f}, {2.05f, 2.1f, 2.0f}, Facing::out), white);
    builder.add("Ball", sphereMesh({1.3f, 1.4f, 1.4f}, 0.3f, 24), white);
    builder.addPoint("Lamp", {1.0f, 1.7f, 1.0f}, glm::vec3(1.0f));
    return builder.finish();
}

struct Made {
    std::shared_ptr<const RayScene> rays;
    std::shared_ptr<const LightReach> reach;
    std::shared_ptr<const SurfaceVoxels> voxels;
    Bounds bounds;
    Made(const Scene& scene, int cells, float shift) : bounds(scene.bounds)
    {
        Workers workers(2);
        rays = *RayScene::build(std::make_shared<const Scene>(scene));
        reach = LightReach::find(*rays, LightSampler(rays), workers, {});
        voxels = voxelise(bounds, *reach, cells, shift, workers, {});
    }
};

template<class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b)
{
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}
bool samePieces(const std::vector<CellPiece>& a, const std::vector<CellPiece>& b)
{
    return std::ranges::equal(a, b, [](const CellPiece& x, const CellPiece& y) {
        return x.cell == y.cell && x.facet == y.facet && x.area == y.area && x.centroid == y.centroid;
    });
}

} // namespace

class RevoxeliseTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void asIfMadeAnew_data()
    {
        QTest::addColumn<Block>("from");
        QTest::addColumn<Block>("to");
        QTest::addColumn<bool>("shuts");
        QTest::addColumn<bool>("isLocal"); // only a part of the surface is another
        QTest::newRow("added") << Block::none << Block::there << false << true;
        QTest::newRow("taken away") << Block::there << Block::none << false << true;
        QTest::newRow("moved") << Block::there << Block::elsewhere << false << true;
        QTest::newRow("turned") << Block::there << Block::turned << false << true;
        QTest::newRow("the same") << Block::there << Block::there << false << true;
        QTest::newRow("a door shut") << Block::there << Block::there << true << true;
        QTest::newRow("another bound") << Block::there << Block::far << false << false;
    }
    void asIfMadeAnew()
    {
        QFETCH(Block, from);
        QFETCH(Block, to);
        QFETCH(bool, shuts);
        QFETCH(bool, isLocal);
        constexpr int kCells = 48;
        constexpr float kShift = 0.25f;
        const Made before(room(from), kCells, kShift), after(room(to, shuts), kCells, kShift);
        for (const int threads : {1, 3}) {
            Workers workers(threads);
            std::size_t clipped = 0;
            const auto made = revoxelise(*before.voxels, *before.reach, after.bounds, *after.reach, kCells, kShift,
                                         workers, {}, &clipped);
            qInfo("%zu of %zu facets cut up, %zu voxels", clipped, after.reach->facets().size(), made->voxels.size());
            QVERIFY(made->voxels == after.voxels->voxels);
            QVERIFY(made->firstEntry == after.voxels->firstEntry);
            QVERIFY(made->firstPiece == after.voxels->firstPiece);
            QVERIFY(sameBytes(made->entries, after.voxels->entries));
            QVERIFY(samePieces(made->pieces, after.voxels->pieces));
            QCOMPARE(made->lattice.lowest, after.voxels->lattice.lowest);
            if (isLocal)
                QVERIFY(clipped * 4 < after.reach->facets().size() * 3);
            else
                QCOMPARE(clipped, after.reach->facets().size());
            if (from == to && !shuts) QCOMPARE(clipped, std::size_t(0));
        }
    }

    void stopsWhenAsked()
    {
        const Made before(room(Block::none), 24, 0.0f), after(room(Block::there), 24, 0.0f);
        std::stop_source source;
        source.request_stop();
        Workers workers(2);
        QVERIFY(!revoxelise(*before.voxels, *before.reach, after.bounds, *after.reach, 24, 0.0f, workers,
                            source.get_token()));
    }
};

QTEST_APPLESS_MAIN(RevoxeliseTest)
#include "tst_revoxelise.moc"
