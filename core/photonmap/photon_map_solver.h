// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/field/solver.h"
#include "core/photonmap/christensen_cache.h"

namespace lightloom {

/// Density estimation straight from the photon map at every lookup: slow, and the yardstick of the caches. Or, with
/// caches, the nearest kept irradiance; where none is near, density estimation after all.
class PhotonMapField final : public IndirectField {
public:
    struct Layer {
        std::shared_ptr<const PhotonMap> map; ///< null: off
        DensityKernel kernel;
        std::shared_ptr<const ChristensenCache> cache; ///< null: none is asked for
    };
    PhotonMapField(std::shared_ptr<const SurfaceArea> area, std::vector<Layer> layers, Mix mix);
    [[nodiscard]] bool lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const override;
    [[nodiscard]] std::optional<float> noise(glm::vec3 p, glm::vec3 n) const override;
    [[nodiscard]] std::shared_ptr<const IndirectField> withMix(Mix mix) const override;
    [[nodiscard]] std::string_view method() const override { return "photon-map"; }
    [[nodiscard]] std::size_t memoryBytes() const override;
    [[nodiscard]] const std::vector<Layer>& layers() const { return layers_; }
    [[nodiscard]] const std::shared_ptr<const SurfaceArea>& area() const { return area_; }
    [[nodiscard]] const Mix& mix() const { return mix_; }

private:
    /// Calls use(gain, lux, noise) for each group that is on; false if none knows an answer.
    template<class Use>
    bool ask(glm::vec3 p, glm::vec3 n, const Use& use) const;

    std::shared_ptr<const SurfaceArea> area_;
    std::vector<Layer> layers_;
    Mix mix_;
};

/// The field over photons that are there already, from a file say; `maps` by light group, null where a lamp is off. No
/// caches, whatever the parameters say: `withCaches` brings them.
[[nodiscard]] std::shared_ptr<const PhotonMapField>
photonMapField(const BakeParams& params, const Bounds& bounds, std::shared_ptr<const SurfaceArea> area,
               const std::vector<std::shared_ptr<const PhotonMap>>& maps, Mix mix);

/// The same field with these caches, by light group, that an earlier bake filled. Error: not of these photons.
[[nodiscard]] Result<std::shared_ptr<const PhotonMapField>>
withCaches(const PhotonMapField& field, std::vector<ChristensenCache::Values> values, const std::stop_token& stop);
/// The same field with a Christensen cache for every lamp that is on, filled now. Null: stopped.
[[nodiscard]] std::shared_ptr<const PhotonMapField> withCaches(const PhotonMapField& field, BakeControl& control,
                                                               const std::function<void(double)>& progress = {});

/// Shoots, builds the trees, fills the caches where asked; one snapshot.
class PhotonMapSolver final : public Solver {
public:
    Result<Done> bake(const BakeJob& job, BakeProducts& products, BakeControl& control) override;
};

} // namespace lightloom
