// SPDX-License-Identifier: Apache-2.0
#include "core/compare/error_model.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr double kLeastPower = 0.2, kMostPower = 1.2; ///< of the kernel's blur; .3 (figure) to 1 (two_rooms) were seen
constexpr double kInterpolated = 4.0 / 9.0; ///< variance left after blending independent neighbours on a plane

double share(double v, double v0) { return (kInterpolated + v / v0) / (1.0 + v / v0); }

double v4(int depth, double ratio) { return depth > 0 ? ratio * std::pow(4.0, depth) : 1e9; }

/// A for a given v0, and how badly it fits: relative residuals, so that every setting counts alike.
struct NoiseFit {
    double noise = 0, misfit = std::numeric_limits<double>::infinity();
};
NoiseFit fitNoise(std::span<const ErrorSample> samples, double v0)
{
    // ln A with the spread of the samples as weights: noise is multiplicative
    double sum = 0, weights = 0;
    const auto logOf = [&](const ErrorSample& s) {
        return std::log(s.noise2 * (s.count - 1.0) / share(v4(s.depth, s.count / s.photons), v0));
    };
    const auto weightOf = [](const ErrorSample& s) {
        const double relative = std::max(s.noise2Sigma / s.noise2, 0.02);
        return 1.0 / (relative * relative);
    };
    for (const ErrorSample& s : samples) {
        if (!(s.noise2 > 0.0)) continue;
        sum += weightOf(s) * logOf(s);
        weights += weightOf(s);
    }
    if (!(weights > 0.0)) return {};
    const double mean = sum / weights;
    double misfit = std::pow(std::log(v0 / ErrorModel().overlap), 2); // v0 within a factor of e of what it usually is
    for (const ErrorSample& s : samples) {
        if (s.noise2 > 0.0) misfit += weightOf(s) * std::pow(logOf(s) - mean, 2);
    }
    return {std::exp(mean), misfit};
}

double cellPart(int depth, double m) { return depth > 0 ? std::pow(2.0, -m * (depth - 5)) : 0.0; }

/// How badly B and F fit, for powers p and m: squared residuals in standard errors, and distance from what is usual in
/// e-folds (p and m within one, B within two, F within three).
double misfitOf(std::span<const ErrorSample> samples, const ErrorModel& model)
{
    const auto efolds = [](double value, double usual, double width) {
        return std::pow(std::log(value / usual) / width, 2);
    };
    const ErrorModel usual;
    double misfit = efolds(model.kernelPower, usual.kernelPower, 1.0) + efolds(model.cellPower, usual.cellPower, 1.0) +
                    efolds(model.kernelBias, usual.kernelBias, 2.0) + efolds(model.cellBias, usual.cellBias, 3.0);
    for (const ErrorSample& s : samples) {
        const double foretold = model.bias2(s.depth, s.count, s.photons);
        // the formula itself is good to a fifth
        misfit += std::pow(foretold - s.bias2, 2) / (s.bias2Sigma * s.bias2Sigma + std::pow(0.2 * foretold, 2) + 1e-14);
    }
    return misfit;
}

/// Looks everywhere on a lattice of logarithms, then ever closer around the best.
void fitBias(std::span<const ErrorSample> samples, ErrorModel& model)
{
    std::array<double ErrorModel::*, 4> members{&ErrorModel::kernelBias, &ErrorModel::cellBias,
                                                &ErrorModel::kernelPower, &ErrorModel::cellPower};
    ErrorModel best = model;
    double least = std::numeric_limits<double>::infinity();
    for (const double p : {0.25, 0.4, 0.6, 1.0}) {
        for (const double m : {0.1, 0.5, 1.3, 2.5}) {
            for (double b = 1e-6; b < 1.0; b *= 2.0) {
                for (double f = 1e-8; f < 1.0; f *= 3.0) {
                    ErrorModel candidate = model;
                    candidate.kernelPower = p, candidate.cellPower = m;
                    candidate.kernelBias = b, candidate.cellBias = f;
                    const double misfit = misfitOf(samples, candidate);
                    if (misfit < least) least = misfit, best = candidate;
                }
            }
        }
    }
    for (double step = 1.5; step > 1.01; step = std::sqrt(step)) {
        for (int round = 0; round < 8; ++round) {
            for (const auto member : members) {
                for (const double factor : {step, 1.0 / step}) {
                    ErrorModel candidate = best;
                    candidate.*member *= factor;
                    const bool inRange = candidate.kernelPower >= kLeastPower && candidate.kernelPower <= kMostPower;
                    const double misfit = misfitOf(samples, candidate);
                    if (inRange && misfit < least) least = misfit, best = candidate;
                }
            }
        }
    }
    model = best;
}

} // namespace

ErrorModel ErrorModel::fit(std::span<const ErrorSample> samples)
{
    ErrorModel model;
    double least = std::numeric_limits<double>::infinity();
    for (double v0 = 0.03; v0 < 4.0; v0 *= 1.25) {
        const NoiseFit fit = fitNoise(samples, v0);
        if (!(fit.misfit < least)) continue;
        least = fit.misfit;
        model.noise = fit.noise;
        model.overlap = v0;
    }
    fitBias(samples, model);
    return model;
}

double ErrorModel::noise2(int depth, double count, double photons) const
{
    return noise * share(v4(depth, count / photons), overlap) / std::max(count - 1.0, 0.5);
}

double ErrorModel::bias2(int depth, double count, double photons) const
{
    const double kernel = kernelBias * std::pow(1000.0 * count / photons, kernelPower);
    return std::hypot(kernel, cellBias * cellPart(depth, cellPower));
}

double ErrorModel::error(int depth, double count, double photons) const
{
    return std::sqrt(noise2(depth, count, photons) + bias2(depth, count, photons));
}

} // namespace lightloom
