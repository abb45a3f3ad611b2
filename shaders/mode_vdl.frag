// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Indirect light from a light octree (core/bake/gpu_layout.h). Same rule as LightOctree::lookup.
#include "shared_limits.glsl"
#include "common_octree.glsl"
#include "common_shading.glsl"
#include "common_vdl.glsl"

uniform usampler3D bricks;
uniform usampler2D vdls, normals;
uniform int depth;
uniform int vdlCount;
uniform int hasDirections;
uniform int vdlWidth, normalWidth;
uniform vec3 lowest;
uniform float cellSize;
uniform float colourScale;
uniform sampler2D gPosition, gNormal, gBase, gEmission;
uniform vec3 eye;
uniform int showIlluminance; // 1: lux on the surface instead of radiance
uniform int mirrors;         // 1: environment maps are added, for metals that have one

out vec4 radiance;

uvec4 brickAt(ivec3 texel)
{
    return texelFetch(bricks, texel, 0);
}

uvec4 vdlAt(int number)
{
    return texelFetch(vdls, rowTexel(number, vdlWidth), 0);
}

uvec2 normalAt(int entry)
{
    return texelFetch(normals, rowTexel(entry, normalWidth), 0).xy;
}

#include "octree_walk.glsl"

// What a metal sends to the eye of the virtual lights around p, cd/m2.
vec3 glossyRadiance(vec3 p, vec3 n, vec3 f0, float alpha, vec3 toEye)
{
    vec3 at = octreePosition(p, lowest, cellSize) - 0.5;
    ivec3 cell = ivec3(floor(at));
    vec3 part = at - floor(at);
    float weights = 0.0;
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 8; ++i) {
        ivec3 corner = ivec3(i & 1, (i >> 1) & 1, (i >> 2) & 1);
        float weight = cornerWeight(part, corner);
        if (weight <= 0.0) continue;
        int entry = entryFor(cell + corner, n);
        if (entry < 0) continue;
        weights += weight;
        for (int j = 0; j < vdlCount; ++j) {
            uvec4 texel = vdlAt(entry * vdlCount + j);
            if ((texel.x | texel.y | texel.z) == 0u) break;
            vec3 colour = vec3(halfValue(texel.x), halfValue(texel.y), halfValue(texel.z)) * weight;
            sum += colour * metalReflects(f0, alpha, n, directionValue(texel.w >> 8u, texel.w & 255u), toEye);
        }
    }
    return weights > 0.0 ? sum * (colourScale / weights) : vec3(0.0);
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(gPosition, pixel, 0);
    if (place.w < 0.5) discard;
    vec4 normal = texelFetch(gNormal, pixel, 0);
    vec4 base = texelFetch(gBase, pixel, 0);
    vec3 n = normal.xyz;
    vec4 light = octreeIlluminance(place.xyz, n);
    if (light.w <= 0.0) discard; // no entry near: the picture shows direct light only
    if (showIlluminance == 1) {
        radiance = vec4(light.xyz, 1.0);
        return;
    }
    bool isMirrored = mirrors == 1 && normal.w <= kMirrorsBelow && texelFetch(gEmission, pixel, 0).w > 0.5;
    // a colour octree has nothing that a gloss could mirror: other metals are lit like matt paint
    float metal = hasDirections == 1 || isMirrored ? base.w : 0.0;
    vec3 glossy = vec3(0.0);
    if (metal > 0.0 && !isMirrored) {
        vec3 toEye = normalize(eye - place.xyz);
        glossy = glossyRadiance(place.xyz, n, base.xyz * metal, max(normal.w * normal.w, kLeastGloss), toEye);
    }
    radiance = vec4(lambert(base.xyz * (1.0 - metal), light.xyz) + glossy, 1.0);
}
