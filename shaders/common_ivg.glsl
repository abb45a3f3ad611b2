// SPDX-License-Identifier: Apache-2.0
// Lookup in an irradiance grid's textures (core/ivg/grid_gpu.h), on values: the caller reads the texels. Places are in
// grid coordinates, in which vertices are where they are whole.

const float kGridBefore = 0.1f; // cells before a surface within which a vertex counts in part
const float kGridSlack = 0.05f; // cells, for walls that are not quite parallel to an axis
const float kGridBehind = 0.01f; // of what counts before a surface
const float kGridLean = 0.1f; // of a normal along an axis that is enough
const float kGridSightUnits = 127.5f; // of sight, a cell; 255: that far or more

// 1 where `excess` is below -width, 0 where it is above it.
SHARED float gridFade(float excess, float width)
{
    return min(max(0.5f - 0.5f * excess / width, 0.0f), 1.0f);
}

// Sight of a vertex, low byte the negative way, along an axis in which the surface lies `away` from it: 1 if nothing
// stands before it, 0 if a wall does.
SHARED float gridSightAlong(float away, uint sight)
{
    uint way = away > 0.0f ? sight >> 8u : sight & 255u;
    if (way >= 255u) return 1.0f;
    return gridFade(abs(away) - float(int(way)) / kGridSightUnits - kGridSlack, kGridSlack);
}

// What of a vertex counts from which the surface lies `away`, for walls between.
SHARED float gridSight(vec3 away, uvec3 sight)
{
    return gridSightAlong(away.x, sight.x) * gridSightAlong(away.y, sight.y) * gridSightAlong(away.z, sight.z);
}

// What of it counts where it lies just before the surface, whose normal in metres times cells is `side`; behind it,
// nothing.
SHARED float gridSide(vec3 away, vec3 side)
{
    return clamp(-dot(away, side) / (sqrt(dot(side, side)) * kGridBefore), 0.0f, 1.0f);
}

// How far a surface leans towards a vertex along an axis in which it lies `away`, if a wall is seen that way; 0: no wall.
SHARED float gridLeanAlong(float away, uint sight, float n)
{
    uint way = away > 0.0f ? sight >> 8u : sight & 255u;
    if (way >= 255u) return 0.0f;
    return away > 0.0f ? -n : n;
}

// How far a wall that a vertex sees faces it as the surface does: then it counts in part (kGridBehind) even where it lies
// behind the surface (CornerSide::leaning).
SHARED float gridLean(vec3 away, uvec3 sight, vec3 n)
{
    float lean = max(gridLeanAlong(away.x, sight.x, n.x),
                     max(gridLeanAlong(away.y, sight.y, n.y), gridLeanAlong(away.z, sight.z, n.z)));
    return clamp(lean / kGridLean, 0.0f, 1.0f);
}

// Part of a finer grid in the light at `p`: 0 outside its box, 1 where no face is nearer than `fade` (GridInside).
SHARED float gridInside(vec3 p, vec3 low, vec3 high, float fade)
{
    vec3 depth = min(p - low, high - p);
    return smoothstep(0.0f, fade, min(depth.x, min(depth.y, depth.z)));
}

// Cubic B-spline at t of the way from vertex 0 to 1, as two reads with linear filter (Sigg and Hadwiger 2005): where
// the first is read and its weight, where the second and its weight.
SHARED vec4 gridSplineReads(float t)
{
    float s = 1.0f - t;
    float w0 = s * s * s / 6.0f;
    float w1 = (3.0f * t * t * t - 6.0f * t * t + 4.0f) / 6.0f;
    float w3 = t * t * t / 6.0f;
    float low = w0 + w1;
    float high = 1.0f - low;
    return vec4(w1 / low - 1.0f, low, 1.0f + w3 / high, high);
}

// Catmull-Rom's weights of vertices -1, 0, 1, 2.
SHARED vec4 gridCatmullRom(float t)
{
    float tt = t * t;
    float ttt = tt * t;
    return vec4(0.5f * (2.0f * tt - ttt - t), 0.5f * (3.0f * ttt - 5.0f * tt + 2.0f),
                0.5f * (4.0f * tt - 3.0f * ttt + t), 0.5f * (ttt - tt));
}

// Remap `joined`: what harmonics say between the axes, from 18 numbers one after the other (their trust is e.z).
SHARED vec3 gridBetweenAxes(vec4 a, vec4 b, vec4 c, vec4 d, vec4 e, vec3 n)
{
    vec3 linear = n * (vec3(1.0f) - abs(n));
    return linear.x * vec3(a.x, a.y, a.z) + linear.y * vec3(a.w, b.x, b.y) + linear.z * vec3(b.z, b.w, c.x) +
           (n.x * n.y) * vec3(c.y, c.z, c.w) + (n.y * n.z) * vec3(d.x, d.y, d.z) + (n.z * n.x) * vec3(d.w, e.x, e.y);
}

// Remap `harmonic`: the last five of its nine terms, xy to 3 z2 - 1, from texels 3 to 6 (their trust is g.w).
SHARED vec3 gridSecondOrder(vec4 d, vec4 e, vec4 f, vec4 g, vec3 n)
{
    return (n.x * n.y) * vec3(d.x, d.y, d.z) + (n.y * n.z) * vec3(d.w, e.x, e.y) +
           (n.z * n.x) * vec3(e.z, e.w, f.x) + (n.x * n.x - n.y * n.y) * vec3(f.y, f.z, f.w) +
           (3.0f * n.z * n.z - 1.0f) * vec3(g.x, g.y, g.z);
}
// And the first four: 1, x, y, z.
SHARED vec3 gridFirstOrder(vec4 a, vec4 b, vec4 c, vec3 n)
{
    return vec3(a.x, a.y, a.z) + n.x * vec3(a.w, b.x, b.y) + n.y * vec3(b.z, b.w, c.x) + n.z * vec3(c.y, c.z, c.w);
}
