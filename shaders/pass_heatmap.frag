// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Numbers in false colour; exposure and tone curve do not touch them.
#include "shared_limits.glsl"
#include "common_colour.glsl"
#include "common_false_colour.glsl"

uniform sampler2D numbers; // one a pixel, rows from the top
uniform float top;         // end of the legend
uniform int isSigned;

in vec2 vScreen;
out vec4 colour;

void main()
{
    ivec2 size = textureSize(numbers, 0);
    ivec2 at = clamp(ivec2(vec2(vScreen.x, 1.0 - vScreen.y) * vec2(size)), ivec2(0), size - 1);
    float t = texelFetch(numbers, at, 0).x / top;
    vec3 linear = clamp(isSigned != 0 ? divergingColour(t) : sequentialColour(t), 0.0, 1.0);
    colour = vec4(srgbEncode(linear.x), srgbEncode(linear.y), srgbEncode(linear.z), 1.0);
}
