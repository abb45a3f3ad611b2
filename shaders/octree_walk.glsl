// SPDX-License-Identifier: Apache-2.0
// Lookup in a light octree's arrays (core/bake/gpu_layout.h): one text for pixels (mode_vdl.frag) and for the processor
// (core/bake/packed_octree.cpp), so that both give the same light. Whoever includes it brings
//   int depth, deepest; vec3 lowest; float cellSize, colourScale
//   int hasDirections: 0 no light has one, 1 all have, 2 all but the first of each entry
//   int classEnd(int lights): entries with at most as many lights, 0 to kMostVdls
//   uvec4 brickAt(ivec3 texel), vdlAt(int number), normalAt(int entry)
//   vec3 entryValue(int entry, vec3 n): what is asked of an entry, for octreeBlend
// and common_octree.glsl, common_vdl.glsl, shared_limits.glsl.

// First entry (x) and number of entries (y) of the leaf at `cell` of a level from `depth` on, and what it is (z); none:
// y = 0.
SHARED ivec3 leafAt(ivec3 cell, int level)
{
    if (!octreeHolds(cell, level)) return ivec3(0);
    ivec3 brick = ivec3(0);
    for (int l = 0; l < level; ++l) {
        uvec4 texel = brickAt(brickTexel(brick, octreeChild(cell, l, level)));
        bool isLast = l + 1 == level;
        int kind = isLast ? kOwnLeaf : kLargeLeaf;
        if (texelIsSplit(texel)) {
            kind = kSplitLeaf;
            texel = brickAt(brickTexel(texelBrick(texel), ivec3(isLast ? 0 : 1, 0, 0)));
        }
        if (!texelIsNode(texel)) return ivec3(texelAddress(texel), texelEntries(texel), kind);
        brick = texelBrick(texel);
    }
    return ivec3(0);
}

// Entry (x) of a leaf (leafAt) whose normal is nearest n, or -1 where none is compatible; one that is on the same side
// of a wall as the place, `fromMiddle` cells from the leaf's middle, if there is one (y = 0).
SHARED ivec2 entryFor(ivec3 leaf, vec3 n, vec3 fromMiddle)
{
    ivec2 best = ivec2(-1, 1);
    float bestCosine = kCompatible;
    for (int e = leaf.x; e < leaf.x + leaf.y; ++e) {
        uvec4 bytes = normalAt(e);
        vec3 normal = directionValue(bytes.x, bytes.y);
        float cosine = dot(normal, n);
        if (cosine <= kCompatible) continue;
        int beyond = isBeyondSide(normal, bytes.z, bytes.w, fromMiddle) ? 1 : 0;
        if (beyond < best.y || (beyond == best.y && cosine > bestCosine)) {
            bestCosine = cosine;
            best = ivec2(e, beyond);
        }
    }
    return best;
}

// First light (x) of an entry and how many it has room for (y). Entries are ordered by that number.
SHARED ivec2 lightsOf(int entry)
{
    int start = classEnd(0);
    int first = 0;
    if (entry < start) return ivec2(0);
    for (int lights = 1; lights < kMostVdls; ++lights) {
        int end = classEnd(lights);
        if (entry < end) return ivec2(first + (entry - start) * lights, lights);
        first += (end - start) * lights;
        start = end;
    }
    return ivec2(first + (entry - start) * kMostVdls, kMostVdls);
}

// Illuminance that an entry gives a surface facing n, in units of colourScale lux.
SHARED vec3 entryIlluminance(int entry, vec3 n)
{
    vec3 sum = vec3(0.0f);
    ivec2 lights = lightsOf(entry);
    for (int j = 0; j < lights.y; ++j) {
        uvec4 texel = vdlAt(lights.x + j);
        if ((texel.x | texel.y | texel.z) == 0u) break; // black ones come last
        vec3 colour = vec3(halfValue(texel.x), halfValue(texel.y), halfValue(texel.z));
        if (hasDirections == 0 || (hasDirections == 2 && j == 0)) {
            sum += colour;
            continue;
        }
        sum += vdlIlluminance(colour, directionValue(texel.w >> 8u, texel.w & 255u), n);
    }
    return sum;
}

// What entries around p give a surface facing n, entryValue blended, in its unit (w: weight of what answered, 0 where
// nothing does): the eight leaves around p, in each the entry nearest n, renormalised over those that answer. Then level
// by level where leaves are split: their children answer for their share, for the rest the level above.
SHARED vec4 octreeBlend(vec3 p, vec3 n)
{
    vec3 value = vec3(0.0f);
    float answered = 0.0f;
    float side = cellSize;
    for (int level = depth; level <= deepest; ++level) {
        vec3 at = octreePosition(p, lowest, side) - 0.5f;
        if (!(length(at) < 4e6f)) break; // far outside (or NaN) a cast to int would overflow
        ivec3 cell = ivec3(floor(at));
        vec3 part = at - floor(at);
        float weights = 0.0f;
        float above = 0.0f;
        vec3 sum = vec3(0.0f);
        bool isSplit = false;
        for (int i = 0; i < 8; ++i) {
            ivec3 corner = ivec3(i & 1, (i >> 1) & 1, (i >> 2) & 1);
            float weight = cornerWeight(part, corner);
            if (weight <= 0.0f) continue;
            ivec3 leaf = leafAt(cell + corner, level);
            if (leaf.z == kSplitLeaf) isSplit = true;
            ivec2 entry = entryFor(leaf, n, part - vec3(corner));
            if (entry.x < 0) continue;
            if (leaf.z == kLargeLeaf) {
                above += weight;
                continue;
            }
            if (entry.y == 1) weight *= kBeyondCounts;
            weights += weight;
            sum += weight * entryValue(entry.x, n);
        }
        if (weights <= 0.0f) break;
        value = (sum + above * value) / (weights + above);
        if (level == depth) answered = weights;
        if (!isSplit) break;
        side = 0.5f * side;
    }
    return vec4(value, answered);
}
