// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Indirect light from a light octree (core/bake/gpu_layout.h). Same rule as LightOctree::lookup.
#include "shared_limits.glsl"
#include "common_octree.glsl"
#include "common_shading.glsl"
#include "common_vdl.glsl"

uniform usampler3D bricks;
uniform usampler2D vdls, normals;
uniform int depth, deepest;
uniform int classEnds[9]; // kMostVdls + 1
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

uvec4 normalAt(int entry)
{
    return texelFetch(normals, rowTexel(entry, normalWidth), 0);
}

int classEnd(int lights)
{
    return classEnds[lights];
}

vec3 entryValue(int entry, vec3 n);
#include "octree_walk.glsl"

// What a metal at the pixel sends to the eye, instead of the illuminance on it.
bool isGlossAsked = false;
vec3 metalF0, toEye;
float metalAlpha;

// cd/m2 in units of colourScale, of the virtual lights of an entry
vec3 entryGloss(int entry, vec3 n)
{
    vec3 sum = vec3(0.0);
    ivec2 lights = lightsOf(entry);
    for (int j = 0; j < lights.y; ++j) {
        uvec4 texel = vdlAt(lights.x + j);
        if ((texel.x | texel.y | texel.z) == 0u) break;
        vec3 colour = vec3(halfValue(texel.x), halfValue(texel.y), halfValue(texel.z));
        sum += colour * metalReflects(metalF0, metalAlpha, n, directionValue(texel.w >> 8u, texel.w & 255u), toEye);
    }
    return sum;
}

vec3 entryValue(int entry, vec3 n)
{
    return isGlossAsked ? entryGloss(entry, n) : entryIlluminance(entry, n);
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(gPosition, pixel, 0);
    if (place.w < 0.5) discard;
    vec4 normal = texelFetch(gNormal, pixel, 0);
    vec4 base = texelFetch(gBase, pixel, 0);
    vec3 n = normal.xyz;
    vec4 light = octreeBlend(place.xyz, n);
    if (light.w <= 0.0) discard; // no entry near: the picture shows direct light only
    light.xyz *= colourScale;
    if (showIlluminance == 1) {
        radiance = vec4(light.xyz, 1.0);
        return;
    }
    bool isMirrored = mirrors == 1 && normal.w <= kMirrorsBelow && texelFetch(gEmission, pixel, 0).w > 0.5;
    // a colour octree has nothing that a gloss could mirror, and voxels' lights stand for half of their light: other
    // metals are lit like matt paint
    float metal = hasDirections == 1 || isMirrored ? base.w : 0.0;
    vec3 glossy = vec3(0.0);
    if (metal > 0.0 && !isMirrored) {
        isGlossAsked = true;
        toEye = normalize(eye - place.xyz);
        metalF0 = base.xyz * metal;
        metalAlpha = max(normal.w * normal.w, kLeastGloss);
        glossy = octreeBlend(place.xyz, n).xyz * colourScale;
    }
    radiance = vec4(lambert(base.xyz * (1.0 - metal), light.xyz) + glossy, 1.0);
}
