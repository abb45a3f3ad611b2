// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/bake/render_view.h"
#include "core/compare/image_error.h"

namespace lightloom {

/// How far the indirect light of a picture is off a reference of the same camera and size.
struct ViewError {
    ErrorMetrics metrics; ///< of the radiance: what `lightloom-cli compare` gives for the two as files
    double noise = 0;     ///< of the reference, in the units of relRmse; at most, for its standard errors are of direct
                          ///< light too
    ErrorKind kind = ErrorKind::relative;
    ScalarImage map;  ///< absolute: lux; else fractions of the mean of the reference's indirect radiance
    float top = 1.0f; ///< end of a legend that suits the map
};

/// `reflectance` (`mattReflectance`; needed for absolute errors only) turns radiance into illuminance; where it has a
/// dark channel (gloss, black, nothing seen) an absolute error is not known, and 0 in the map. Error: sizes differ,
/// something is not finite, or the reference is black and the picture is not.
[[nodiscard]] Result<ViewError> viewError(const View& picture, const View& reference, ErrorKind kind,
                                          const FloatImage& reflectance = {});

/// Radiance of indirect light to the illuminance (lux) of the surfaces that reflect it; black where not known.
[[nodiscard]] FloatImage illuminanceOf(const FloatImage& radiance, const FloatImage& reflectance);

/// Root mean square of a picture's standard errors over its mean, of luminances: what is left of noise.
[[nodiscard]] double pictureNoise(const View& view);

} // namespace lightloom
