// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Discs on surfaces, a square each; the fragment shader rounds it.
layout(location = 0) in vec4 aCentre; // w: radius, metres
layout(location = 1) in vec3 aNormal;
layout(location = 2) in vec4 aColour; // as shown

uniform mat4 viewProjection;
uniform vec3 eye;

out vec3 vWorld;
out vec2 vCorner; // of the square, from -1 to 1
out vec4 vColour;

void main()
{
    vCorner = vec2(gl_VertexID % 2, gl_VertexID / 2) * 2.0 - 1.0;
    vec3 aside = abs(aNormal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    vec3 u = normalize(cross(aNormal, aside)), v = cross(aNormal, u);
    vWorld = aCentre.xyz + aCentre.w * (vCorner.x * u + vCorner.y * v);
    vColour = aColour;
    bool isFacing = dot(aNormal, eye - aCentre.xyz) > 0.0;
    gl_Position = isFacing ? viewProjection * vec4(vWorld, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
