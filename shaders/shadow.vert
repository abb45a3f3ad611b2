// SPDX-License-Identifier: Apache-2.0
#version 330 core
layout(location = 0) in vec3 aPosition;
layout(location = 2) in vec4 aUv;
layout(location = 3) in vec4 aColour;

uniform mat4 toWorld;
uniform mat4 viewProjection;

out vec3 vWorld;
out vec4 vUv;
out float vAlpha;

void main()
{
    vec4 world = toWorld * vec4(aPosition, 1.0);
    vWorld = world.xyz;
    vUv = aUv;
    vAlpha = aColour.w;
    gl_Position = viewProjection * world;
}
