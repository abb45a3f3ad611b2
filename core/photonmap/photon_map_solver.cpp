// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/photon_map_solver.h"
#include "core/base/units.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_products.h"
#include <cmath>

namespace lightloom {

PhotonMapField::PhotonMapField(std::shared_ptr<const SurfaceArea> area, std::vector<Layer> layers, Mix mix)
    : area_(std::move(area)), layers_(std::move(layers)), mix_(std::move(mix))
{
}

template<class Use>
bool PhotonMapField::ask(glm::vec3 p, glm::vec3 n, const Use& use) const
{
    thread_local Gathered gathered;
    bool known = false;
    for (std::size_t g = 0; g < layers_.size(); ++g) {
        const Layer& layer = layers_[g];
        const glm::vec3 gain = gainOf(mix_, static_cast<int>(g));
        if (!layer.map || gain == glm::vec3(0.0f)) continue;
        if (const auto found = layer.cache ? layer.cache->lookup(p, n) : std::nullopt) {
            known = true;
            use(gain, found->lux, found->noise);
            continue;
        }
        const Density density = estimateDensity(*layer.map, *area_, layer.kernel, p, n, gathered);
        known = known || density.isAnswer;
        use(gain, glm::vec3(density.lux), static_cast<float>(density.noise));
    }
    return known;
}

bool PhotonMapField::lookup(glm::vec3 p, glm::vec3 n, glm::vec3& lux) const
{
    glm::dvec3 sum(0.0);
    const bool known = ask(p, n, [&](glm::vec3 gain, glm::vec3 one, float) { sum += glm::dvec3(gain * one); });
    lux = glm::vec3(sum);
    return known;
}

std::optional<float> PhotonMapField::noise(glm::vec3 p, glm::vec3 n) const
{
    double variance = 0.0;
    const bool known = ask(p, n, [&](glm::vec3 gain, glm::vec3 lux, float noise) {
        const float baked = luminance(lux); // the lamp's tint moves light and noise alike
        const auto one = static_cast<double>(noise * (baked > 0.0f ? luminance(gain * lux) / baked : luminance(gain)));
        variance += one * one;
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
    for (const Layer& layer : layers_) {
        sum += layer.map ? layer.map->memoryBytes() : 0;
        sum += layer.cache ? layer.cache->memoryBytes() : 0;
    }
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
        layers.push_back({map, map ? DensityKernel::of(params, *map, *area, cell) : DensityKernel{}, nullptr});
    }
    return std::make_shared<PhotonMapField>(std::move(area), std::move(layers), std::move(mix));
}

Result<std::shared_ptr<const PhotonMapField>>
withCaches(const PhotonMapField& field, std::vector<ChristensenCache::Values> values, const std::stop_token& stop)
{
    std::vector<PhotonMapField::Layer> layers = field.layers();
    for (std::size_t g = 0; g < layers.size(); ++g) {
        if (!layers[g].map) continue;
        if (g < values.size()) {
            layers[g].cache = ChristensenCache::from(*layers[g].map, layers[g].kernel, std::move(values[g]), stop);
        }
        if (stop.stop_requested()) return cancelled();
        if (!layers[g].cache) {
            return Error{Error::Kind::badInput, "the bake's kept irradiance does not fit its photons; bake again"};
        }
    }
    return std::shared_ptr<const PhotonMapField>(
        std::make_shared<PhotonMapField>(field.area(), std::move(layers), field.mix()));
}

std::shared_ptr<const PhotonMapField> withCaches(const PhotonMapField& field, BakeControl& control,
                                                 const std::function<void(double)>& progress)
{
    std::vector<PhotonMapField::Layer> layers = field.layers();
    double done = 0.0, all = 0.0;
    for (const auto& layer : layers) all += layer.map ? static_cast<double>(layer.map->size()) : 0.0;
    for (auto& layer : layers) {
        if (!layer.map) continue;
        const auto share = static_cast<double>(layer.map->size());
        layer.cache = ChristensenCache::build(*layer.map, *field.area(), layer.kernel, control, [&](double part) {
            if (progress) progress((done + share * part) / all);
        });
        if (!layer.cache) return nullptr;
        done += share;
    }
    return std::make_shared<PhotonMapField>(field.area(), std::move(layers), field.mix());
}

namespace {

constexpr double kShootShare = 0.7; ///< of a bake with caches

/// The field with a cache for every lamp that is on, from `products` or filled now. Null: stopped.
std::shared_ptr<const PhotonMapField> cached(const PhotonMapField& field, const BakeJob& job,
                                             const SceneProducts& scene, BakeProducts& products, BakeControl& control)
{
    std::vector<PhotonMapField::Layer> layers = field.layers();
    const auto each = (1.0 - kShootShare) / static_cast<double>(std::max<std::size_t>(layers.size(), 1));
    for (std::size_t g = 0; g < layers.size(); ++g) {
        PhotonMapField::Layer& layer = layers[g];
        if (!layer.map) continue;
        const std::string key = scene.layerKey(g) + stageKey(job.params, Stage::fit, Method::photonMap);
        layer.cache = products.find<ChristensenCache>(key);
        if (layer.cache) continue;
        const StageClock clock("gather cache", control);
        const double before = kShootShare + each * static_cast<double>(g);
        layer.cache = ChristensenCache::build(*layer.map, *field.area(), layer.kernel, control,
                                              [&](double part) { control.progress(Stage::fit, before + each * part); });
        if (!layer.cache) return nullptr;
        products.counters.gathers += layer.cache->values().lux.size();
        products.keep(key, layer.cache, clock.stop());
    }
    return std::make_shared<PhotonMapField>(field.area(), std::move(layers), field.mix());
}

} // namespace

Result<Done> PhotonMapSolver::bake(const BakeJob& job, BakeProducts& products, BakeControl& control)
{
    const bool isCached = job.params.photonLookup == PhotonLookup::christensen;
    const Result<PhotonProducts> photons = photonProducts(job, products, control, isCached ? kShootShare : 1.0);
    if (!photons) return photons.error();
    auto field = photonMapField(job.params, job.scene->bounds, photons->area, photons->maps, job.mix);
    if (isCached) field = cached(*field, job, photons->scene, products, control);
    if (!field) return cancelled();
    control.progress(Stage::fit, 1.0);
    control.publish(std::move(field), 0, true);
    return Done{};
}

} // namespace lightloom
