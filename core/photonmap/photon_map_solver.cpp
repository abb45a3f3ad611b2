// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/photon_map_solver.h"
#include "core/base/units.h"
#include "core/photonmap/photon_products.h"
#include <cmath>

namespace lightloom {

PhotonMapField::PhotonMapField(std::shared_ptr<const SurfaceArea> area, std::vector<Layer> layers, Mix mix)
    : area_(std::move(area)), layers_(std::move(layers)), mix_(std::move(mix))
{
}

template<class Use>
bool PhotonMapField::gatherAll(glm::vec3 p, glm::vec3 n, const Use& use) const
{
    thread_local Gathered gathered;
    bool known = false;
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        const Layer& layer = layers_[g];
        const glm::vec3 gain = gainOf(mix_, static_cast<int>(g));
        if (!layer.map || gain == glm::vec3(0.0f)) continue;
        const Density density = estimateDensity(*layer.map, *area_, layer.kernel, p, n, gathered);
        known = known || density.isAnswer;
        use(glm::dvec3(gain), density, *layer.map, gathered);
    }
    return known;
}

bool PhotonMapField::lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const
{
    glm::dvec3 sum(0.0);
    const bool known =
        gatherAll(p, n, [&](glm::dvec3 gain, const Density& density, const PhotonMap& map, const Gathered& gathered) {
            glm::dvec3 flux(0.0);
            for (const std::uint32_t i : gathered.photons) flux += glm::dvec3(map.photon(i).flux);
            sum += gain * flux * density.perFlux;
        });
    lux = glm::vec3(sum);
    return known;
}

std::optional<float> PhotonMapField::noise(glm::vec3 p, glm::vec3 n) const
{
    double variance = 0.0; // of a sum of independent photons: the sum of their squares
    const bool known =
        gatherAll(p, n, [&](glm::dvec3 gain, const Density& density, const PhotonMap& map, const Gathered& gathered) {
            for (const std::uint32_t i : gathered.photons) {
                const auto lux = static_cast<double>(luminance(glm::vec3(gain) * map.photon(i).flux)) * density.perFlux;
                variance += lux * lux;
            }
        });
    if (!known) return {};
    return static_cast<float>(std::sqrt(variance));
}

std::shared_ptr<const IndirectField> PhotonMapField::withMix(Mix mix) const
{
    return std::make_shared<PhotonMapField>(area_, layers_, std::move(mix));
}

std::size_t PhotonMapField::memoryBytes() const
{
    std::size_t sum = 0;
    for (const Layer& layer : layers_) sum += layer.map ? layer.map->memoryBytes() : 0;
    return sum;
}

std::shared_ptr<const PhotonMapField> photonMapField(const BakeParams& params, const Bounds& bounds,
                                                     std::shared_ptr<const SurfaceArea> area,
                                                     const std::vector<std::shared_ptr<const PhotonMap>>& maps, Mix mix)
{
    // "leaf widths" of the radius parameter: a 64th of the longest side, as the octree's at its default depth
    const float cell = bounds.longestSide() / 64.0f;
    std::vector<PhotonMapField::Layer> layers;
    for (const auto& map : maps) {
        layers.push_back({map, map ? DensityKernel::of(params, *map, *area, cell) : DensityKernel{}});
    }
    return std::make_shared<PhotonMapField>(std::move(area), std::move(layers), std::move(mix));
}

Result<Done> PhotonMapSolver::bake(const BakeJob& job, BakeProducts& products, BakeControl& control)
{
    const Result<PhotonProducts> photons = photonProducts(job, products, control, 1.0);
    if (!photons) return photons.error();
    control.progress(Stage::fit, 1.0);
    control.publish(photonMapField(job.params, job.scene->bounds, photons->area, photons->maps, job.mix), 0, true);
    return Done{};
}

} // namespace lightloom
