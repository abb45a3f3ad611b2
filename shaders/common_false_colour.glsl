// SPDX-License-Identifier: Apache-2.0
// Numbers as colours: maps that are even to the eye and that the colour-blind can read.

// CIELAB (D65) to linear Rec.709.
SHARED float labUncurve(float v)
{
    return v > 6.0f / 29.0f ? v * v * v : 3.0f * (6.0f / 29.0f) * (6.0f / 29.0f) * (v - 4.0f / 29.0f);
}

SHARED vec3 labToLinear(vec3 lab)
{
    float fy = (lab.x + 16.0f) / 116.0f;
    float x = 0.9504559f * labUncurve(fy + lab.y / 500.0f);
    float y = labUncurve(fy);
    float z = 1.0890578f * labUncurve(fy - lab.z / 200.0f);
    return vec3(3.2409699f * x - 1.5373832f * y - 0.4986108f * z, -0.9692436f * x + 1.8759675f * y + 0.0415551f * z,
                0.0556301f * x - 0.2039770f * y + 1.0569715f * z);
}

// For amounts, t in [0,1] (clamped): dark indigo over rose to pale yellow, linear Rec.709. A parabola in CIELAB, inside
// the gamut all the way. The cubic in t undoes its uneven speed: equal steps of t are equal steps in CIELAB to 5 %.
// Lightness rises all the way, so it is read in grey and with any colour blindness.
SHARED vec3 sequentialColour(float t)
{
    float u = clamp(t, 0.0f, 1.0f);
    float s = u + u * (1.0f - u) * (-0.08473851f + u * (0.6448521f - u * 0.3074642f));
    vec3 dark = vec3(14.0f, 24.0f, -40.0f);
    vec3 bend = vec3(54.0f, 62.0f, 6.0f);
    vec3 pale = vec3(94.0f, -8.0f, 45.0f);
    return labToLinear(mix(mix(dark, bend, s), mix(bend, pale, s), s));
}

// For differences, t in [-1,1] (clamped): blue, white at 0, red, linear Rec.709. Straight lines in CIELAB of the same
// length and the same fall in lightness on both sides, so that -t and t stand out alike; blue against red is told apart
// with every common colour blindness.
SHARED vec3 divergingColour(float t)
{
    vec3 white = vec3(96.0f, 0.0f, 0.0f);
    vec3 end = t < 0.0f ? vec3(36.0f, 24.0f, -58.0f) : vec3(36.0f, 54.0f, 32.0f);
    return labToLinear(mix(white, end, min(abs(t), 1.0f)));
}
