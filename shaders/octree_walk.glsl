// SPDX-License-Identifier: Apache-2.0
// Lookup in a light octree's arrays (core/bake/gpu_layout.h): one text for pixels (mode_vdl.frag) and for the processor
// (core/bake/packed_octree.cpp), so that both give the same light. Whoever includes it brings
//   int depth, vdlCount, hasDirections; vec3 lowest; float cellSize, colourScale
//   uvec4 brickAt(ivec3 texel), vdlAt(int number); uvec2 normalAt(int entry)
// and common_octree.glsl, common_vdl.glsl, shared_limits.glsl.

// First entry (x) and number of entries (y) of the leaf at `cell`; none: y = 0.
SHARED ivec2 leafAt(ivec3 cell)
{
    if (!octreeHolds(cell, depth)) return ivec2(0);
    ivec3 brick = ivec3(0);
    for (int level = 0; level < depth; ++level) {
        uvec4 texel = brickAt(brickTexel(brick, octreeChild(cell, level, depth)));
        if (!texelIsNode(texel)) return ivec2(texelAddress(texel), texelEntries(texel));
        brick = texelBrick(texel);
    }
    return ivec2(0);
}

// Entry of the leaf at `cell` whose normal is nearest n, or -1 where none is compatible.
SHARED int entryFor(ivec3 cell, vec3 n)
{
    ivec2 leaf = leafAt(cell);
    int best = -1;
    float bestCosine = kCompatible;
    for (int e = leaf.x; e < leaf.x + leaf.y; ++e) {
        uvec2 bytes = normalAt(e);
        float cosine = dot(directionValue(bytes.x, bytes.y), n);
        if (cosine > bestCosine) {
            bestCosine = cosine;
            best = e;
        }
    }
    return best;
}

// Illuminance that an entry gives a surface facing n, in units of colourScale lux.
SHARED vec3 entryIlluminance(int entry, vec3 n)
{
    vec3 sum = vec3(0.0f);
    for (int j = 0; j < vdlCount; ++j) {
        uvec4 texel = vdlAt(entry * vdlCount + j);
        if ((texel.x | texel.y | texel.z) == 0u) break; // black ones come last
        vec3 colour = vec3(halfValue(texel.x), halfValue(texel.y), halfValue(texel.z));
        if (hasDirections == 0) return colour;
        sum += vdlIlluminance(colour, directionValue(texel.w >> 8u, texel.w & 255u), n);
    }
    return sum;
}

// Lux at p on a surface facing n: the eight leaves around p, in each the entry nearest n, renormalised over the leaves
// that answer (w: their weight, 0 where there is none).
SHARED vec4 octreeIlluminance(vec3 p, vec3 n)
{
    vec3 at = octreePosition(p, lowest, cellSize) - 0.5f;
    if (!(length(at) < 4e6f)) return vec4(0.0f); // far outside (or NaN) a cast to int would overflow
    ivec3 cell = ivec3(floor(at));
    vec3 part = at - floor(at);
    float weights = 0.0f;
    vec3 sum = vec3(0.0f);
    for (int i = 0; i < 8; ++i) {
        ivec3 corner = ivec3(i & 1, (i >> 1) & 1, (i >> 2) & 1);
        float weight = cornerWeight(part, corner);
        if (weight <= 0.0f) continue;
        int entry = entryFor(cell + corner, n);
        if (entry < 0) continue;
        weights += weight;
        sum += weight * entryIlluminance(entry, n);
    }
    return weights > 0.0f ? vec4(sum * (colourScale / weights), weights) : vec4(0.0f);
}
