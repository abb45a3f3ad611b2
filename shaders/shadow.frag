// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Distance from a lamp, linear, so that one bias fits near and far.
in vec3 vWorld;
in vec4 vUv;
in float vAlpha;

uniform vec4 lamp; // xyz: position, w: 1; sun: direction its light travels, w: 0
uniform vec2 range; // distance = (measured - range.x) * range.y

uniform vec4 baseColour;
uniform float alphaCutoff;
uniform mat3 baseUv;
uniform vec4 uvSets;
uniform sampler2D baseTexture;

void main()
{
    if (alphaCutoff >= 0.0) {
        vec2 uv = (baseUv * vec3(uvSets.x < 0.5 ? vUv.xy : vUv.zw, 1.0)).xy;
        if (baseColour.w * vAlpha * texture(baseTexture, uv).w < alphaCutoff) discard;
    }
    float measured = lamp.w > 0.5 ? length(vWorld - lamp.xyz) : dot(vWorld, lamp.xyz);
    gl_FragDepth = clamp((measured - range.x) * range.y, 0.0, 1.0);
}
