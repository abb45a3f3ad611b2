// SPDX-License-Identifier: Apache-2.0
#include "core/compare/false_colour.h"
#include "shaders/common.h"
#include <cmath>

namespace lightloom {
namespace {

/// Polynomials and rounding can step a hair outside the gamut.
glm::vec3 inGamut(glm::vec3 colour) { return glm::clamp(colour, 0.0f, 1.0f); }

} // namespace

glm::vec3 falseColour(float t) { return inGamut(shader::sequentialColour(std::isnan(t) ? 1.0f : t)); }

glm::vec3 differenceColour(float t) { return inGamut(shader::divergingColour(std::isnan(t) ? 1.0f : t)); }

float errorValue(ErrorKind kind, float value, float reference, float mean)
{
    const float d = value - reference;
    if (kind == ErrorKind::absolute) return std::abs(d);
    const float relative = mean > 0.0f ? d / mean : 0.0f;
    return kind == ErrorKind::relative ? std::abs(relative) : relative;
}

glm::vec3 errorColour(ErrorKind kind, float error, float top)
{
    return kind == ErrorKind::difference ? differenceColour(error / top) : falseColour(error / top);
}

} // namespace lightloom
