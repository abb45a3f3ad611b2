// SPDX-License-Identifier: Apache-2.0
#version 330 core
// One ring of dilation in an atlas: a texel that has no light yet gets the mean of its eight neighbours that have some
// and belong to the same chart. Same rule as `dilate` (core/atlas/lightmap.h).
uniform sampler2D light; // lux; w: 1 where there is some
uniform isampler2D owners;
uniform int size;

out vec4 filled;

void main()
{
    ivec2 p = ivec2(gl_FragCoord.xy);
    int own = texelFetch(owners, p, 0).x;
    if (own < 0 || texelFetch(light, p, 0).w > 0.5) discard;
    vec4 sum = vec4(0.0);
    for (int y = max(p.y - 1, 0); y <= min(p.y + 1, size - 1); ++y) {
        for (int x = max(p.x - 1, 0); x <= min(p.x + 1, size - 1); ++x) {
            vec4 there = texelFetch(light, ivec2(x, y), 0);
            if (there.w > 0.5 && texelFetch(owners, ivec2(x, y), 0).x == own) sum += vec4(there.xyz, 1.0);
        }
    }
    if (sum.w < 0.5) discard;
    filled = vec4(sum.xyz / sum.w, 1.0);
}
