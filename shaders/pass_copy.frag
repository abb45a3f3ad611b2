// SPDX-License-Identifier: Apache-2.0
#version 330 core
// One picture, to be added to the sum of those that are averaged.
uniform sampler2D picture;
out vec4 colour;

void main()
{
    colour = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
}
