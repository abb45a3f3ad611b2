// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/bake_control.h"
#include "core/photonmap/density.h"

namespace lightloom {

/// Irradiance kept at every 4th photon of a map; a lookup takes the nearest kept one on a surface that faces alike
/// (Christensen, Faster photon map global illumination, 1999; the yardstick of the 2007 and 2009 papers). Much faster
/// than density estimation at every point, and constant within the patch that is nearest to a point: those patches
/// show. Never changes once made; any thread may ask.
class ChristensenCache {
public:
    static constexpr std::size_t kEvery = 4;

    /// What is kept, point i at the map's photon kEvery * i. Plain data: bake files hold it.
    struct Values {
        std::vector<glm::vec3> lux;
        std::vector<float> noise; ///< standard error of the luminance, lux
    };
    /// Density estimation at every point, on all workers, the same bits on any number of them. `map` and `area` are not
    /// kept. Null: stopped.
    static std::shared_ptr<const ChristensenCache> build(const PhotonMap& map, const SurfaceArea& area,
                                                         const DensityKernel& kernel, BakeControl& control,
                                                         const std::function<void(double fraction)>& progress = {});
    /// From what an earlier one kept; null if `values` are not as many as the map's points. Null as well: stopped.
    static std::shared_ptr<const ChristensenCache> from(const PhotonMap& map, const DensityKernel& kernel,
                                                        Values values, const std::stop_token& stop = {});

    struct Found {
        glm::vec3 lux{0.0f};
        float noise = 0.0f;
    };
    /// At the nearest point within the kernel's cap whose surface faces as the kernel asks; nothing if there is none.
    [[nodiscard]] std::optional<Found> lookup(glm::vec3 p, glm::vec3 n) const;

    [[nodiscard]] const Values& values() const { return values_; }
    [[nodiscard]] std::size_t memoryBytes() const;

private:
    ChristensenCache(std::shared_ptr<const PhotonMap> points, const DensityKernel& kernel, Values values)
        : points_(std::move(points)), kernel_(kernel), values_(std::move(values))
    {
    }
    std::shared_ptr<const PhotonMap> points_; ///< tree over the kept photons
    DensityKernel kernel_;
    Values values_;
};

} // namespace lightloom
