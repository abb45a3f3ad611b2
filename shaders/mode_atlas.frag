// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Indirect light from a lightmap: one texture read per pixel. Only the surface that the G-buffer shows at a pixel gets
// light; what lies behind it is told by its position, since its depth was made from other numbers.
#include "shared_limits.glsl"
#include "common_shading.glsl"
in vec3 vWorld;
in vec2 vUv;

uniform sampler2D gPosition, gNormal, gBase, gEmission;
uniform sampler2D lightmap; // lux
uniform vec3 eye;
uniform int showIlluminance; // 1: lux on the surface instead of radiance
uniform int mirrors;         // 1: environment maps are added, for metals that have one

out vec4 radiance;

const float kSamePlace = 2e-5; // of the distance to the eye

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(gPosition, pixel, 0);
    if (place.w < 0.5 || distance(place.xyz, vWorld) > kSamePlace * distance(place.xyz, eye)) discard;
    vec3 lux = texture(lightmap, vUv).xyz;
    vec4 base = texelFetch(gBase, pixel, 0);
    // a lightmap has nothing that a gloss could mirror: metals without a map of their own are lit like matt paint
    float metal = 0.0;
    if (base.w > 0.0 && mirrors == 1 && texelFetch(gEmission, pixel, 0).w > 0.5 &&
        texelFetch(gNormal, pixel, 0).w <= kMirrorsBelow) {
        metal = base.w;
    }
    radiance = vec4(showIlluminance == 1 ? lux : lambert(base.xyz * (1.0 - metal), lux), 1.0);
}
