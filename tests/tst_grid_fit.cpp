// SPDX-License-Identifier: Apache-2.0
// Claims: patches make up the surface that light reaches, without what lies under something that stands on it; what
// photons leave on them is the light that is there; a grid that is fitted to them is nearer to a reference, keeps an
// even furnace even, and gives each lamp what it gives alone.
#include "bake_helpers.h"
#include "core/base/units.h"
#include "core/ivg/grid_surface.h"
#include "core/ivg/ivg_solver.h"
#include "core/photonmap/photon_products.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/trace/reference.h"
#include "grid_helpers.h"
#include "light_helpers.h"
#include <QtTest>

using namespace lightloom;
using namespace lightloom::test;

namespace {

/// A scene with a lattice and the patches of its surface.
struct Patched {
    std::shared_ptr<const Scene> scene;
    Workers workers{2};
    BakeProducts products;
    BakeControl control{workers, {}};
    SceneProducts at;
    GridLattice lattice;
    std::shared_ptr<const GridSurface> surface;

    Patched(std::shared_ptr<const Scene> given, GridSize size, float shift) : scene(std::move(given))
    {
        at = *sceneProducts({scene, {}, {}}, products, control);
        lattice = placeGrid(*at.rays, size, shift);
        surface = GridSurface::build(at.rays, *at.reach, lattice, workers, {});
    }
    [[nodiscard]] double area() const
    {
        double sum = 0.0;
        for (const SurfacePatch& patch : surface->patches()) sum += double(patch.area);
        return sum;
    }
};

/// A block half a metre high, of a square metre, on the floor of a room of 4 x 2 x 3 m.
Scene blockInRoom()
{
    SceneBuilder builder("block");
    const int grey = builder.addMaterial("grey", glm::vec3(0.6f));
    builder.add("Room", boxMesh({0.0f, 0.0f, 0.0f}, {4.0f, 2.0f, 3.0f}, Facing::in), grey);
    builder.add("Block", boxMesh({1.1f, -0.01f, 0.9f}, {2.1f, 0.5f, 1.9f}), grey);
    builder.addPoint("Lamp", {3.1f, 1.4f, 2.0f}, glm::vec3(50.0f));
    return builder.finish();
}

double errorAgainst(const IndirectField& field, const std::vector<ProbePoint>& points,
                    const std::vector<ProbeLight>& reference)
{
    double square = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double is = double(luminance(reference[i].indirect));
        const double off = double(luminance(field.irradiance(points[i].position, points[i].normal))) - is;
        square += off * off, mean += is;
    }
    const auto n = double(points.size());
    return std::sqrt(square / n) / (mean / n);
}

} // namespace

class GridFitTest : public QObject {
    Q_OBJECT
private Q_SLOTS:
    void patchesMakeUpTheSurface_data()
    {
        QTest::addColumn<double>("shift");
        QTest::addColumn<int>("along");
        for (const double shift : {0.0, 0.25, 0.5, 0.75}) QTest::addRow("shift %g", shift) << shift << 0;
        QTest::newRow("cells that are no cubes") << 0.25 << 9;
    }
    void patchesMakeUpTheSurface()
    {
        QFETCH(double, shift);
        QFETCH(int, along);
        const Patched box(share(furnaceBox(0.5f, 1.0f, {2.0f, 1.7f, 2.3f})), {12, {along, 0, 0}}, float(shift));
        const double walls = 2.0 * (2.0 * 1.7 + 1.7 * 2.3 + 2.3 * 2.0);
        QVERIFY2(std::abs(box.area() / walls - 1.0) <= 1e-4, qPrintable(QString::number(box.area())));
        for (const SurfacePatch& patch : box.surface->patches())
            QVERIFY(patch.area > 0.0f && std::abs(glm::length(patch.normal) - 1.0f) <= 1e-4f);

        const Patched block(share(blockInRoom()), {12, glm::ivec3(along, 0, 0)}, float(shift));
        const double open = 2.0 * (4.0 * 2.0 + 2.0 * 3.0) + 2.0 * 12.0 + 4.0 * 0.5; // the block's top is its floor's
        const double share = block.area() / open;
        QVERIFY2(std::abs(share - 1.0) <= 0.01, qPrintable(QString::number(share)));
    }

    void photonsFindTheirPatch()
    {
        Patched room(share(blockInRoom()), {16, glm::ivec3(0)}, 0.0f);
        std::vector<SegmentBlock> blocks(8);
        QVERIFY(
            traceSegments(*room.at.rays, *room.at.lights, {0, 1, 8 * kSegmentBlock, 64}, 0, blocks, room.workers, {}));
        std::size_t landed = 0, lost = 0;
        const float cell = room.lattice.cellSize.x;
        for (const SegmentBlock& block : blocks) {
            for (const PhotonSegment& way : block.segments) {
                QCOMPARE(way.triangle == PhotonSegment::kNowhere, way.length == PhotonSegment::kEndless);
                if (way.length == PhotonSegment::kEndless) continue;
                ++landed;
                const std::uint32_t index = room.surface->patchOf(way);
                lost += index == GridSurface::kNone ? 1 : 0;
                if (index == GridSurface::kNone) continue;
                const SurfacePatch& patch = room.surface->patches()[index];
                const glm::vec3 gap = glm::abs(way.from + way.length * way.travel - patch.position);
                QVERIFY(std::max({gap.x, gap.y, gap.z}) <= 0.5f * cell * 1.001f);
                QVERIFY(glm::dot(patch.normal, way.travel) < 0.2f);
            }
        }
        QVERIFY(landed > 20'000);
        QVERIFY2(lost <= landed / 10'000, qPrintable(QString::number(lost)));
    }

    void nearerToTheReference_data()
    {
        QTest::addColumn<QString>("scene");
        QTest::addColumn<int>("size");
        QTest::addColumn<double>("most"); // of the error without
        QTest::newRow("cornell") << "cornell" << 10 << 0.8;
        QTest::newRow("atrium") << "atrium" << 16 << 0.7;
    }
    void nearerToTheReference()
    {
        QFETCH(QString, scene);
        QFETCH(int, size);
        QFETCH(double, most);
        const Patched at(share(*sampleScene(scene.toStdString())), {size, glm::ivec3(0)}, 0.0f);
        std::vector<ProbePoint> points;
        for (const SurfacePoint& p : samplePoints(*at.at.rays, *at.at.lights, *at.at.reach, 400, 3))
            points.push_back({p.position, p.normal, points.size()});
        ReferenceJob job;
        job.paths = 1024;
        Workers workers(2);
        const auto reference = referenceIlluminance(*at.at.rays, *at.at.lights, {}, points, job, workers, {}).probes;
        BakeParams p = gridParams(size, 1'000'000);
        IvgSolver solver;
        BakeProducts products;
        const double with = errorAgainst(*runSolver(solver, {at.scene, p, {}}, products).field, points, reference);
        p.gridFit = Switch::off;
        const double without = errorAgainst(*runSolver(solver, {at.scene, p, {}}, products).field, points, reference);
        qInfo("relRMSE %.4f, %.4f without", with, without);
        QVERIFY(with <= most * without);
    }

    void eachLampIsFittedAlone()
    {
        const auto scene = share(*sampleScene("two_rooms"));
        QVERIFY(scene->groups.size() == 2);
        IvgSolver solver;
        BakeProducts products, fresh;
        const auto layers = [](const Baked& baked) {
            return dynamic_cast<const IrradianceGrid&>(*baked.field).layers();
        };
        const auto both = layers(runSolver(solver, {scene, gridParams(10, 100'000), {}}, products));
        const Mix second{glm::vec3(0.0f), glm::vec3(1.0f)};
        const auto one = layers(runSolver(solver, {scene, gridParams(10, 100'000), second}, fresh, 1));
        QVERIFY(!one[0] && one[1] && both[1] && !both[1]->onSurface.empty());
        QVERIFY(one[1]->onSurface == both[1]->onSurface);
    }
};

QTEST_APPLESS_MAIN(GridFitTest)
#include "tst_grid_fit.moc"
