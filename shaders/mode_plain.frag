// SPDX-License-Identifier: Apache-2.0
#version 330 core
// Form without light: base colour times the cosine towards the camera. The baseline that frame times are compared with.
uniform sampler2D gPosition, gNormal, gBase;
uniform vec3 eye;

out vec4 radiance;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 p = texelFetch(gPosition, at, 0);
    if (p.w < 0.5) discard;
    vec3 n = texelFetch(gNormal, at, 0).xyz;
    float facing = abs(dot(n, normalize(eye - p.xyz)));
    radiance = vec4(texelFetch(gBase, at, 0).xyz * facing, 1.0);
}
