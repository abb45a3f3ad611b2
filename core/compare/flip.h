// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/compare/image_error.h"

namespace lightloom {

/// Where the picture is looked at: pixels per degree of visual angle. Default: a 0.7 m wide screen of 3840 pixels seen
/// from 0.7 m.
inline constexpr float kFlipPixelsPerDegree = 67.0206f;

/// FLIP for pictures of ordinary range (Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild: "FLIP: A
/// Difference Evaluator for Alternating Images", HPG 2020): the difference a viewer sees when two pictures are swapped
/// in place, 0 (none) to 1 (largest), per pixel. Inputs are linear Rec.709, clamped to [0,1]; sizes must match
/// (asserted). The figure for the whole picture is the mean over pixels. Swapping the pictures changes nothing.
/// About 1 s per megapixel on one thread.
[[nodiscard]] ScalarImage flipMap(const FloatImage& image, const FloatImage& reference,
                                  float pixelsPerDegree = kFlipPixelsPerDegree);

[[nodiscard]] double meanOf(const ScalarImage& map);

} // namespace lightloom
