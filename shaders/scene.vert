// SPDX-License-Identifier: Apache-2.0
#version 330 core
// One instance of a mesh into the G-buffer.
layout(location = 0) in vec3 aPosition;
layout(location = 1) in vec3 aNormal;
layout(location = 2) in vec4 aUv; // set 0, set 1
layout(location = 3) in vec4 aColour;

uniform mat4 toWorld;
uniform mat3 normalToWorld;
uniform mat4 viewProjection;

out vec3 vWorld;
out vec3 vNormal;
out vec4 vUv;
out vec4 vColour;

void main()
{
    vec4 world = toWorld * vec4(aPosition, 1.0);
    vWorld = world.xyz;
    vNormal = normalToWorld * aNormal;
    vUv = aUv;
    vColour = aColour;
    gl_Position = viewProjection * world;
}
