// SPDX-License-Identifier: Apache-2.0
// Claims: light bounced along a few exact rays of each voxel is what is known exactly, in furnaces (A8) at every entry
// and in closed cavities (A6) in the mean, wherever one begins to look for it; lamps do not mix; the same bits on any
// number of threads.
#include "core/lightcuts/ray_partners.h"
#include "core/scene/analytic_scenes.h"
#include "core/scene/sample_scenes.h"
#include "light_helpers.h"
#include "voxel_lights.h"
#include <QtTest>

using namespace lightloom;
using namespace lightloom::test;

namespace {

struct Bounced : LitScene {
    Bounced(Scene built, int cells) : LitScene(std::move(built))
    {
        reach = LightReach::find(*rays, *lights, workers, {});
        voxels = voxelise(scene->bounds, *reach, cells, 0.3f, workers, {});
        albedo = entryAlbedos(*rays, *reach, *voxels);
        partners = RayPartners::trace(*rays, *reach, *voxels, 16, 1, workers, {});
    }
    [[nodiscard]] EntryValues even(float value, int channels = 3) const
    {
        return {channels, std::vector<float>(voxels->entries.size() * static_cast<std::size_t>(channels), value)};
    }
    /// Of the first channel, by area.
    [[nodiscard]] double mean(const EntryValues& values) const
    {
        double sum = 0.0, area = 0.0;
        for (std::size_t e = 0; e < values.entries(); ++e) {
            sum += static_cast<double>(values.values[e * static_cast<std::size_t>(values.channels)]) *
                   static_cast<double>(voxels->entries[e].area);
            area += static_cast<double>(voxels->entries[e].area);
        }
        return sum / area;
    }
    Workers workers{2};
    std::shared_ptr<const LightReach> reach;
    std::shared_ptr<const SurfaceVoxels> voxels;
    std::vector<glm::vec3> albedo;
    std::shared_ptr<const RayPartners> partners;
};

} // namespace

class RayPartnersTest : public QObject {
    Q_OBJECT

private Q_SLOTS:
    void furnacesGlowEvenly() // E = M / (1 - rho), from below and from above
    {
        Bounced box(furnaceBox(0.5f), 24);
        for (const float guess : {0.0f, 5.0f}) {
            const EntryValues lux =
                box.partners->bounced(box.even(1.0f), box.albedo, box.even(guess), box.workers, {}, 1e-4);
            for (std::size_t e = 0; e < lux.entries(); ++e) QVERIFY(std::abs(lux.values[3 * e] / 2.0f - 1.0f) <= 1e-3f);
        }
    }

    void closedCavities() // mean indirect E = Phi rho / (A (1 - rho))
    {
        for (const float rho : {0.2f, 0.8f}) {
            Bounced room(cavityL(rho), 32);
            const std::vector<int> groups{0};
            const EntryValues first =
                firstLight(*room.lights, *room.reach, *room.voxels, groups, 4, 1, room.workers, {});
            const EntryValues lux = room.partners->bounced(reflected(first, room.albedo), room.albedo, room.even(0.0f),
                                                           room.workers, {}, 1e-4);
            const double expected = 1000.0 * double(rho) / (72.0 * (1.0 - double(rho)));
            qInfo("rho %g: %.4f of what is expected", double(rho), room.mean(lux) / expected);
            QVERIFY(std::abs(room.mean(lux) / expected - 1.0) <= 0.01);
        }
    }

    void linesAgreeAndLampsAreKeptApart()
    {
        Bounced rooms(twoRooms(), 40);
        const std::vector<int> both{0, 1}, one{1};
        EntryValues lux[2];
        for (const auto* groups : {&both, &one}) {
            const EntryValues first =
                firstLight(*rooms.lights, *rooms.reach, *rooms.voxels, *groups, 4, 1, rooms.workers, {});
            const EntryValues leaving = reflected(first, rooms.albedo);
            EntryValues& found = lux[groups == &both ? 0 : 1];
            found =
                rooms.partners->bounced(leaving, rooms.albedo, rooms.even(0.0f, leaving.channels), rooms.workers, {});
            Workers three(3);
            QVERIFY(
                found.values ==
                rooms.partners->bounced(leaving, rooms.albedo, rooms.even(0.0f, leaving.channels), three, {}).values);
            if (groups == &one) {
                const EntryValues lines = bounceLight(*rooms.rays, *rooms.voxels, VoxelOrders(*rooms.voxels), leaving,
                                                      rooms.albedo, {}, rooms.workers, {});
                qInfo("rays %.4f, lines %.4f lux", rooms.mean(found), rooms.mean(lines));
                QVERIFY(std::abs(rooms.mean(found) / rooms.mean(lines) - 1.0) <= 0.05);
            }
        }
        for (std::size_t e = 0; e < rooms.voxels->entries.size(); ++e) {
            for (std::size_t c = 0; c < 3; ++c) QVERIFY(lux[0].values[6 * e + 3 + c] == lux[1].values[3 * e + c]);
        }
        Workers three(3);
        QVERIFY(RayPartners::trace(*rooms.rays, *rooms.reach, *rooms.voxels, 16, 1, three, {})
                    ->bounced(rooms.even(1.0f), rooms.albedo, rooms.even(0.0f), three, {})
                    .values ==
                rooms.partners->bounced(rooms.even(1.0f), rooms.albedo, rooms.even(0.0f), three, {}).values);
    }
};

QTEST_APPLESS_MAIN(RayPartnersTest)
#include "tst_ray_partners.moc"
