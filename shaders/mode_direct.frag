// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Direct light of up to kMostLamps lamps with shadow maps. A preview: exact direct light is traced by `render`.
#include "shared_limits.glsl"
#include "common_shading.glsl"

struct SampleLight {
    vec4 position; // w: kind
    vec4 travel;   // unit, the way its light goes; w: cosine of the inner cone
    vec4 colour;   // cd, lux (sun) or cd/m2 (surface); w: cosine of the outer cone, or area of the surface sample, m2
    vec4 shadow;   // first layer (negative: no shadow), 1 if in cube maps, range of distance as in shadow.frag
    vec4 texel;    // x: side of a shadow texel, metres, at distance 1 (sun: anywhere); y: index of its matrix
};
layout(std140) uniform Lamps {
    SampleLight lights[kMostSampleLights];
    mat4 matrices[kMostLamps];
};
uniform int lightCount;
uniform sampler2DArrayShadow flatShadows, cubeShadows;
uniform mat3 cubeTurn;   // from the scene's axes to those of the cube maps
uniform float cubeScale; // part of a cube map's layer that its 90 degrees cover
uniform sampler2D gPosition, gNormal, gBase, gEmission;
uniform float emissionScale;
uniform vec3 eye;
uniform int showIlluminance; // 1: lux on the surface instead of radiance
uniform int mirrors;         // 1: environment maps are added, and show glowing surfaces themselves

out vec4 radiance;

const float kLeastFacing = 0.03; // cosine below which a surface may shade itself: it has hardly any light

// Face and place in a cube map whose six faces are layers: +X -X +Y -Y +Z -Z.
vec3 cubePlace(vec3 d)
{
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z) return vec3(vec2(d.x > 0.0 ? -d.z : d.z, -d.y) / a.x, d.x > 0.0 ? 0.0 : 1.0);
    if (a.y >= a.z) return vec3(vec2(d.x, d.y > 0.0 ? d.z : -d.z) / a.y, d.y > 0.0 ? 2.0 : 3.0);
    return vec3(vec2(d.z > 0.0 ? d.x : -d.x, -d.y) / a.z, d.z > 0.0 ? 4.0 : 5.0);
}

float shadowOf(SampleLight light, vec3 p, vec3 n, float along)
{
    if (light.shadow.x < 0.0) return 1.0;
    bool sun = int(light.position.w) == kLampSun;
    // Towards the light, as far as a surface that leans falls off across what is filtered: it must not shade itself
    // through the map's steps. Not along the normal: where light grazes, that would carry shadows' edges away.
    vec3 toLight = sun ? -light.travel.xyz : (light.position.xyz - p) / along;
    float texel = light.texel.x * (sun ? 1.0 : along), facing = max(dot(n, toLight), kLeastFacing);
    vec3 q = p + toLight * (texel * (0.3 + 1.8 * sqrt(max(1.0 - facing * facing, 0.0)) / facing));
    float measured = sun ? dot(q, light.travel.xyz) : length(q - light.position.xyz);
    float depth = (measured - light.shadow.z) * light.shadow.w;
    if (light.shadow.y > 0.5) {
        vec3 place = cubePlace(cubeTurn * (q - light.position.xyz));
        return texture(cubeShadows, vec4(0.5 + 0.5 * cubeScale * place.xy, light.shadow.x + place.z, depth));
    }
    vec4 clip = matrices[int(light.texel.y)] * vec4(q, 1.0);
    vec2 uv = 0.5 + 0.5 * clip.xy / clip.w;
    vec2 tap = 0.75 / vec2(textureSize(flatShadows, 0).xy);
    return 0.25 * (texture(flatShadows, vec4(uv + vec2(tap.x, tap.y), light.shadow.x, depth)) +
                   texture(flatShadows, vec4(uv + vec2(-tap.x, tap.y), light.shadow.x, depth)) +
                   texture(flatShadows, vec4(uv + vec2(tap.x, -tap.y), light.shadow.x, depth)) +
                   texture(flatShadows, vec4(uv + vec2(-tap.x, -tap.y), light.shadow.x, depth)));
}

// Direction to the light and illuminance on a plane that faces it (surface samples: on the receiver, over its cosine).
vec3 arriving(SampleLight light, vec3 p, vec3 n, out vec3 toLight, out float along)
{
    int kind = int(light.position.w);
    if (kind == kLampSun) {
        toLight = -light.travel.xyz;
        along = 0.0;
        return light.colour.xyz;
    }
    vec3 d = light.position.xyz - p;
    float squared = max(dot(d, d), 1e-12);
    along = sqrt(squared);
    toLight = d / along;
    if (kind == kLampSurface) {
        return light.colour.xyz * patchFactor(1.0, -dot(toLight, light.travel.xyz), squared, light.colour.w);
    }
    float cone = kind == kLampSpot ? spotFactor(-dot(toLight, light.travel.xyz), light.travel.w, light.colour.w) : 1.0;
    return light.colour.xyz * (cone / squared);
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(gPosition, at, 0);
    if (place.w < 0.5) discard;
    vec3 p = place.xyz;
    vec4 normal = texelFetch(gNormal, at, 0);
    vec4 base = texelFetch(gBase, at, 0);
    vec3 n = normal.xyz;
    vec3 toEye = normalize(eye - p);
    float alpha = normal.w * normal.w;
    vec4 emission = texelFetch(gEmission, at, 0);
    bool isMirrored = mirrors == 1 && emission.w > 0.5 && normal.w <= kMirrorsBelow;
    vec3 f0 = base.xyz * base.w;
    vec3 illuminance = vec3(0.0), glossy = vec3(0.0);
    for (int i = 0; i < lightCount; ++i) {
        vec3 toLight;
        float along;
        vec3 e = arriving(lights[i], p, n, toLight, along);
        float facing = dot(n, toLight);
        if (facing <= 0.0 || e.x + e.y + e.z <= 0.0) continue;
        e *= shadowOf(lights[i], p, n, along);
        illuminance += e * facing;
        if (isMirrored && int(lights[i].position.w) == kLampSurface) continue;
        if (base.w > 0.0) glossy += e * metalReflects(f0, max(alpha, 0.01), n, toLight, toEye);
    }
    if (showIlluminance == 1) {
        radiance = vec4(illuminance, 1.0);
        return;
    }
    vec3 glow = emission.xyz * emissionScale;
    radiance = vec4(lambert(base.xyz * (1.0 - base.w), illuminance) + glossy + glow, 1.0);
}
