// SPDX-License-Identifier: Apache-2.0
#include "core/compare/view_error.h"
#include "core/base/units.h"
#include "core/compare/legend.h"
#include <algorithm>
#include <cassert>
#include <fmt/format.h>

namespace lightloom {

namespace {
constexpr float kLeastReflectance = 1e-3f; ///< below it a channel's illuminance cannot be told from its radiance
}

Result<ViewError> viewError(const View& picture, const View& reference, ErrorKind kind, const FloatImage& reflectance)
{
    const FloatImage &a = picture.indirect, &b = reference.indirect;
    if (!a.isSameSize(b)) {
        return Error{Error::Kind::badInput,
                     fmt::format("a picture of {} x {} pixels cannot be compared with a reference of {} x {}", a.width,
                                 a.height, b.width, b.height)};
    }
    const Result<ErrorMetrics> metrics = measureError(luminances(a.pixels), luminances(b.pixels));
    if (!metrics) return metrics.error();
    ViewError error;
    error.metrics = *metrics;
    error.noise = relativeNoise(reference.standardError.pixels, metrics->meanReference);
    error.kind = kind;
    error.map = kind == ErrorKind::absolute
                    ? errorMap(illuminanceOf(a, reflectance), illuminanceOf(b, reflectance), 1.0, kind)
                    : errorMap(a, b, metrics->meanReference, kind);
    error.top = legendTop(error.map);
    return error;
}

FloatImage illuminanceOf(const FloatImage& radiance, const FloatImage& reflectance)
{
    assert(radiance.isSameSize(reflectance));
    FloatImage lux(radiance.width, radiance.height);
    for (std::size_t i = 0; i < lux.pixels.size(); ++i) {
        const glm::vec3 share = reflectance.pixels[i];
        if (std::min({share.x, share.y, share.z}) < kLeastReflectance) continue;
        lux.pixels[i] = kPi * radiance.pixels[i] / share;
    }
    return lux;
}

double pictureNoise(const View& view)
{
    double mean = 0.0;
    for (const double l : luminances(wholeView(view).pixels)) mean += l;
    return relativeNoise(view.standardError.pixels, mean / static_cast<double>(view.direct.pixels.size()));
}

} // namespace lightloom
