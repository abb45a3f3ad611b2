// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/image.h"
#include "core/base/result.h"
#include "core/compare/false_colour.h"
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

/// How far a result is off a reference. Values are luminances (of the indirect part, unless the caller says otherwise);
/// all figures are fractions: .05 is five percent.
namespace lightloom {

/// With d = E - Eref and m = mean(Eref) over all values (METHODS, head):
struct ErrorMetrics {
    std::uint64_t count = 0;
    double meanReference = 0; ///< m, in the values' own unit
    double relRmse = 0;       ///< sqrt(mean(d^2)) / m
    double bias = 0;          ///< mean(d) / m
    double mae = 0;           ///< mean(|d|) / m
    double p95 = 0;           ///< 95th percentile of |d| / m (nearest rank)
    double max = 0;           ///< largest |d| / m
    double perPoint = 0;      ///< sqrt(mean((d / max(Eref, .01 m))^2)): sees dark rooms, which relRmse hides
};

/// Errors: lengths differ, nothing to compare, a value that is not finite (named by its number), a negative or black
/// reference. Two black results are equal: all figures 0.
[[nodiscard]] Result<ErrorMetrics> measureError(std::span<const double> values, std::span<const double> reference);

/// An Error that names the first value that is not finite: "value 7 of the reference is not a finite number".
[[nodiscard]] Result<Done> checkFinite(std::span<const double> values, std::string_view whose);

[[nodiscard]] std::vector<double> luminances(std::span<const glm::vec3> colours);

/// Noise of a reference in the units of relRmse: sqrt(mean(s^2)) / m, s the luminance of the standard errors. Channels
/// are taken as fully correlated, so the true figure is at most this.
[[nodiscard]] double relativeNoise(std::span<const glm::vec3> standardErrors, double meanReference);

/// One number per pixel, row 0 at the top.
struct ScalarImage {
    int width = 0, height = 0;
    std::vector<float> values;
};

/// `errorValue` of the luminances, per pixel; sizes must match (asserted).
[[nodiscard]] ScalarImage errorMap(const FloatImage& image, const FloatImage& reference, double meanReference,
                                   ErrorKind kind);

} // namespace lightloom
