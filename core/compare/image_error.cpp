// SPDX-License-Identifier: Apache-2.0
#include "core/compare/image_error.h"
#include "core/base/units.h"
#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {
namespace {

double meanOf(std::span<const double> values)
{
    double sum = 0;
    for (const double v : values) sum += v;
    return sum / static_cast<double>(values.size());
}

} // namespace

Result<Done> checkFinite(std::span<const double> values, std::string_view whose)
{
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i])) continue;
        return Error{Error::Kind::badInput, fmt::format("value {} of the {} is not a finite number", i + 1, whose)};
    }
    return Done{};
}

Result<ErrorMetrics> measureError(std::span<const double> values, std::span<const double> reference)
{
    if (values.size() != reference.size()) {
        return Error{Error::Kind::badInput, fmt::format("{} values cannot be compared with a reference of {}",
                                                        values.size(), reference.size())};
    }
    if (values.empty()) return Error{Error::Kind::badInput, "there is nothing to compare"};
    if (const Result<Done> fine = checkFinite(values, "result"); !fine) return fine.error();
    if (const Result<Done> fine = checkFinite(reference, "reference"); !fine) return fine.error();

    ErrorMetrics m;
    m.count = values.size();
    m.meanReference = meanOf(reference);
    if (m.meanReference == 0.0 && std::ranges::all_of(values, [](double v) { return v == 0.0; }) &&
        std::ranges::all_of(reference, [](double v) { return v == 0.0; })) {
        return m;
    }
    if (!(m.meanReference > 0.0)) {
        return Error{Error::Kind::badInput,
                     fmt::format("the reference's mean is {}, so a relative error has no meaning", m.meanReference)};
    }
    std::vector<double> sizes;
    sizes.reserve(values.size());
    double squares = 0, sum = 0, absolute = 0, pointSquares = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double d = values[i] - reference[i], relative = d / std::max(reference[i], 0.01 * m.meanReference);
        squares += d * d;
        sum += d;
        absolute += std::abs(d);
        pointSquares += relative * relative;
        sizes.push_back(std::abs(d) / m.meanReference);
    }
    const auto n = static_cast<double>(values.size());
    m.relRmse = std::sqrt(squares / n) / m.meanReference;
    m.bias = sum / n / m.meanReference;
    m.mae = absolute / n / m.meanReference;
    m.perPoint = std::sqrt(pointSquares / n);
    m.max = std::ranges::max(sizes);
    const auto rank = static_cast<std::ptrdiff_t>(std::ceil(0.95 * n)) - 1;
    std::nth_element(sizes.begin(), sizes.begin() + rank, sizes.end());
    m.p95 = sizes[static_cast<std::size_t>(rank)];
    return m;
}

std::vector<double> luminances(std::span<const glm::vec3> colours)
{
    std::vector<double> values;
    values.reserve(colours.size());
    for (const glm::vec3& c : colours) {
        values.push_back(double{kLumaR} * double{c.x} + double{kLumaG} * double{c.y} + double{kLumaB} * double{c.z});
    }
    return values;
}

double relativeNoise(std::span<const glm::vec3> standardErrors, double meanReference)
{
    if (standardErrors.empty() || !(meanReference > 0.0)) return 0.0;
    double squares = 0;
    for (const double s : luminances(standardErrors)) squares += s * s;
    return std::sqrt(squares / static_cast<double>(standardErrors.size())) / meanReference;
}

ScalarImage errorMap(const FloatImage& image, const FloatImage& reference, double meanReference, ErrorKind kind)
{
    assert(image.isSameSize(reference));
    ScalarImage map{image.width, image.height, {}};
    map.values.reserve(image.pixels.size());
    const auto mean = static_cast<float>(meanReference);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        map.values.push_back(errorValue(kind, luminance(image.pixels[i]), luminance(reference.pixels[i]), mean));
    }
    return map;
}

} // namespace lightloom
