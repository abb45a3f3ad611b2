// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Indirect light from a light octree (core/bake/gpu_layout.h): the eight leaves around a point, in each the entry
// nearest the receiver's normal, renormalised over the leaves that answer. Same rule as LightOctree::lookup.
#include "shared_limits.glsl"
#include "common_octree.glsl"
#include "common_shading.glsl"
#include "common_vdl.glsl"

uniform usampler3D bricks;
uniform usampler2D vdls, normals;
uniform int depth;
uniform int vdlCount;
uniform int vdlWidth, normalWidth;
uniform vec3 lowest;
uniform float cellSize;
uniform float colourScale;
uniform sampler2D gPosition, gNormal, gBase;
uniform vec3 eye;
uniform int showIlluminance; // 1: lux on the surface instead of radiance

out vec4 radiance;

// First entry (x) and number of entries (y) of the leaf at `cell`; none: y = 0.
ivec2 leafAt(ivec3 cell)
{
    if (!octreeHolds(cell, depth)) return ivec2(0);
    ivec3 brick = ivec3(0);
    for (int level = 0; level < depth; ++level) {
        uvec4 texel = texelFetch(bricks, brickTexel(brick, octreeChild(cell, level, depth)), 0);
        if (!texelIsNode(texel)) return ivec2(texelAddress(texel), texelEntries(texel));
        brick = texelBrick(texel);
    }
    return ivec2(0);
}

// Entry whose normal is nearest n, or -1 where none is compatible.
int entryFor(ivec2 leaf, vec3 n)
{
    int best = -1;
    float bestCosine = kCompatible;
    for (int e = leaf.x; e < leaf.x + leaf.y; ++e) {
        uvec4 bytes = texelFetch(normals, rowTexel(e, normalWidth), 0);
        float cosine = dot(directionValue(bytes.x, bytes.y), n);
        if (cosine > bestCosine) {
            bestCosine = cosine;
            best = e;
        }
    }
    return best;
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(gPosition, pixel, 0);
    if (place.w < 0.5) discard;
    vec4 normal = texelFetch(gNormal, pixel, 0);
    vec4 base = texelFetch(gBase, pixel, 0);
    vec3 n = normal.xyz;
    vec3 toEye = normalize(eye - place.xyz);
    vec3 f0 = base.xyz * base.w;
    float alpha = max(normal.w * normal.w, kLeastGloss);

    vec3 at = octreePosition(place.xyz, lowest, cellSize) - 0.5;
    ivec3 cell = ivec3(floor(at));
    vec3 part = at - floor(at);
    float weights = 0.0;
    vec3 illuminance = vec3(0.0), glossy = vec3(0.0);
    for (int i = 0; i < 8; ++i) {
        ivec3 corner = ivec3(i & 1, (i >> 1) & 1, (i >> 2) & 1);
        float weight = cornerWeight(part, corner);
        if (weight <= 0.0) continue;
        ivec2 leaf = leafAt(cell + corner);
        if (leaf.y == 0) continue;
        int entry = entryFor(leaf, n);
        if (entry < 0) continue;
        weights += weight;
        for (int j = 0; j < vdlCount; ++j) {
            uvec4 texel = texelFetch(vdls, rowTexel(entry * vdlCount + j, vdlWidth), 0);
            if ((texel.x | texel.y | texel.z) == 0u) continue;
            vec3 colour = vec3(halfValue(texel.x), halfValue(texel.y), halfValue(texel.z)) * weight;
            vec3 toLight = directionValue(texel.w >> 8u, texel.w & 255u);
            illuminance += vdlIlluminance(colour, toLight, n);
            if (base.w > 0.0) glossy += colour * metalReflects(f0, alpha, n, toLight, toEye);
        }
    }
    if (weights <= 0.0) discard; // no entry near: the picture shows direct light only
    float scale = colourScale / weights;
    if (showIlluminance == 1) {
        radiance = vec4(illuminance * scale, 1.0);
    } else {
        radiance = vec4((lambert(base.xyz * (1.0 - base.w), illuminance) + glossy) * scale, 1.0);
    }
}
