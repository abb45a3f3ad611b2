// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/density.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lightloom {

DensityKernel DensityKernel::of(const BakeParams& params, const PhotonMap& map, const SurfaceArea& area, float cellSize)
{
    DensityKernel kernel;
    // one photon gives no density: (K-1)/K would be zero
    kernel.count = static_cast<std::uint32_t>(std::max(params.gatherCount, 2));
    kernel.stretch = params.gatherKernel == GatherKernel::ellipsoid ? 3.0f : 1.0f;
    kernel.areaFloor = 1e-8f * cellSize * cellSize;
    if (params.gatherRadius > 0.0f) {
        kernel.cap = params.gatherRadius * cellSize;
    } else {
        const double photons = std::max<double>(1.0, static_cast<double>(map.size()));
        const double even = std::sqrt(kernel.count * area.total() / (std::numbers::pi * photons));
        kernel.cap = static_cast<float>(std::max(3.0 * even, static_cast<double>(cellSize)));
    }
    return kernel;
}

Density estimateDensity(const PhotonMap& map, const SurfaceArea& area, const DensityKernel& kernel, glm::vec3 p,
                        glm::vec3 n, Gathered& gathered)
{
    const GatherQuery query{p, n, kernel.cap, kernel.stretch, kernel.leastCosine, kernel.count};
    map.gather(query, gathered);
    Density density;
    const double under = area.under(p, n, gathered.radius, kernel.stretch, kernel.leastCosine);
    const double floor = static_cast<double>(kernel.areaFloor);
    if (!(under > 0.0) && gathered.photons.empty()) return density;
    density.isAnswer = true;
    density.isDegenerate = !(under >= floor) && !gathered.photons.empty();
    const double k = kernel.count;
    const double unbiased = gathered.isFull ? (k - 1.0) / k : 1.0;
    density.perFlux = unbiased / std::max(under, floor > 0.0 ? floor : 1e-300);
    return density;
}

} // namespace lightloom
