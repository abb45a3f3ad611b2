// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"
#include "core/photonmap/density.h"

namespace lightloom {

/// Density estimation straight from the photon map at every lookup: slow, and the yardstick of the caches.
class PhotonMapField final : public IndirectField {
public:
    struct Layer {
        std::shared_ptr<const PhotonMap> map; ///< null: off
        DensityKernel kernel;
    };
    PhotonMapField(std::shared_ptr<const SurfaceArea> area, std::vector<Layer> layers, Mix mix);
    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override;
    [[nodiscard]] std::optional<float> noise(glm::vec3 p, glm::vec3 n) const override;
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override;
    [[nodiscard]] std::string_view method() const override { return "photon-map"; }
    [[nodiscard]] std::size_t memoryBytes() const override;
    [[nodiscard]] const std::vector<Layer>& layers() const { return layers_; }

private:
    /// Calls use(gain, density, photons' map, gathered) for each group that is on; false if none knows an answer.
    template<class Use>
    bool gatherAll(glm::vec3 p, glm::vec3 n, const Use& use) const;

    std::shared_ptr<const SurfaceArea> area_;
    std::vector<Layer> layers_;
    Mix mix_;
};

/// The field over photons that are there already, from a file say; `maps` by light group, null where a lamp is off.
[[nodiscard]] std::shared_ptr<const PhotonMapField>
photonMapField(const BakeParams& params, const Bounds& bounds, std::shared_ptr<const SurfaceArea> area,
               const std::vector<std::shared_ptr<const PhotonMap>>& maps, Mix mix);

/// Shoots and builds the trees; one snapshot.
class PhotonMapSolver final : public Solver {
public:
    Result<Done> bake(const BakeJob& job, BakeProducts& products, BakeControl& control) override;
};

} // namespace lightloom
