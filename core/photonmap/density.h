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
    float leastCosine = 0.5f;  ///< -2: normals are not looked at
    float areaFloor = 0.0f;    ///< m2; a kernel with less surface under it is degenerate
    GatherArea area = GatherArea::surface;
    GatherFit fit = GatherFit::plane;
    bool adapts = true; ///< K is the most; fewer where light changes within the kernel

    /// From the parameters: the cap is `gather.radius` cells, or automatic: twice the radius that K of the
    /// group's photons would fill if they lay evenly over all of the reached surface. A dark room then loses some
    /// photons of its K rather than the shape of its light.
    static DensityKernel of(const BakeParams& params, const PhotonMap& map, const SurfaceArea& area, float cellSize);
    bool operator==(const DensityKernel&) const = default;
};

/// What the photons near a point say.
struct Density {
    glm::dvec3 lux{0.0};   ///< illuminance at the point, never negative
    double noise = 0.0;    ///< standard error of its luminance, from the photons' own fluxes: they arrive like rain
    double perFlux = 0.0;  ///< 1/m2: mean density under the kernel is perFlux * sum of the gathered photons' flux
    bool isAnswer = false; ///< there is compatible surface under the kernel; false: nothing is known here
    bool isDegenerate = false;
};

/// Gathers at `p` for surfaces facing `n` (unit). Mean: E = (K-1)/K sum Phi / A, A the true area of compatible surface
/// under the kernel (METHODS section 2); with fewer than K photons within the cap, E = sum Phi / A(cap). Plane: the
/// value at `p` of the linear density whose integrals of 1 and x over that surface are those of the photons (local
/// linear estimation: Lejeune and Sarda 1992; exact moments from SurfaceArea), so that neither the end of a wall nor a
/// gradient shifts it. Adaptive: kernels of 32, 64, 128 ... K photons from the smallest up, until one contradicts two
/// smaller ones by more than their noise allows (Lepski 1991); `gathered` keeps the photons and the radius of the last
/// that did not. What `screens` hide counts neither as photons nor as surface.
[[nodiscard]] Density estimateDensity(const PhotonMap& map, const SurfaceArea& area, const DensityKernel& kernel,
                                      glm::vec3 p, glm::vec3 n, Gathered& gathered, Screens screens = {});

} // namespace lightloom
