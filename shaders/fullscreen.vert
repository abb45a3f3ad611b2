// SPDX-License-Identifier: Apache-2.0
#version 330 core
// One triangle that covers the viewport; no vertex data.
out vec2 vScreen; // 0 to 1

void main()
{
    vec2 corner = vec2(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID & 2) * 2) - 1.0);
    vScreen = 0.5 * corner + 0.5;
    gl_Position = vec4(corner, 0.0, 1.0);
}
