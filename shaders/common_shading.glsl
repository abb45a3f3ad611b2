// SPDX-License-Identifier: Apache-2.0
// Light from one emitter and what a surface makes of it. Photometric units; directions are unit and leave the surface.

// KHR_lights_punctual: 1 inside the inner cone, 0 outside the outer one, squared linear in the cosine between.
SHARED float spotFactor(float cosAngle, float cosInner, float cosOuter)
{
    float width = max(cosInner - cosOuter, 1e-4f);
    float linear = min(max((cosAngle - cosOuter) / width, 0.0f), 1.0f);
    return linear * linear;
}

// Illuminance factor of a patch of `area` that shines with radiance 1: pi times the form factor of a disc, so that a
// receiver may come as near as it likes. Cosines at receiver and patch; `squared` their distance squared.
SHARED float patchFactor(float cosReceiver, float cosPatch, float squared, float area)
{
    float visible = max(cosReceiver, 0.0f) * max(cosPatch, 0.0f);
    return visible * 3.14159265f * area / (3.14159265f * squared + area);
}

// Radiance that a diffuse surface of reflectance `albedo` gives back under `illuminance` lux.
SHARED vec3 lambert(vec3 albedo, vec3 illuminance)
{
    return albedo * illuminance * 0.318309886f;
}

// GGX with Smith's height-correlated shadowing and Schlick's Fresnel: brdf of a metal with reflectance `f0` along its
// normal. `alpha` is roughness squared. Cosines: n.h, n.l, n.v, l.h.
SHARED vec3 metalBrdf(vec3 f0, float alpha, float nh, float nl, float nv, float lh)
{
    float a2 = max(alpha * alpha, 1e-4f);
    float d = nh * nh * (a2 - 1.0f) + 1.0f;
    float distribution = a2 / (3.14159265f * d * d);
    float v = nl * sqrt(nv * nv * (1.0f - a2) + a2) + nv * sqrt(nl * nl * (1.0f - a2) + a2);
    float shadowing = 0.5f / max(v, 1e-4f);
    float away = 1.0f - min(max(lh, 0.0f), 1.0f);
    float away2 = away * away;
    float fresnel = away2 * away2 * away;
    return (f0 + (vec3(1.0f) - f0) * fresnel) * (distribution * shadowing);
}

// The same from directions; includes the cosine at the surface, so times illuminance on a facing plane gives radiance.
SHARED vec3 metalReflects(vec3 f0, float alpha, vec3 n, vec3 toLight, vec3 toEye)
{
    float nl = dot(n, toLight);
    float nv = dot(n, toEye);
    if (nl <= 0.0f || nv <= 0.0f) return vec3(0.0f);
    vec3 sum = toLight + toEye;
    vec3 h = sum / max(sqrt(dot(sum, sum)), 1e-4f);
    return metalBrdf(f0, alpha, max(dot(n, h), 0.0f), nl, nv, dot(toLight, h)) * nl;
}
