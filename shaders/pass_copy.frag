// SPDX-License-Identifier: Apache-2.0
#version 330 core
// One picture, to be added to the sum of those that are averaged; w: 1 where there is a surface.
uniform sampler2D picture, gPosition;
out vec4 colour;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    colour = vec4(texelFetch(picture, at, 0).xyz, texelFetch(gPosition, at, 0).w);
}
