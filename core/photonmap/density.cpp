// SPDX-License-Identifier: Apache-2.0
#include "core/photonmap/density.h"
#include "core/base/units.h"
#include "core/photonmap/least_keys.h"
#include "core/photonmap/photon_sums.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace lightloom {

namespace {
constexpr double kWidest = 2.0; ///< radii that K photons fill where they lie evenly
}

DensityKernel DensityKernel::of(const BakeParams& params, const PhotonMap& map, const SurfaceArea& area, float cellSize)
{
    DensityKernel kernel;
    // one photon gives no density: (K-1)/K would be zero
    kernel.count = static_cast<std::uint32_t>(std::max(params.gatherCount, 2));
    kernel.stretch = params.gatherKernel == GatherKernel::ellipsoid ? 3.0f : 1.0f;
    if (params.gatherFilter == Switch::off) kernel.leastCosine = -2.0f;
    kernel.areaFloor = 1e-8f * cellSize * cellSize;
    kernel.area = params.gatherArea;
    kernel.fit = params.gatherFit;
    kernel.adapts = params.gatherAdapt == Switch::on;
    if (params.gatherRadius > 0.0f) {
        kernel.cap = params.gatherRadius * cellSize;
    } else {
        const double photons = std::max<double>(1.0, static_cast<double>(map.size()));
        const double even = std::sqrt(kernel.count * area.total() / (std::numbers::pi * photons));
        kernel.cap = static_cast<float>(std::max(kWidest * even, static_cast<double>(cellSize)));
    }
    return kernel;
}

namespace {

constexpr double kFewest = 32.0;    ///< photons of the smallest kernel tried
constexpr double kDoubt = 4.0;      ///< standard errors that two kernels' estimates may differ by
constexpr double kLoneDoubt = 6.0;  ///< the same while there is one to compare with
constexpr double kLeastShare = 0.1; ///< of a variance that a difference always has
constexpr double kReserve = 3.0;    ///< times its expected square that a plane's difference has to stand up to
constexpr double kThinnest = 1e-3;  ///< least determinant, relative to the radius, of a plane fit
constexpr std::size_t kMostKernels = SurfaceArea::kMostRadii;

/// Nested kernels around one point: the first `counts[j]` photons lie within `radii[j]`.
struct Kernels {
    std::array<std::uint32_t, kMostKernels> counts{};
    std::array<float, kMostKernels> radii{};
    std::size_t size = 0;
    void add(std::size_t count, float radius)
    {
        counts[size] = static_cast<std::uint32_t>(count), radii[size] = radius;
        ++size;
    }
};

/// Orders the gathered photons so that each kernel holds the first of them.
Kernels nestedKernels(const DensityKernel& kernel, Gathered& gathered)
{
    Kernels kernels;
    const std::size_t all = gathered.keys.size();
    if (kernel.adapts) {
        const double fewest = std::max(kFewest, static_cast<double>(all) / 1024.0);
        for (double k = fewest; k < 0.9 * static_cast<double>(all) && kernels.size + 1 < kMostKernels; k *= 2.0)
            kernels.add(static_cast<std::size_t>(k), 0.0f);
        std::size_t left = all;
        for (std::size_t j = kernels.size; j-- > 0;) { // from the largest down: each leaves half to the next
            const std::uint64_t last = leastKey(gathered.keys.data(), left, kernels.counts[j], gathered.work);
            partAt(last, gathered.keys.data(), left, gathered.work);
            kernels.radii[j] = std::sqrt(squaredOf(last));
            left = kernels.counts[j];
        }
        for (std::size_t i = 0; i < all; ++i) gathered.photons[i] = static_cast<std::uint32_t>(gathered.keys[i]);
    }
    kernels.add(all, gathered.radius);
    return kernels;
}

/// Whether the estimate of an ever larger kernel still agrees with those of the smaller ones. Kernels are nested: if
/// the light is what the larger one says, the variance of a difference is the difference of the variances, and
/// variances go by the sums of squared weights. (Noise that each kernel states of itself will not do: where chance gave
/// it too few photons it also states too little noise, and 5 % of all light is lost.)
class Agreement {
public:
    /// `spread`: the integral over the kernel of the squared weight, 1/m2.
    [[nodiscard]] bool holds(double value, double noise, double spread)
    {
        std::size_t against = 0;
        const double doubt = size_ < 2 ? kLoneDoubt : kDoubt;
        for (std::size_t i = 0; i < size_; ++i) {
            const double apart = value - values_[i];
            const double variance = noise * noise * std::max(spreads_[i] / spread - 1.0, kLeastShare);
            if (apart * apart > doubt * doubt * variance) ++against;
        }
        // two, where there are as many: the smallest kernel alone may be a chance cluster of photons
        if (size_ > 0 && against >= std::min<std::size_t>(size_, 2)) return false;
        values_[size_] = value, spreads_[size_] = spread;
        ++size_;
        return true;
    }

private:
    std::array<double, kMostKernels> values_{}, spreads_{};
    std::size_t size_ = 0;
};

/// Weights of a linear estimate: w.x + w.y x + w.z y per photon, and the integral of their square over the kernel.
struct Weights {
    glm::dvec3 w;
    double spread = 0.0; ///< 1/m2
    glm::dvec3 slope;    ///< of the estimate over a photon's flux: other than `w` where the photons choose the weights
};

Weights meanWeights(const AreaMoments& m)
{
    const glm::dvec3 w(1.0 / m.area, 0.0, 0.0);
    return {w, w.x, w};
}

/// Of the value at the origin of the plane with the same moments; of the mean where the surface is too thin for one.
Weights planeWeights(const AreaMoments& m, double radius)
{
    const glm::dvec3 a(m.area, m.first.x, m.first.y);
    const glm::dvec3 cofactors(m.xx * m.yy - m.xy * m.xy, a.z * m.xy - a.y * m.yy, a.y * m.xy - a.z * m.xx);
    const double determinant = glm::dot(a, cofactors), r2 = radius * radius;
    if (!(determinant > kThinnest * m.area * m.area * m.area * r2 * r2)) return meanWeights(m);
    const glm::dvec3 w = cofactors / determinant;
    return {w, w.x, w};
}

/// The plane as far as the photons call for it, else the mean: in a corner a plane has 16 times the variance of a mean.
Weights fitted(const PhotonSums& sums, const AreaMoments& m, double radius, GatherFit fit)
{
    const Weights mean = meanWeights(m);
    if (fit == GatherFit::mean) return mean;
    const Weights plane = planeWeights(m, radius);
    const double apart = sums.value(plane.w) - sums.value(mean.w), noise = sums.noise(mean.w);
    const double expected = noise * noise * (plane.spread / mean.spread - 1.0); // of apart^2 where light is even
    const double share = apart * apart > 0.0 ? apart * apart / (apart * apart + kReserve * expected) : 0.0;
    const double slope = share * (3.0 - 2.0 * share); // of share * apart over apart
    return {glm::mix(mean.w, plane.w, share), glm::mix(mean.spread, plane.spread, share * share),
            glm::mix(mean.w, plane.w, slope)};
}

/// Those that can hide something within `radius` of the centre. Entries in folds have ten, most of them further off
/// than a kernel reaches.
Screens within(float radius, Screens screens, std::vector<Screen>& kept)
{
    kept.clear();
    for (const Screen& screen : screens) {
        if (screen.behind < radius) kept.push_back(screen);
    }
    return kept;
}

} // namespace

Density estimateDensity(const PhotonMap& map, const SurfaceArea& area, const DensityKernel& kernel, glm::vec3 p,
                        glm::vec3 n, Gathered& gathered, Screens screens)
{
    screens = within(kernel.cap, screens, gathered.screens);
    const GatherQuery query{p, n, kernel.cap, kernel.stretch, kernel.leastCosine, kernel.count, screens};
    map.gather(query, gathered);
    const Kernels kernels = nestedKernels(kernel, gathered);
    std::array<AreaMoments, kMostKernels> moments;
    const Screens near = within(gathered.radius, screens, gathered.nearScreens);
    const KernelPlace place{p, n, kernel.stretch, kernel.leastCosine, near};
    area.under(place, std::span(kernels.radii).first(kernels.size), std::span(moments).first(kernels.size));

    Density density;
    if (!(moments[kernels.size - 1].area > 0.0) && gathered.photons.empty()) return density;
    density.isAnswer = true;
    const double floor = std::max(static_cast<double>(kernel.areaFloor), 1e-300);
    PhotonSums sums(map, p, n);
    std::uint32_t taken = 0;
    Agreement agreement;
    for (std::size_t j = 0; j < kernels.size; ++j) {
        const std::uint32_t count = kernels.counts[j];
        sums.add(std::span(gathered.photons).subspan(taken, count - taken));
        AreaMoments m = moments[j];
        const auto radius = static_cast<double>(kernels.radii[j]);
        if (kernel.area == GatherArea::disc) m = momentsOfDisc(radius);
        const bool isDegenerate = !(m.area >= floor);
        if (isDegenerate) m = AreaMoments{floor, {}, 0.0, 0.0, 0.0};
        const bool isFull = j + 1 < kernels.size || gathered.isFull; // then the last photon gave the radius
        const double unbiased = isFull ? (count - 1.0) / count : 1.0;
        const Weights fit = fitted(sums, m, radius, kernel.fit);
        const glm::dvec3 lux = glm::max(unbiased * sums.lux(fit.w), glm::dvec3(0.0));
        const double noise = unbiased * sums.noise(fit.w);
        if (kernel.adapts && !agreement.holds(static_cast<double>(luminance(glm::vec3(lux))), noise, fit.spread)) break;
        taken = count;
        density.lux = lux, density.noise = unbiased * sums.noise(fit.slope), density.perFlux = unbiased / m.area;
        density.isDegenerate = isDegenerate && count > 0;
        gathered.radius = kernels.radii[j], gathered.isFull = isFull;
    }
    gathered.photons.resize(taken);
    return density;
}

} // namespace lightloom
