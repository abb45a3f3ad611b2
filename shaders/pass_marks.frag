// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Marks over the picture; what lies behind a surface is faint.
uniform sampler2D gPosition; // of the picture, which may be smaller than the window
uniform vec3 eye;
uniform vec2 window;

in vec3 vWorld;
in vec4 vColour;
out vec4 colour;

void main()
{
    ivec2 size = textureSize(gPosition, 0);
    vec4 surface = texelFetch(gPosition, clamp(ivec2(gl_FragCoord.xy / window * vec2(size)), ivec2(0), size - 1), 0);
    float here = length(vWorld - eye);
    // marks lie on surfaces: half a per cent nearer counts as before
    bool isHidden = surface.w > 0.5 && length(surface.xyz - eye) < 0.995 * here;
    // a little below white: a blend of bytes may be rounded up twice, and Mesa's rasteriser then wraps to black
    colour = vec4(0.97 * vColour.xyz, vColour.w * (isHidden ? 0.3 : 1.0));
}
