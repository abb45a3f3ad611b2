// SPDX-License-Identifier: Apache-2.0
// Claims: points on voxel entries are spread evenly over their surface; first light is the direct light there, lamp by
// lamp, the same bits on any number of threads; with it, what bounces in a closed room is what is known exactly (A6).
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "core/transport/first_light.h"
#include "light_helpers.h"
#include <QtTest>
#include <cmath>
#include <limits>

using namespace lightloom;
using namespace lightloom::test;

namespace {

struct VoxelScene : LitScene {
    VoxelScene(Scene built, int cells, float shift = 0.0f) : LitScene(std::move(built))
    {
        reach = LightReach::find(*rays, *lights, workers, {});
        voxels = voxelise(scene->bounds, *reach, cells, shift, workers, {});
        for (std::size_t g = 0; g < scene->groups.size(); ++g) groups.push_back(static_cast<int>(g));
    }
    Workers workers{2};
    std::shared_ptr<const LightReach> reach;
    std::shared_ptr<const SurfaceVoxels> voxels;
    std::vector<int> groups; ///< all
};

} // namespace

class VoxelFirstLightTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void pointsLieEvenlyOnTheirEntries()
    {
        const VoxelScene s(*figureScene(1000), 12, 0.3f);
        const SurfaceVoxels& voxels = *s.voxels;
        Rng rng(1, 2, 3);
        for (std::size_t e = 0; e < voxels.entries.size(); e += 7) {
            RunningMean x, y, z;
            for (int i = 0; i < 400; ++i) {
                std::uint32_t facet = 0;
                const glm::vec3 p = voxels.pointOn(e, {rng.uniform(), rng.uniform(), rng.uniform()}, *s.reach, facet);
                const ReachedFacet& f = s.reach->facets()[facet];
                QVERIFY(std::abs(glm::dot(p - f.a, f.normal)) <= 2e-3f * voxels.cellSize());
                const glm::vec3 place = (p - voxels.lattice.lowest) / voxels.cellSize();
                const glm::vec3 cell(mortonCell(voxels.pieces[voxels.firstPiece[e]].cell));
                QVERIFY(glm::all(glm::greaterThanEqual(place, cell - 1e-3f)));
                QVERIFY(glm::all(glm::lessThanEqual(place, cell + 1.001f)));
                x.add(static_cast<double>(p.x)), y.add(static_cast<double>(p.y)), z.add(static_cast<double>(p.z));
            }
            const glm::dvec3 centroid(voxels.entries[e].centroid);
            const double limit = sidakLimit(3 * int(voxels.entries.size() / 7 + 1));
            VERIFY_MEAN(x, centroid.x, limit, "x");
            VERIFY_MEAN(y, centroid.y, limit, "y");
            VERIFY_MEAN(z, centroid.z, limit, "z");
        }
    }

    void aPointLampInACube()
    {
        VoxelScene s(litCube(0.5f, 100.0f), 24, 0.3f);
        const EntryValues lux = firstLight(*s.lights, *s.reach, *s.voxels, s.groups, 4, 1, s.workers, {});
        QCOMPARE(lux.channels, 3);
        double found = 0.0, flux = 0.0;
        for (std::size_t e = 0; e < lux.entries(); ++e) {
            const Orientation& o = s.voxels->entries[e];
            found += static_cast<double>(lux.values[3 * e] * o.area);
            const glm::dvec3 p(o.centroid);
            const double exact = 100.0 / std::pow(glm::dot(p, p), 1.5);
            QVERIFY(std::abs(static_cast<double>(lux.values[3 * e]) / exact - 1.0) <= 0.06); // it varies in a voxel
        }
        flux = 4.0 * kPiD * 100.0;
        QVERIFY(std::abs(found / flux - 1.0) <= 2e-3);
    }

    void closedCavities() // A6: mean indirect E = Phi rho / (A (1 - rho)), with lamps, albedos and bounces of our own
    {
        for (const float rho : {0.2f, 0.8f}) {
            VoxelScene s(cavityL(rho), 48, 0.2f);
            const VoxelOrders orders(*s.voxels);
            const std::vector<glm::vec3> albedo = entryAlbedos(*s.rays, *s.reach, *s.voxels);
            for (const glm::vec3& a : albedo)
                QVERIFY(glm::all(glm::lessThanEqual(glm::abs(a - rho), glm::vec3(1e-5f))));
            const EntryValues first = firstLight(*s.lights, *s.reach, *s.voxels, s.groups, 4, 1, s.workers, {});
            const EntryValues lux =
                bounceLight(*s.rays, *s.voxels, orders, reflected(first, albedo), albedo, {}, s.workers, {});
            double sum = 0.0, area = 0.0;
            for (std::size_t e = 0; e < lux.entries(); ++e) {
                sum += static_cast<double>(lux.values[3 * e] * s.voxels->entries[e].area);
                area += static_cast<double>(s.voxels->entries[e].area);
            }
            const double expected = 1000.0 * double(rho) / (72.0 * (1.0 - double(rho)));
            qInfo("rho %g: %.4f of what is expected", double(rho), sum / area / expected);
            QVERIFY(std::abs(sum / area / expected - 1.0) <= 0.02);
        }
    }

    void eightShadowRaysAreEightSingleOnes()
    {
        const VoxelScene s(*sampleScene("atrium"), 16);
        const Bounds& bounds = s.scene->bounds;
        Rng rng(1, 2, 3);
        const auto anywhere = [&] {
            return bounds.low + glm::vec3(rng.uniform(), rng.uniform(), rng.uniform()) * bounds.size();
        };
        int blocked = 0, asked = 0, others = 0;
        for (int round = 0; round < 5000; ++round) {
            const std::size_t count = 1 + static_cast<std::size_t>(round) % Sights8::kCount;
            Sights8 sights{};
            glm::vec3 from[Sights8::kCount], to[Sights8::kCount];
            for (std::size_t i = 0; i < count; ++i) {
                from[i] = anywhere(), to[i] = round % 2 == 0 ? anywhere() : bounds.centre();
                if (round % 50 == 7 && i == 1) to[i].y = std::numeric_limits<float>::quiet_NaN();
                sights.set(i, from[i], to[i]);
            }
            const std::uint32_t found = s.rays->areBlocked(sights, count);
            QVERIFY(found >> count == 0u);
            for (std::size_t i = 0; i < count; ++i) {
                const bool single = s.rays->isBlocked(from[i], to[i]), isFound = (found >> i & 1u) != 0;
                if (std::isnan(to[i].y)) QVERIFY(isFound && single);
                others += single != isFound ? 1 : 0;
                blocked += single ? 1 : 0;
                ++asked;
            }
        }
        qInfo("%d of %d blocked, %d told otherwise", blocked, asked, others);
        QVERIFY(blocked > asked / 10 && blocked < asked * 9 / 10);
        QVERIFY(others <= asked / 10'000); // along edges rounding may decide
    }

    void lampsAreKeptApart()
    {
        VoxelScene s(twoRooms(), 24);
        const EntryValues lux = firstLight(*s.lights, *s.reach, *s.voxels, s.groups, 2, 1, s.workers, {});
        QCOMPARE(lux.channels, 6);
        Workers three(3);
        QVERIFY(firstLight(*s.lights, *s.reach, *s.voxels, s.groups, 2, 1, three, {}).values == lux.values);
        const int second[] = {1};
        const EntryValues alone = firstLight(*s.lights, *s.reach, *s.voxels, second, 2, 1, three, {});
        QCOMPARE(alone.channels, 3);
        for (std::size_t e = 0; e < lux.entries(); ++e)
            for (std::size_t c = 0; c < 3; ++c) QCOMPARE(alone.values[3 * e + c], lux.values[6 * e + 3 + c]);
        // points that are kept for the next lamp change nothing
        const auto points = entryPoints(*s.reach, *s.voxels, 2, 1, three, {});
        QCOMPARE(points->points.size(), 2 * lux.entries());
        QVERIFY(firstLight(*s.lights, *s.reach, *s.voxels, s.groups, 2, 1, three, {}, {}, points.get()).values ==
                lux.values);
        const auto others = entryPoints(*s.reach, *s.voxels, 2, 2, three, {});
        QVERIFY(firstLight(*s.lights, *s.reach, *s.voxels, s.groups, 2, 1, three, {}, {}, others.get()).values !=
                lux.values);
        RunningMean lumen[2]; // the rooms are closed: all light of each lamp falls on their surface
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
            const EntryValues found = firstLight(*s.lights, *s.reach, *s.voxels, s.groups, 4, seed, three, {});
            double sums[2] = {};
            for (std::size_t i = 1; i < found.values.size(); i += 3) // green
                sums[i / 3 % 2] += static_cast<double>(found.values[i] * s.voxels->entries[i / 6].area);
            for (std::size_t g = 0; g < 2; ++g) lumen[g].add(sums[g]);
        }
        for (std::size_t g = 0; g < 2; ++g)
            VERIFY_MEAN(lumen[g], static_cast<double>(s.lights->groupFlux(int(g)).y), sidakLimit(2, 1e-3), "lamp");
    }
};

QTEST_APPLESS_MAIN(VoxelFirstLightTest)
#include "tst_voxel_first_light.moc"
