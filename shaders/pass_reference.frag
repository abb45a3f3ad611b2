// SPDX-License-Identifier: Apache-2.0
#version 330 core
// A picture that was made elsewhere for the same view, brought to the screen as the scene's own light is.
#include "shared_limits.glsl"
#include "common_colour.glsl"

uniform sampler2D picture; // radiance, rows from the top; black where there is nothing
uniform sampler2D covered; // the frame's own sum over samples; w: how many of them met a surface
uniform float samples;
uniform float scale; // exposure
uniform int tone;
uniform vec3 background; // encoded

in vec2 vScreen;
out vec4 colour;

void main()
{
    ivec2 size = textureSize(picture, 0);
    ivec2 at = clamp(ivec2(vec2(vScreen.x, 1.0 - vScreen.y) * vec2(size)), ivec2(0), size - 1);
    float share = clamp(texture(covered, vScreen).w / samples, 0.0, 1.0);
    vec3 lit = screenColour(texelFetch(picture, at, 0).xyz / max(share, 1e-3), scale, tone);
    colour = vec4(mix(background, lit, share), 1.0);
}
