// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Indirect light from a lightmap: one texture read per pixel. Only the surface that the G-buffer shows at a pixel gets
// light; what lies behind it is told by its position, since its depth was made from other numbers.
#include "common_shading.glsl"
in vec3 vWorld;
in vec2 vUv;

uniform sampler2D gPosition, gBase;
uniform sampler2D lightmap; // lux
uniform vec3 eye;
uniform int showIlluminance; // 1: lux on the surface instead of radiance

out vec4 radiance;

const float kSamePlace = 2e-5; // of the distance to the eye

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(gPosition, pixel, 0);
    if (place.w < 0.5 || distance(place.xyz, vWorld) > kSamePlace * distance(place.xyz, eye)) discard;
    vec3 lux = texture(lightmap, vUv).xyz;
    vec4 base = texelFetch(gBase, pixel, 0);
    radiance = vec4(showIlluminance == 1 ? lux : lambert(base.xyz * (1.0 - base.w), lux), 1.0);
}
