// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Vertices of a lattice as dots, in the order of their numbers.
layout(location = 0) in vec4 aColour; // as shown; w 0: not at all

uniform mat4 viewProjection;
uniform int first; // number of the lattice's own first
uniform vec3 lowest, cellSize;
uniform ivec3 vertices; // along each axis
uniform vec3 size;      // pixels at a distance of one metre, at least, at most

out vec3 vWorld;
out vec4 vColour;

void main()
{
    int i = gl_VertexID - first;
    ivec3 vertex = ivec3(i % vertices.x, i / vertices.x % vertices.y, i / (vertices.x * vertices.y));
    vWorld = lowest + vec3(vertex) * cellSize;
    vColour = aColour;
    gl_Position = aColour.w > 0.0 ? viewProjection * vec4(vWorld, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = clamp(size.x / max(gl_Position.w, 1e-6), size.y, size.z);
}
