// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <glm/glm.hpp>

/// Numbers as colours, linear Rec.709. The maps themselves stand in shaders/common_false_colour.glsl, so that the
/// window's heatmap has the same colours as a file's.
namespace lightloom {

/// Colour of an amount `t` in [0,1] (clamped; NaN counts as 1): dark indigo over rose to pale yellow. Equal steps of t
/// are equal steps in CIELAB, lightness rises all the way: readable in grey and with any colour blindness.
[[nodiscard]] glm::vec3 falseColour(float t);

/// Colour of a difference `t` in [-1,1] (clamped; NaN counts as 1): blue below, white at 0, red above; -t and t are
/// equally far from white.
[[nodiscard]] glm::vec3 differenceColour(float t);

/// What a heatmap shows of each value v against its reference r, m being the mean of the reference.
enum class ErrorKind {
    relative,   ///< |v - r| / m
    absolute,   ///< |v - r|, in the values' own unit
    difference, ///< (v - r) / m, signed
};

/// One value of a heatmap. Zero where the mean is not positive and the kind divides by it.
[[nodiscard]] float errorValue(ErrorKind kind, float value, float reference, float mean);

/// Its colour in a legend that ends at `top` (above 0): `falseColour`, for differences `differenceColour`.
[[nodiscard]] glm::vec3 errorColour(ErrorKind kind, float error, float top);

} // namespace lightloom
