// SPDX-License-Identifier: Apache-2.0
// From radiance to a screen.

// What radiance (cd/m2) is multiplied by so that 1 is white, for an exposure value at ISO 100: the brightest that is
// held is 1.2 * 2^ev cd/m2 (ISO 12232, saturation based speed).
SHARED float exposureScale(float ev)
{
    return exp2(-ev) / 1.2f;
}

// Shoulder: straight up to 0.7, above it 1 is approached and never passed; value and slope are continuous.
SHARED float shoulder(float v)
{
    if (v <= 0.7f) return max(v, 0.0f);
    float over = (v - 0.7f) / 0.3f;
    return 0.7f + 0.3f * over / (1.0f + over);
}

// Tone curve on exposed colour, result in [0,1]. Soft: the largest channel takes the shoulder, hue is kept, and what
// lies far above white fades to white.
SHARED vec3 toneCurve(vec3 colour, int tone)
{
    vec3 c = max(colour, vec3(0.0f));
    if (tone == kToneNone) return min(c, vec3(1.0f));
    float peak = max(c.x, max(c.y, c.z));
    if (peak <= 0.7f) return c;
    float held = shoulder(peak);
    vec3 scaled = c * (held / peak);
    float fade = 1.0f - 1.0f / (1.0f + 0.15f * (peak - held));
    return min(scaled + (vec3(held) - scaled) * fade, vec3(1.0f));
}

// IEC 61966-2-1, one channel in [0,1].
SHARED float srgbEncode(float linear)
{
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * pow(linear, 0.41666667f) - 0.055f;
}

SHARED float srgbDecode(float encoded)
{
    return encoded <= 0.04045f ? encoded / 12.92f : pow((encoded + 0.055f) / 1.055f, 2.4f);
}

SHARED vec3 screenColour(vec3 radiance, float scale, int tone)
{
    vec3 c = toneCurve(radiance * scale, tone);
    return vec3(srgbEncode(c.x), srgbEncode(c.y), srgbEncode(c.z));
}
