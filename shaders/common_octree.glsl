// SPDX-License-Identifier: Apache-2.0
// Descent through the light octree's bricks (core/bake/gpu_layout.h), on values: the caller reads the texels.

// What a descent to a cell of some level finds.
const int kOwnLeaf = 0;   // a leaf as deep as was asked for
const int kSplitLeaf = 1; // the same, and it has children
const int kLargeLeaf = 2; // less deep: it covers the cell, and is not split

// Position in cells of a lattice whose corner is `lowest`.
SHARED vec3 octreePosition(vec3 p, vec3 lowest, float cellSize)
{
    return (p - lowest) / cellSize;
}

// True if `cell` lies within an octree of `depth` levels.
SHARED bool octreeHolds(ivec3 cell, int depth)
{
    int most = (1 << depth) - 1;
    return min(cell.x, min(cell.y, cell.z)) >= 0 && max(cell.x, max(cell.y, cell.z)) <= most;
}

// Which of its eight children the node at `level` (root: 0) descends into on the way to `cell`: 0 or 1 per axis.
SHARED ivec3 octreeChild(ivec3 cell, int level, int depth)
{
    return (cell >> (depth - 1 - level)) & 1;
}

// Texel of a child in the brick texture.
SHARED ivec3 brickTexel(ivec3 brick, ivec3 child)
{
    return brick * 2 + child;
}

SHARED bool texelIsNode(uvec4 texel)
{
    return texel.w == 1u;
}

// True for a leaf that is split further: it points to a brick that holds the leaf itself at (0,0,0), and at (1,0,0) a
// node with its children.
SHARED bool texelIsSplit(uvec4 texel)
{
    return texel.w == 255u;
}

// Entries of a leaf; 0 for an empty texel, for a node and for a leaf that is split.
SHARED int texelEntries(uvec4 texel)
{
    return texel.w < 2u || texel.w == 255u ? 0 : int(texel.w) - 1;
}

// Brick that the texel of a node, or of a leaf that is split, points to.
SHARED ivec3 texelBrick(uvec4 texel)
{
    return ivec3(int(texel.x), int(texel.y), int(texel.z));
}

// Number of a leaf's first entry: 24 bits, lowest byte first.
SHARED int texelAddress(uvec4 texel)
{
    return int(texel.x) + 256 * int(texel.y) + 65536 * int(texel.z);
}

// Texel `number` of a list that is stored row by row.
SHARED ivec2 rowTexel(int number, int width)
{
    return ivec2(number % width, number / width);
}

const float kSideSteps = 88.0f; // of an entry's side, a cell

// Unit direction in the plane of a surface facing n, in 256ths of a turn.
SHARED vec3 sideDirection(vec3 n, uint angle)
{
    vec3 t = normalize(cross(abs(n.x) < 0.6f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f), n));
    float a = float(int(angle)) * (6.28318531f / 256.0f);
    return cos(a) * t + sin(a) * cross(n, t);
}

// Whether an entry with that side (core/octree/entry_side.h), facing n, does not know the light `fromMiddle` cells from
// the middle of its leaf: a wall stands between.
SHARED bool isBeyondSide(vec3 n, uint angle, uint least, vec3 fromMiddle)
{
    return least != 0u && kSideSteps * dot(sideDirection(n, angle), fromMiddle) < float(int(least)) - 128.0f;
}

// Trilinear weight of a corner (0 or 1 per axis) at `fraction` of the way.
SHARED float cornerWeight(vec3 fraction, ivec3 corner)
{
    float x = corner.x == 0 ? 1.0f - fraction.x : fraction.x;
    float y = corner.y == 0 ? 1.0f - fraction.y : fraction.y;
    float z = corner.z == 0 ? 1.0f - fraction.z : fraction.z;
    return x * y * z;
}
