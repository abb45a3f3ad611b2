// SPDX-License-Identifier: Apache-2.0
// Virtual directional lights as textures hold them: colour as half floats, direction as two bytes.

// Half float whose bits are the lower 16 of `h`. GLSL 3.30 has no unpackHalf2x16. Infinities and NaN never stand in a
// bake's texture; their bits give finite values here.
SHARED float halfValue(uint h)
{
    uint sign = (h & 0x8000u) << 16u;
    uint exponent = (h >> 10u) & 31u;
    uint mantissa = h & 1023u;
    if (exponent == 0u) { // denormal half: a normal float
        float small = float(int(mantissa)) * 5.9604644775390625e-8f;
        return sign != 0u ? -small : small;
    }
    return uintBitsToFloat(sign | ((exponent + 112u) << 23u) | (mantissa << 13u));
}

// Unit direction from two bytes: polar angle from +Z in steps of pi / 255, azimuth from +X towards +Y in steps of
// 2 pi / 256.
SHARED vec3 directionValue(uint theta, uint phi)
{
    float t = float(int(theta)) * (3.14159265f / 255.0f);
    float p = float(int(phi)) * (6.28318531f / 256.0f);
    float s = sin(t);
    return vec3(s * cos(p), s * sin(p), cos(t));
}

// Illuminance (lux) that a VDL of `colour` gives a surface facing `n`.
SHARED vec3 vdlIlluminance(vec3 colour, vec3 toLight, vec3 n)
{
    return colour * max(0.0f, dot(n, toLight));
}
