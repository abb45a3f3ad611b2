// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Indirect light from an irradiance grid (core/ivg/grid_gpu.h). Same rule as IrradianceGrid::lookup. Whoever links it
// defines
//   FILTER         0 trilinear: eight vertices, those before the surface that see it; 1 B-spline: eight reads with
//                  linear filter; 2 Catmull-Rom: 64 vertices
//   SIDE_TEXELS    per direction: 1 one colour; 2 compressed, lengths and direction; 3 vectors; 0 none
//   SHARED_TEXELS  5 terms between the axes, 7 all harmonics, 0 none
//   SLOPES         1: light goes on to the surface by slopes
//   NESTED         1: a finer grid within a box, which fades into the outer one
#include "shared_limits.glsl"
#include "common_ivg.glsl"
#include "common_shading.glsl"

struct Grid {
    ivec3 slabs, cells;
    vec3 lowest, cellSize;
    float scale;
};
uniform Grid outer;
uniform sampler3D outerLight, outerPlaces;
uniform usampler3D outerSight;
#if NESTED == 1
uniform Grid inner;
uniform sampler3D innerLight, innerPlaces;
uniform usampler3D innerSight;
uniform vec3 boxLow, boxHigh;
uniform float fade;
// 1, and not known to compilers: what loops so often is skipped where no pixel around needs it. Of an `if` Mesa's
// software rasteriser runs both sides everywhere, which took 2.05 x the outer grid's time instead of 1.4.
uniform int once;
#endif
uniform float offset; // cells along the normal
uniform sampler2D gPosition, gNormal, gBase, gEmission;
uniform int showIlluminance; // 1: lux on the surface instead of radiance
uniform int mirrors;         // 1: environment maps are added, for metals that have one

out vec4 radiance;

const float kLeastKnown = 0.005; // of trilinear weights: less comes from round a corner
const float kLeastKnownThere = 0.003; // the same at the surface itself
const float kLeastCubic = 0.5;   // of Catmull-Rom's weights that must find a value

// Each of a few numbers in turn. As loops they would stay loops inside those over vertices, at twice the time (Mesa).
#define TO_2(DO) DO(0) DO(1) DO(2)
#define TO_5(DO) TO_2(DO) DO(3) DO(4) DO(5)
#define TO_8(DO) TO_5(DO) DO(6) DO(7) DO(8)
#if SIDE_TEXELS == 1
#define EACH_SIDE(DO) TO_2(DO)
#elif SIDE_TEXELS == 2
#define EACH_SIDE(DO) TO_5(DO)
#elif SIDE_TEXELS == 3
#define EACH_SIDE(DO) TO_8(DO)
#else
#define EACH_SIDE(DO)
#endif
#if SHARED_TEXELS == 5
#define EACH_SHARED(DO) TO_2(DO) DO(3) DO(4)
#elif SHARED_TEXELS == 7
#define EACH_SHARED(DO) TO_5(DO) DO(6)
#else
#define EACH_SHARED(DO)
#endif
#if SLOPES == 1
#define EACH_SLOPE(DO) TO_2(DO)
#else
#define EACH_SLOPE(DO)
#endif

// Where the slabs begin that a surface of this normal reads, and weighted sums over what is read of them.
#if SIDE_TEXELS > 0
ivec3 sideSlab[3 * SIDE_TEXELS];
vec4 sideSum[3 * SIDE_TEXELS];
#endif
#if SHARED_TEXELS > 0
ivec3 sharedSlab[SHARED_TEXELS];
vec4 sharedSum[SHARED_TEXELS];
#endif
#if SLOPES == 1
ivec3 slopeSlab[3];
vec3 slopeSum[3];
vec3 placeSum; // by axis: trust times vertex number
#endif

ivec3 slab(Grid grid, int number)
{
    ivec3 slabs = grid.slabs;
    return ivec3(number % slabs.x, number / slabs.x % slabs.y, number / (slabs.x * slabs.y)) * (grid.cells + 1);
}

void chooseSlabs(Grid grid, vec3 n)
{
    ivec3 side = ivec3(0, 2, 4) + ivec3(greaterThanEqual(n, vec3(0.0)));
#if SIDE_TEXELS > 0
    for (int axis = 0; axis < 3; ++axis) {
        for (int j = 0; j < SIDE_TEXELS; ++j) sideSlab[axis * SIDE_TEXELS + j] = slab(grid, side[axis] * SIDE_TEXELS + j);
    }
#endif
#if SHARED_TEXELS > 0
    for (int i = 0; i < SHARED_TEXELS; ++i) sharedSlab[i] = slab(grid, 6 * SIDE_TEXELS + i);
#endif
#if SLOPES == 1
    for (int axis = 0; axis < 3; ++axis) slopeSlab[axis] = slab(grid, 6 * SIDE_TEXELS + SHARED_TEXELS + side[axis]);
#endif
}

void clearSums()
{
#define CLEAR_SIDE(i) sideSum[i] = vec4(0.0);
#define CLEAR_SHARED(i) sharedSum[i] = vec4(0.0);
#define CLEAR_SLOPE(i) slopeSum[i] = vec3(0.0); placeSum[i] = 0.0;
    EACH_SIDE(CLEAR_SIDE)
    EACH_SHARED(CLEAR_SHARED)
    EACH_SLOPE(CLEAR_SLOPE)
}

#if FILTER == 1
vec3 perTexel;

vec4 readAt(sampler3D light, ivec3 slab, vec3 at)
{
    return texture(light, (vec3(slab) + at + 0.5) * perTexel);
}

// `at` lies among the slab's own texels, so that a filter takes none of another's.
void add(Grid grid, sampler3D light, sampler3D places, vec3 at, float weight)
{
    at = clamp(at, vec3(0.0), vec3(grid.cells));
#define ADD_SIDE(i) sideSum[i] += weight * readAt(light, sideSlab[i], at);
#define ADD_SHARED(i) sharedSum[i] += weight * readAt(light, sharedSlab[i], at);
#define ADD_SLOPE(i) slopeSum[i] += weight * readAt(light, slopeSlab[i], at).xyz;
    EACH_SIDE(ADD_SIDE)
    EACH_SHARED(ADD_SHARED)
    EACH_SLOPE(ADD_SLOPE)
#if SLOPES == 1
    placeSum += weight * texture(places, (at + 0.5) / vec3(grid.cells + 1)).xyz;
#endif
}
#else
#if SLOPES == 1
void addAxis(sampler3D light, int axis, ivec3 vertex, float weight)
{
    vec4 texel = weight * texelFetch(light, sideSlab[axis] + vertex, 0);
    sideSum[axis] += texel;
    placeSum[axis] += texel.w * float(vertex[axis]);
    slopeSum[axis] += weight * texelFetch(light, slopeSlab[axis] + vertex, 0).xyz;
}
#endif

void add(sampler3D light, ivec3 vertex, float weight)
{
#define ADD_SIDE(i) sideSum[i] += weight * texelFetch(light, sideSlab[i] + vertex, 0);
#define ADD_SHARED(i) sharedSum[i] += weight * texelFetch(light, sharedSlab[i] + vertex, 0);
#define ADD_SLOPE(i) addAxis(light, i, vertex, weight);
#if SLOPES == 1
    EACH_SLOPE(ADD_SLOPE)
#else
    EACH_SIDE(ADD_SIDE)
#endif
    EACH_SHARED(ADD_SHARED)
}
#endif

// Irradiance in units of the grid's scale from the sums (w: 1), or nothing (w: 0).
vec4 blended(vec3 surface, vec3 n)
{
    vec3 sum = vec3(0.0), correction = vec3(0.0);
    float share = 0.0; // of the whole that is known
    float least = FILTER == 2 ? kLeastCubic : 0.0;
#if SIDE_TEXELS > 0
    for (int axis = 0; axis < 3; ++axis) {
        float weight = sideSum[axis * SIDE_TEXELS].w;
        if (!(weight > least)) continue;
        float square = n[axis] * n[axis];
        share += square;
#if SIDE_TEXELS == 1
        vec3 value = sideSum[axis].xyz;
#if SLOPES == 1
        value += (surface[axis] - placeSum[axis] / weight) * slopeSum[axis];
#endif
#elif SIDE_TEXELS == 2
        vec3 value = sideSum[2 * axis].xyz * (dot(sideSum[2 * axis + 1].xyz, n) / weight);
#else
        vec3 value = sideSum[3 * axis].xyz * n.x + sideSum[3 * axis + 1].xyz * n.y + sideSum[3 * axis + 2].xyz * n.z;
#endif
        sum += square * value / weight;
    }
#endif
#if SHARED_TEXELS == 5
    if (sharedSum[4].z > least) {
        correction = gridBetweenAxes(sharedSum[0], sharedSum[1], sharedSum[2], sharedSum[3], sharedSum[4], n) /
                     sharedSum[4].z;
    }
#elif SHARED_TEXELS == 7
    if (sharedSum[6].w > least) {
        share = 1.0;
        sum = (gridFirstOrder(sharedSum[0], sharedSum[1], sharedSum[2], n) +
               gridSecondOrder(sharedSum[3], sharedSum[4], sharedSum[5], sharedSum[6], n)) /
              sharedSum[6].w;
    }
#endif
    if (share <= 0.0) return vec4(0.0);
    return vec4(max(sum / share + correction, vec3(0.0)), 1.0);
}

vec3 lookupPlace(Grid grid, vec3 surface, vec3 n, float cellsAlong)
{
    vec3 inGrid = n / grid.cellSize; // a cell along n is a step of length 1 in grid coordinates
    return surface + inGrid * (cellsAlong / length(inGrid));
}

#if FILTER == 0
// Sums up the vertices around `at` that are before the surface and from which no wall hides it, where `mayLean` also
// those behind that see a wall which faces them as the surface does. Gives how far a lookup may rest on them.
float addCorners(Grid grid, sampler3D light, usampler3D sight, vec3 at, vec3 surface, vec3 n, bool mayLean)
{
    vec3 inside = clamp(at, vec3(0.0), vec3(grid.cells));
    ivec3 cell = min(ivec3(inside), grid.cells - 1);
    vec3 part = inside - vec3(cell);
    vec3 side = n * grid.cellSize;
    float known = 0.0;
    clearSums();
    for (int k = 0; k < 8; ++k) {
        ivec3 corner = ivec3(k & 1, (k >> 1) & 1, k >> 2);
        vec3 near = mix(1.0 - part, part, vec3(corner));
        float weight = near.x * near.y * near.z;
        ivec3 vertex = cell + corner;
        uvec4 seen = texelFetch(sight, vertex, 0);
        if (weight <= 0.0 || seen.w == 0u) continue;
        vec3 away = surface - vec3(vertex);
        float before = gridSide(away, side);
        float leans = mayLean ? gridLean(away, seen.xyz, n) : 0.0;
        weight *= gridSight(away, seen.xyz);
        known += weight * max(before, leans);
        weight *= max(before, kGridBehind * leans);
        if (weight > 0.0) add(light, vertex, weight);
    }
    return known;
}
#endif

// Lux (w: 1), or nothing (w: 0).
vec4 lookup(Grid grid, sampler3D light, usampler3D sight, sampler3D places, vec3 p, vec3 n)
{
    vec3 surface = (p - grid.lowest) / grid.cellSize;
    if (any(lessThan(surface, vec3(-1.0))) || any(greaterThan(surface, vec3(grid.cells + 1)))) return vec4(0.0);
    chooseSlabs(grid, n);
    vec3 at = lookupPlace(grid, surface, n, offset);
#if FILTER == 0
    // in a gap or a corner, nearer vertices may be the only ones
    if (addCorners(grid, light, sight, at, surface, n, false) <= kLeastKnown &&
        addCorners(grid, light, sight, surface, surface, n, true) <= kLeastKnownThere)
        return vec4(0.0);
#else
    vec3 inside = clamp(at, vec3(0.0), vec3(grid.cells));
    ivec3 cell = min(ivec3(inside), grid.cells - 1);
    vec3 part = inside - vec3(cell);
    clearSums();
#if FILTER == 1
    perTexel = 1.0 / vec3(grid.slabs * (grid.cells + 1));
    vec4 x = gridSplineReads(part.x), y = gridSplineReads(part.y), z = gridSplineReads(part.z);
    for (int k = 0; k < 8; ++k) {
        vec2 ax = (k & 1) == 0 ? x.xy : x.zw;
        vec2 ay = (k & 2) == 0 ? y.xy : y.zw;
        vec2 az = (k & 4) == 0 ? z.xy : z.zw;
        add(grid, light, places, vec3(cell) + vec3(ax.x, ay.x, az.x), ax.y * ay.y * az.y);
    }
#else
    vec4 x = gridCatmullRom(part.x), y = gridCatmullRom(part.y), z = gridCatmullRom(part.z);
    for (int k = 0; k < 64; ++k) {
        ivec3 step = ivec3(k & 3, (k >> 2) & 3, k >> 4);
        add(light, clamp(cell + step - 1, ivec3(0), grid.cells), x[step.x] * y[step.y] * z[step.z]);
    }
#endif
#endif
    return blended(surface, n) * vec4(vec3(grid.scale), 1.0);
}

// Same rule as IrradianceGrid::lookup.
vec4 nestedLookup(vec3 p, vec3 n)
{
#if NESTED == 1
    float part = gridInside(p, boxLow, boxHigh, fade);
    vec4 fine = vec4(0.0), coarse = vec4(0.0);
    for (int i = 0; i < once && part > 0.0; ++i) fine = lookup(inner, innerLight, innerSight, innerPlaces, p, n);
    bool isAll = fine.w > 0.0 && part >= 1.0;
    for (int i = 0; i < once && !isAll; ++i) coarse = lookup(outer, outerLight, outerSight, outerPlaces, p, n);
    if (isAll) return fine;
    if (fine.w <= 0.0) return coarse;
    return coarse.w > 0.0 ? mix(coarse, fine, part) : fine;
#else
    return lookup(outer, outerLight, outerSight, outerPlaces, p, n);
#endif
}

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(gPosition, pixel, 0);
    if (place.w < 0.5) discard;
    vec4 normal = texelFetch(gNormal, pixel, 0);
    vec4 base = texelFetch(gBase, pixel, 0);
    vec4 found = nestedLookup(place.xyz, normal.xyz);
    if (found.w <= 0.0) discard; // in a gap that has no vertex: the picture shows direct light only
    // a grid has too few directions for a gloss: metals without a map of their own are lit like matt paint
    bool isMirrored = mirrors == 1 && normal.w <= kMirrorsBelow && texelFetch(gEmission, pixel, 0).w > 0.5;
    float metal = isMirrored ? base.w : 0.0;
    radiance = vec4(showIlluminance == 1 ? found.xyz : lambert(base.xyz * (1.0 - metal), found.xyz), 1.0);
}
