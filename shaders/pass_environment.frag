// SPDX-License-Identifier: Apache-2.0
#version 330 core
// What a smooth metal mirrors of its surroundings: a cube map rendered from the middle of the object.
#include "shared_limits.glsl"

uniform sampler2D gPosition, gNormal, gBase, gEmission;
uniform samplerCube environment; // cd/m2
uniform float which;             // map, as gEmission.w has it
uniform float side;              // pixels of a face
uniform vec3 eye;

out vec4 radiance;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(gPosition, at, 0);
    vec4 normal = texelFetch(gNormal, at, 0);
    if (place.w < 0.5 || texelFetch(gEmission, at, 0).w != which || normal.w > kMirrorsBelow) discard;
    vec4 base = texelFetch(gBase, at, 0);
    vec3 toEye = normalize(eye - place.xyz);
    float facing = max(dot(normal.xyz, toEye), 0.0);
    float away = 1.0 - facing;
    vec3 f0 = base.xyz;
    vec3 fresnel = f0 + (vec3(1.0) - f0) * (away * away * away * away * away);
    // a lobe of GGX is about alpha wide: take the map as coarse as that
    float alpha = normal.w * normal.w;
    float level = max(0.0, log2(side * alpha * 0.75 + 1e-6));
    vec3 seen = textureLod(environment, reflect(-toEye, normal.xyz), level).xyz;
    radiance = vec4(seen * fresnel * base.w, 1.0);
}
