// SPDX-License-Identifier: Apache-2.0
// Claims: a sheet that hangs 3 mm off a wall has the light of the wall it covers. Not yet kept: the caches take both
// surfaces for one, which halves the sheet's light and lights the wall behind it.
#include "bake_helpers.h"
#include "core/base/units.h"
#include "core/photonmap/photon_map_solver.h"
#include "core/scene/scene_builder.h"
#include <QTest>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// 4 x 3 x 4 m with a lamp; a grey sheet may hang before the wall at z = 0.
std::shared_ptr<const Scene> room(bool hasSheet)
{
    SceneBuilder builder("room with a sheet");
    const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
    builder.add("Room", boxMesh({0.0f, 0.0f, 0.0f}, {4.0f, 3.0f, 4.0f}, Facing::in), grey);
    if (hasSheet) builder.add("Sheet", quadMesh({1.4f, 0.9f, 0.003f}, {1.2f, 0, 0}, {0, 1.2f, 0}), grey);
    builder.addPoint("Lamp", {2.0f, 2.0f, 2.5f}, glm::vec3(100.0f));
    return share(builder.finish());
}

/// Mean indirect luminance over 11 x 11 points at `z` that face the room, a third of a metre around the sheet's middle.
double meanLux(const IndirectField& field, const Scene& scene, double z)
{
    const glm::dvec3 shift = scene.toFile(glm::vec3(0.0f));
    double sum = 0.0;
    for (int i = 0; i < 121; ++i) {
        const glm::dvec3 p(1.7 + 0.06 * (i % 11), 1.2 + 0.06 * (i / 11), z);
        sum += static_cast<double>(luminance(field.irradiance(glm::vec3(p - shift), {0.0f, 0.0f, 1.0f})));
    }
    return sum / 121.0;
}

} // namespace

class ThinGapsTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void aSheetHasTheLightOfItsWall_data()
    {
        QTest::addColumn<bool>("isOctree");
        QTest::newRow("light-octree") << true;
        QTest::newRow("photon-map") << false;
    }
    void aSheetHasTheLightOfItsWall()
    {
        QFETCH(bool, isOctree);
        BakeParams params;
        params.photonCount = 200'000;
        const auto baked = [&](const std::shared_ptr<const Scene>& scene) {
            BakeProducts products;
            OctreeSolver octree;
            PhotonMapSolver photonMap;
            Solver& solver = isOctree ? static_cast<Solver&>(octree) : photonMap;
            return runSolver(solver, {scene, params, {}}, products).field;
        };
        const auto bare = room(false), hung = room(true);
        const auto without = baked(bare), with = baked(hung);
        QVERIFY(without && with);
        const double wall = meanLux(*without, *bare, 0.0), sheet = meanLux(*with, *hung, 0.003),
                     behind = meanLux(*with, *hung, 0.0);
        qInfo("wall %.2f, sheet %.2f, behind it %.2f lx", wall, sheet, behind);
        QEXPECT_FAIL("", "entries and kernels part surfaces by their normals only", Continue);
        QVERIFY2(std::abs(sheet - wall) <= 0.1 * wall, qPrintable(QString("%1 of %2 lx").arg(sheet).arg(wall)));
        QEXPECT_FAIL("", "the same", Continue);
        QVERIFY2(behind <= 0.1 * wall, qPrintable(QString("%1 of %2 lx").arg(behind).arg(wall)));
    }
};

QTEST_APPLESS_MAIN(ThinGapsTest)
#include "tst_thin_gaps.moc"
