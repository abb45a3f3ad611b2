// SPDX-License-Identifier: Apache-2.0
#version 330 core
// From summed radiance to the screen.
#include "shared_limits.glsl"
#include "common_colour.glsl"

uniform sampler2D picture; // sum over samples; w: how many of them met a surface
uniform float samples;
uniform sampler2D refinement; // to be added to the mean
uniform float refined;        // share of it, 0 to 1
uniform float scale; // exposure
uniform int tone;
uniform vec3 background; // encoded

in vec2 vScreen;
out vec4 colour;

void main()
{
    vec4 sum = texture(picture, vScreen);
    vec3 mean = sum.xyz / max(sum.w, 1e-6);
    if (refined > 0.0) mean = max(mean + refined * texture(refinement, vScreen).xyz, vec3(0.0));
    vec3 lit = screenColour(mean, scale, tone);
    colour = vec4(mix(background, lit, clamp(sum.w / samples, 0.0, 1.0)), 1.0);
}
