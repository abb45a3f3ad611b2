// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Lines and dots over the picture, already as wide on the screen as they shall be.
layout(location = 0) in vec4 aClip;
layout(location = 1) in vec3 aWorld;
layout(location = 2) in vec4 aColour;

out vec3 vWorld;
out vec4 vColour;

void main()
{
    vWorld = aWorld;
    vColour = aColour;
    gl_Position = aClip;
}
