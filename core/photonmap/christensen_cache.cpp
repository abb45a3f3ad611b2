// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/christensen_cache.h"
#include "core/base/units.h"
#include <atomic>
#include <cmath>

namespace lightloom {
namespace {

constexpr std::size_t kBlock = 256; ///< points that one thread takes at a time

/// Numbers of the photons that are kept, in the order they were shot.
std::vector<std::uint32_t> pointsOf(const PhotonMap& map)
{
    const std::vector<std::uint32_t> all = map.listOrder();
    std::vector<std::uint32_t> points;
    points.reserve(all.size() / ChristensenCache::kEvery + 1);
    for (std::size_t i = 0; i < all.size(); i += ChristensenCache::kEvery) points.push_back(all[i]);
    return points;
}

/// Density estimation at a photon; `values` are as large as there are points.
void estimate(const PhotonMap& map, const SurfaceArea& area, const DensityKernel& kernel, const Photon& photon,
              std::size_t point, Gathered& gathered, ChristensenCache::Values& values)
{
    const Density density = estimateDensity(map, area, kernel, photon.position, photon.normal, gathered);
    values.lux[point] = glm::vec3(density.lux);
    values.noise[point] = static_cast<float>(density.noise);
}

} // namespace

std::shared_ptr<const ChristensenCache> ChristensenCache::build(const PhotonMap& map, const SurfaceArea& area,
                                                                const DensityKernel& kernel, BakeControl& control,
                                                                const std::function<void(double)>& progress)
{
    const std::vector<std::uint32_t> points = pointsOf(map);
    const std::size_t count = points.size(), blocks = (count + kBlock - 1) / kBlock;
    Values values{std::vector<glm::vec3>(count), std::vector<float>(count)};
    std::atomic<std::size_t> done = 0;
    const bool all = control.forBlocks(blocks, [&](std::size_t block) {
        thread_local Gathered gathered;
        for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
            if (control.isStopped()) return;
            estimate(map, area, kernel, map.photon(points[i]), i, gathered, values);
        }
        if (progress) progress(static_cast<double>(++done) / static_cast<double>(blocks));
    });
    if (!all || control.isStopped()) return nullptr;
    return from(map, kernel, std::move(values), control.stop());
}

std::shared_ptr<const ChristensenCache> ChristensenCache::from(const PhotonMap& map, const DensityKernel& kernel,
                                                               Values values, const std::stop_token& stop)
{
    const std::vector<std::uint32_t> numbers = pointsOf(map);
    if (values.lux.size() != numbers.size() || values.noise.size() != numbers.size()) return nullptr;
    auto kept = std::make_shared<PhotonPaths>();
    kept->photons.reserve(numbers.size());
    for (const std::uint32_t number : numbers) kept->photons.push_back(map.photon(number));
    auto points = PhotonMap::build(kept, stop);
    if (!points) return nullptr;
    return std::shared_ptr<const ChristensenCache>(new ChristensenCache(std::move(points), kernel, std::move(values)));
}

std::optional<ChristensenCache::Found> ChristensenCache::lookup(glm::vec3 p, glm::vec3 n) const
{
    thread_local Gathered gathered;
    points_->gather({p, n, kernel_.cap, kernel_.stretch, kernel_.leastCosine, 1}, gathered);
    if (gathered.photons.empty()) return std::nullopt;
    const std::uint32_t nearest = points_->origin(gathered.photons.front()); // values are in the order of their list
    return Found{values_.lux[nearest], values_.noise[nearest]};
}

std::size_t ChristensenCache::memoryBytes() const
{
    return points_->memoryBytes() + values_.lux.size() * (sizeof(glm::vec3) + sizeof(float));
}

} // namespace lightloom
