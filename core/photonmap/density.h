// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/params/bake_params.h"
#include "core/photonmap/photon_map.h"
#include "core/photonmap/surface_area.h"

namespace lightloom {

/// How a gather is shaped for one light group.
struct DensityKernel {
    std::uint32_t count = 100; ///< K, at least 2
    float cap = 1.0f;          ///< largest radius, metres
    float stretch = 1.0f;      ///< 3 for the ellipsoid
    float leastCosine = 0.5f;
    float areaFloor = 0.0f; ///< m2; a kernel with less surface under it is degenerate

    /// From the parameters: the cap is `gather.radius` cells, or automatic: three times the radius that K of the
    /// group's photons would fill if they lay evenly over all of the reached surface. A dark room then loses some
    /// photons of its K rather than the shape of its light.
    static DensityKernel of(const BakeParams& params, const PhotonMap& map, const SurfaceArea& area, float cellSize);
};

/// Photons near a point, and what each is worth.
struct Density {
    double perFlux = 0.0;  ///< 1/m2: E = perFlux * sum of the photons' flux. (K-1)/K / area where K were found
    bool isAnswer = false; ///< there is compatible surface under the kernel; false: nothing is known here
    bool isDegenerate = false;
};

/// Gathers at `p` for surfaces facing `n` (unit). E = (K-1)/K sum Phi / A, A the true area of compatible surface under
/// the kernel (METHODS section 2); with fewer than K photons within the cap, E = sum Phi / A(cap).
[[nodiscard]] Density estimateDensity(const PhotonMap& map, const SurfaceArea& area, const DensityKernel& kernel,
                                      glm::vec3 p, glm::vec3 n, Gathered& gathered);

} // namespace lightloom
