// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Surface of the nearest triangle: where it is, which way it faces, what it is made of.
in vec3 vWorld;
in vec3 vNormal;
in vec4 vUv;
in vec4 vColour;

uniform vec4 baseColour;
uniform vec2 metallicRoughness;
uniform vec3 emission; // already divided by the frame's emission scale
uniform float environment; // 1 + number of the object's environment map; 0: none
uniform float normalScale; // 0: no normal map
uniform float alphaCutoff; // below it: cut out; negative: opaque
// transforms of texture coordinates, and which set (0 or 1) they start from
uniform mat3 baseUv, materialUv, normalUv, emissionUv;
uniform vec4 uvSets; // base, material, normal, emission
uniform sampler2D baseTexture, materialTexture, normalTexture, emissionTexture;

layout(location = 0) out vec4 gPosition; // w: 1 where there is a surface
layout(location = 1) out vec4 gNormal;   // w: roughness
layout(location = 2) out vec4 gBase;     // linear; w: metallic
layout(location = 3) out vec4 gEmission; // w: environment

vec2 uvOf(mat3 transform, float set)
{
    return (transform * vec3(set < 0.5 ? vUv.xy : vUv.zw, 1.0)).xy;
}

// Normal map through the frame that screen derivatives give: no tangents needed.
vec3 mapped(vec3 n, vec2 uv)
{
    vec3 dx = dFdx(vWorld), dy = dFdy(vWorld);
    vec2 ux = dFdx(uv), uy = dFdy(uv);
    vec3 acrossX = cross(dy, n), acrossY = cross(n, dx);
    vec3 tangent = acrossX * ux.x + acrossY * uy.x;
    vec3 bitangent = acrossX * ux.y + acrossY * uy.y;
    float longest = max(dot(tangent, tangent), dot(bitangent, bitangent));
    if (!(longest > 0.0)) return n;
    vec3 t = texture(normalTexture, uv).xyz * 2.0 - 1.0;
    // glTF: +Y of the map points up the picture, against v
    vec3 bent = (tangent * t.x - bitangent * t.y) * (normalScale * inversesqrt(longest)) + n * t.z;
    float size = dot(bent, bent);
    return size > 0.0 ? bent * inversesqrt(size) : n;
}

void main()
{
    vec4 base = baseColour * vColour * texture(baseTexture, uvOf(baseUv, uvSets.x));
    vec2 normalAt = uvOf(normalUv, uvSets.z);
    vec3 n = normalize(vNormal) * (gl_FrontFacing ? 1.0 : -1.0);
    if (normalScale != 0.0) n = mapped(n, normalAt);
    if (base.w < alphaCutoff) discard;
    vec4 material = texture(materialTexture, uvOf(materialUv, uvSets.y));
    gPosition = vec4(vWorld, 1.0);
    gNormal = vec4(n, metallicRoughness.y * material.y);
    gBase = vec4(base.xyz, metallicRoughness.x * material.z);
    gEmission = vec4(emission * texture(emissionTexture, uvOf(emissionUv, uvSets.w)).xyz, environment);
}
