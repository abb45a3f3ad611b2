// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

/// What a bake's error will be, foretold from a small one (docs/decisions/007).
namespace lightloom {

/// Error of one small bake with K = `count` of `photons` per group at an octree depth (0: no octree). Squares, relative
/// to the square of the mean; sigmas are standard errors of the estimates.
struct ErrorSample {
    int depth = 0;
    double count = 0, photons = 0;
    double noise2 = 0, noise2Sigma = 0;
    double bias2 = 0, bias2Sigma = 0; ///< an unbiased estimate, so it may be negative
};

/// relRMSE^2 = noise^2 + bias^2 with
///   noise^2 = A g(v) / (K - 1),  g(v) = (4/9 + v/v0) / (1 + v/v0),  v = K/N 4^depth
///   bias^2  = sqrt((B (1000 K/N)^p)^2 + (F 2^(-m (depth - 5)))^2)
/// K photons of N fill a kernel of an area that goes with K/N. Noise falls as 1/K; interpolation between leaves evens
/// out up to 5/9 of it where kernels are smaller than leaves (v small), and nothing where neighbours share their
/// photons. Bias is blur: of the kernel (B; p = 2 where light changes smoothly, less at shadow edges and creases) and
/// of the cells (F). Both keep their value at the same K/N, however many photons there are: that is what lets few
/// photons foretell many.
class ErrorModel {
public:
    /// Least squares over the samples, held near usual values where they say little (few samples, or all at one depth).
    [[nodiscard]] static ErrorModel fit(std::span<const ErrorSample> samples);

    [[nodiscard]] double noise2(int depth, double count, double photons) const;
    [[nodiscard]] double bias2(int depth, double count, double photons) const;
    [[nodiscard]] double error(int depth, double count, double photons) const; ///< relRMSE

    double noise = 1.3, overlap = 0.6;             ///< A and v0
    double kernelBias = 0.0016, kernelPower = 0.6; ///< B and p
    double cellBias = 0.001, cellPower = 1.3;      ///< F and m
};

} // namespace lightloom
