// SPDX-License-Identifier: Apache-2.0
#version 330 core
// What a sheet of glass leaves of the light behind it: the picture is multiplied by it. It bends and mirrors nothing.
in vec3 vWorld;
in vec3 vNormal;
in vec4 vUv;
in vec4 vColour;

uniform vec4 baseColour;
uniform vec3 glass; // share that is clear, index, 1 if thin
uniform float alphaCutoff;
uniform mat3 baseUv;
uniform vec4 uvSets;
uniform sampler2D baseTexture;
uniform sampler2D gPosition;
uniform vec3 eye;
uniform float nearer; // metres that glass must lie before a surface to count

out vec4 through;

// Fresnel's reflectance from outside; glass is seen through from the back as from the front.
float fresnel(float cosine, float index)
{
    float sine2 = (1.0 - cosine * cosine) / (index * index);
    if (!(index > 0.0) || sine2 >= 1.0) return 1.0;
    float beyond = sqrt(1.0 - sine2);
    float across = (cosine - index * beyond) / (cosine + index * beyond);
    float along = (index * cosine - beyond) / (index * cosine + beyond);
    return 0.5 * (across * across + along * along);
}

void main()
{
    vec4 place = texelFetch(gPosition, ivec2(gl_FragCoord.xy), 0);
    vec3 toEye = eye - vWorld;
    if (place.w > 0.5 && length(eye - place.xyz) < length(toEye) - nearer) discard;
    vec2 uv = (baseUv * vec3(uvSets.x < 0.5 ? vUv.xy : vUv.zw, 1.0)).xy;
    vec4 base = baseColour * vColour * texture(baseTexture, uv);
    if (base.w < alphaCutoff) discard;
    float f = fresnel(min(1.0, abs(dot(normalize(vNormal), normalize(toEye)))), glass.y);
    vec3 tint = clamp(base.xyz, 0.0, 1.0);
    vec3 clear = (1.0 - f) * tint;
    if (glass.z > 0.5) clear = (1.0 - f) * (1.0 - f) * tint / max(vec3(1e-6), 1.0 - f * f * tint * tint);
    through = vec4(glass.x * clear, 1.0);
}
