// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Discs that stand for the surface in a cell; those that other surfaces hide are not drawn.
uniform sampler2D gPosition; // of the picture, which may be smaller than the window
uniform vec3 eye;
uniform vec2 window;
uniform float cellSize; // metres

in vec3 vWorld;
in vec2 vCorner;
in vec4 vColour;
out vec4 colour;

void main()
{
    float from = dot(vCorner, vCorner); // squared, of the radius
    if (from > 1.0) discard;
    ivec2 size = textureSize(gPosition, 0);
    vec4 surface = texelFetch(gPosition, clamp(ivec2(gl_FragCoord.xy / window * vec2(size)), ivec2(0), size - 1), 0);
    // a disc lies somewhere in its cell, and not where its surface is
    if (surface.w > 0.5 && length(surface.xyz - eye) < length(vWorld - eye) - cellSize) discard;
    vec3 shown = from > 0.8 ? 0.7 * vColour.xyz : vColour.xyz; // a rim, or those of a wall would run together
    // a little below white: a blend of bytes may be rounded up twice, and Mesa's rasteriser then wraps to black
    colour = vec4(0.97 * shown, 0.92);
}
