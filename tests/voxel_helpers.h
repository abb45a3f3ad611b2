// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/voxel_bounces.h"
#include "tests/light_helpers.h"

namespace lightloom::test {

/// A scene's surface in voxels, ready for bounces.
struct Voxels {
    std::shared_ptr<const RayScene> rays;
    std::shared_ptr<const SurfaceVoxels> surface;
    std::optional<VoxelOrders> orders;
    std::shared_ptr<const PartnerTable> kept;

    explicit Voxels(const Scene& scene, int cells, float shift = 0.0f)
    {
        Workers workers(2);
        rays = *RayScene::build(std::make_shared<const Scene>(scene));
        const auto reach = LightReach::find(*rays, LightSampler(rays), workers, {});
        surface = voxelise(scene.bounds, *reach, cells, shift, workers, {});
        orders.emplace(*surface);
    }
    [[nodiscard]] const std::vector<Orientation>& entries() const { return surface->entries; }
    [[nodiscard]] std::shared_ptr<const PartnerTable> stored(int directions, std::size_t mostBytes = 1u << 30,
                                                             int threads = 2) const
    {
        Workers workers(threads);
        return PartnerTable::make(*rays, *surface, *orders, directions, mostBytes, workers, {});
    }
    [[nodiscard]] EntryValues bounced(const EntryValues& radiosity, const std::vector<glm::vec3>& albedo,
                                      const BounceParams& params = {}, int threads = 2,
                                      const PartnerTable* table = nullptr) const
    {
        Workers workers(threads);
        return bounceLight(*rays, *surface, *orders, radiosity, albedo, params, workers, {}, nullptr, table);
    }
    /// The first channel under grey light, `radiosity` and `albedo` by entry. Partners are stored for the next time:
    /// tst_partner_table holds their bits to those of walking.
    template<class Radiosity, class Albedo>
    [[nodiscard]] std::vector<double> grey(Radiosity radiosity, Albedo albedo, const BounceParams& params = {})
    {
        EntryValues first;
        std::vector<glm::vec3> albedos;
        for (const Orientation& o : entries()) {
            first.values.insert(first.values.end(), 3, static_cast<float>(radiosity(o)));
            albedos.emplace_back(static_cast<float>(albedo(o)));
        }
        if (!kept || kept->directions() < params.directions) kept = stored(params.directions);
        const EntryValues lux = bounced(first, albedos, params, 2, kept.get());
        std::vector<double> values;
        for (std::size_t e = 0; e < entries().size(); ++e) values.push_back(static_cast<double>(lux.values[3 * e]));
        return values;
    }
    [[nodiscard]] double meanOf(const std::vector<double>& values) const
    {
        double sum = 0.0, area = 0.0;
        for (std::size_t e = 0; e < values.size(); ++e) {
            sum += values[e] * static_cast<double>(entries()[e].area);
            area += static_cast<double>(entries()[e].area);
        }
        return sum / area;
    }
};

} // namespace lightloom::test
