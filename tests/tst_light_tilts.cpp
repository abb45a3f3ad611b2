// SPDX-License-Identifier: Apache-2.0
// Claims: light of voxels leans as the integral over what shines says, group by group, the same bits on any number of
// threads, stored or walked; not where a few voxels send it, nor by more than 45 degrees; a ball lit from one side is
// nearer to the truth with it, flat surface the same without, and pixels' arrays give what the field does.
#include "bake_helpers.h"
#include "core/bake/packed_octree.h"
#include "core/base/units.h"
#include "core/scene/sample_scenes.h"
#include "core/scene/scene_builder.h"
#include "core/scene/shapes.h"
#include "core/transport/light_tilts.h"
#include "core/voxel/voxel_solver.h"
#include "voxel_helpers.h"

using namespace lightloom;
using namespace lightloom::test;

namespace {

Scene box()
{
    SceneBuilder builder("box");
    builder.add("Room", boxMesh({0, 0, 0}, {1, 1, 1}, Facing::in), builder.addMaterial("grey", glm::vec3(0.5f)));
    builder.addPoint("Lamp", {0.5f, 0.5f, 0.5f}, glm::vec3(100.0f));
    return builder.finish();
}

/// `radiosity` of each entry in each of `groups` light groups.
template<class Of>
EntryValues shining(const Voxels& voxels, std::size_t groups, Of radiosity)
{
    EntryValues values{static_cast<int>(3 * groups), {}};
    for (const Orientation& o : voxels.entries())
        for (std::size_t g = 0; g < groups; ++g) values.values.insert(values.values.end(), 3, radiosity(o, g));
    return values;
}

EntryValues tilts(const Voxels& voxels, const EntryValues& radiosity, int directions, int threads = 2,
                  const PartnerTable* stored = nullptr)
{
    Workers workers(threads);
    return lightTilts(*voxels.rays, *voxels.surface, *voxels.orders, radiosity, directions, workers, {}, stored);
}

glm::vec3 at(const EntryValues& values, std::size_t entry, std::size_t group)
{
    const float* v = &values.values[entry * static_cast<std::size_t>(values.channels) + 3 * group];
    return {v[0], v[1], v[2]};
}

bool isOnFloor(const Orientation& o) { return o.normal.y > 0.9f; }
/// Half of the ceiling: x above .5 in group 0, below in group 1.
float halfCeiling(const Orientation& o, std::size_t group)
{
    return o.normal.y < -0.9f && (o.centroid.x > 0.5f) == (group == 0) ? 1.0f : 0.0f;
}

/// Of a floor point below that half, by a fine grid.
glm::vec3 tiltByIntegral(glm::vec3 p, std::size_t group)
{
    constexpr int kSteps = 200;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < kSteps; ++i) {
        for (int j = 0; j < kSteps; ++j) {
            const glm::dvec3 way =
                glm::dvec3((group == 0 ? 0.5 : 0.0) + 0.5 * (i + 0.5) / kSteps, 1.0, (j + 0.5) / kSteps) -
                glm::dvec3(p);
            const double distance = glm::length(way);
            sum += way / distance * (way.y / (distance * distance * distance));
        }
    }
    return glm::vec3(sum / sum.y) - glm::vec3(0, 1, 0);
}

/// A ball in a room whose left half is lit.
Scene ballBesideLight()
{
    SceneBuilder builder("ball");
    const int grey = builder.addMaterial("grey", glm::vec3(0.5f));
    builder.add("Room", boxMesh({-1, 0, -1}, {1, 2, 1}, Facing::in), grey);
    builder.add("Ball", sphereMesh({0.1f, 0.9f, 0.05f}, 0.4f, 10), grey);
    builder.addPoint("Lamp", {-0.8f, 1.6f, 0.1f}, glm::vec3(100.0f));
    builder.addPoint("Other", {0.5f, 0.2f, -0.7f}, glm::vec3(5.0f, 20.0f, 40.0f));
    return builder.finish();
}

} // namespace

class LightTiltsTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void leanAsTheIntegralSays()
    {
        const Voxels voxels(box(), 24);
        const EntryValues radiosity = shining(voxels, 2, halfCeiling);
        for (const int directions : {kTiltDirections, 2048}) {
            const EntryValues found = tilts(voxels, radiosity, directions);
            double squares = 0.0, largest = 0.0;
            int count = 0;
            for (std::size_t e = 0; e < voxels.entries().size(); ++e) {
                const Orientation& o = voxels.entries()[e];
                if (!isOnFloor(o) || o.area < 0.5f * voxels.surface->cellSize() * voxels.surface->cellSize()) continue;
                for (std::size_t g = 0; g < 2; ++g) {
                    const glm::vec3 tilt = at(found, e, g), wanted = tiltByIntegral(o.centroid, g);
                    QVERIFY(std::abs(tilt.y) <= 1e-5f);
                    const double off = static_cast<double>(glm::length(tilt - wanted));
                    squares += off * off, largest = std::max(largest, off), ++count;
                }
            }
            const double rms = std::sqrt(squares / count);
            qInfo("%d directions, %d tilts: off by %.4f, at most %.3f", directions, count, rms, largest);
            QVERIFY(count > 500);
            QVERIFY(rms <= (directions == 2048 ? 0.03 : 0.15));
        }
    }

    void groupsThreadsAndTablesChangeNothing()
    {
        const Voxels voxels(twoRooms(), 24);
        const auto of = [](const Orientation& o, std::size_t g) {
            return g == 0 ? 1.0f + o.centroid.x * o.centroid.x : glm::max(0.0f, o.normal.y) + 0.25f;
        };
        const EntryValues both = shining(voxels, 2, of);
        const EntryValues second = shining(voxels, 1, [&](const Orientation& o, std::size_t) { return of(o, 1); });
        const EntryValues brighter =
            shining(voxels, 2, [&](const Orientation& o, std::size_t g) { return 4 * of(o, g); });
        const auto table = voxels.stored(128), some = voxels.stored(48);
        const EntryValues found = tilts(voxels, both, 128, 1);
        QVERIFY(tilts(voxels, both, 128, 5).values == found.values);
        QVERIFY(tilts(voxels, both, 128, 2, table.get()).values == found.values);
        QVERIFY(tilts(voxels, both, 128, 2, some.get()).values == found.values);
        QVERIFY(tilts(voxels, brighter, 128).values == found.values);
        const EntryValues alone = tilts(voxels, second, 128);
        for (std::size_t e = 0; e < voxels.entries().size(); ++e) QVERIFY(at(alone, e, 0) == at(found, e, 1));
    }

    void fewSendersAndLowLight()
    {
        const Voxels voxels(box(), 24);
        std::size_t ceiling = 0;
        while (halfCeiling(voxels.entries()[ceiling], 0) == 0.0f) ++ceiling;
        const glm::vec3 spot = voxels.entries()[ceiling].centroid;
        const EntryValues radiosity = shining(voxels, 2, [&](const Orientation& o, std::size_t g) {
            return (g == 0 ? o.centroid == spot && halfCeiling(o, 0) > 0.0f : o.normal.x < -0.9f) ? 1.0f : 0.0f;
        });
        const EntryValues found = tilts(voxels, radiosity, 512);
        int low = 0;
        for (std::size_t e = 0; e < voxels.entries().size(); ++e) {
            QVERIFY(at(found, e, 0) == glm::vec3(0.0f));
            const float length = glm::length(at(found, e, 1));
            QVERIFY(length <= kMostTilt * 1.0001f);
            low += isOnFloor(voxels.entries()[e]) && length > 0.9f * kMostTilt; // lit by a wall
        }
        QVERIFY(low > 50);
        std::stop_source stopped;
        stopped.request_stop();
        Workers workers(2);
        QVERIFY(lightTilts(*voxels.rays, *voxels.surface, *voxels.orders, radiosity, 64, workers, stopped.get_token())
                    .values.empty());
    }

    void aBallIsNearerToTheTruth()
    {
        const auto scene = share(ballBesideLight());
        BakeParams p;
        p.voxelSize = 20, p.voxelDirections = 512;
        p.voxelLookup = VoxelLookup::field;
        VoxelSolver solver;
        BakeProducts products;
        const Baked baked = runSolver(solver, {scene, p, {}}, products);
        const auto& field = dynamic_cast<const VoxelField&>(*baked.field);
        const auto flat = field.octree().showing(OctreeShow::colour);
        const auto packed = *PackedOctree::make(field.octreeShared());
        const auto rays = *RayScene::build(scene);
        std::vector<ProbePoint> points;
        for (const FacePoint& f : facePoints(*scene, 6000, 1)) {
            if (points.size() < 400 && glm::length(f.position - glm::vec3(0.1f, 0.9f, 0.05f)) < 0.42f)
                points.push_back({f.position, f.normal, points.size()});
            else if (std::abs(f.normal.x) > 0.99f)
                QVERIFY(maxChannel(glm::abs(field.irradiance(f.position, f.normal) -
                                            flat->irradiance(f.position, f.normal))) <=
                        1e-5f * maxChannel(flat->irradiance(f.position, f.normal)));
        }
        ReferenceJob job;
        job.paths = 1024;
        Workers workers(2);
        const auto truth = referenceIlluminance(*rays, LightSampler(rays), {}, points, job, workers, {});
        double squares[3] = {}, mean = 0.0; // leaning, flat, packed against leaning
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::vec3 leaning = field.irradiance(points[i].position, points[i].normal);
            const auto off = [&](glm::vec3 lux, glm::vec3 from) {
                return std::pow(static_cast<double>(luminance(lux) - luminance(from)), 2.0);
            };
            squares[0] += off(leaning, truth.probes[i].indirect);
            squares[1] += off(flat->irradiance(points[i].position, points[i].normal), truth.probes[i].indirect);
            squares[2] += off(packed->irradiance(points[i].position, points[i].normal), leaning);
            mean += static_cast<double>(luminance(truth.probes[i].indirect));
        }
        const auto count = static_cast<double>(points.size());
        const auto rms = [&](int i) { return std::sqrt(squares[i] / count) / (mean / count); };
        qInfo("%g points: off by %.4f, %.4f without directions; packed off by %.4f", count, rms(0), rms(1), rms(2));
        QVERIFY(count > 300.0);
        QVERIFY(rms(0) <= 0.7 * rms(1));
        QVERIFY(rms(2) <= 0.005);
    }
};

QTEST_APPLESS_MAIN(LightTiltsTest)
#include "tst_light_tilts.moc"
