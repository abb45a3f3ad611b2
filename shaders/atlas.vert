// SPDX-License-Identifier: Apache-2.0
#version 330 core
// A side of a triangle and its place in the atlas.
layout(location = 0) in vec3 aPosition; // scene space
layout(location = 1) in vec2 aUv;

uniform mat4 viewProjection;

out vec3 vWorld;
out vec2 vUv;

void main()
{
    vWorld = aPosition;
    vUv = aUv;
    gl_Position = viewProjection * vec4(aPosition, 1.0);
}
