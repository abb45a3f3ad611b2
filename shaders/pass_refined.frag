// SPDX-License-Identifier: Apache-2.0
#version 330 core
// What a picture's direct light is off a finer one.
uniform sampler2D fine, coarse; // sums over samples; w: how many of them met a surface
out vec4 difference;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 f = texelFetch(fine, at, 0), c = texelFetch(coarse, at, 0);
    bool isKnown = f.w > 0.5 && c.w > 0.5;
    difference = isKnown ? vec4(f.xyz / f.w - c.xyz / c.w, 1.0) : vec4(0.0);
}
