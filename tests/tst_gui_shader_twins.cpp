// SPDX-License-Identifier: Apache-2.0
// Claim: the shading maths is one text for two compilers. Every shared function gives on the GPU what it gives in C++,
// on 65,536 inputs (zeros, axes, denormals and huge values among them), and both give what a double-precision version
// written here says: two copies of one mistake would agree perfectly.
#include "shaders/common.h"
#include "widgets/gl/gl_objects.h"
#include "widgets/gl/gl_probe.h"
#include "widgets/gl/shader_library.h"
#include <QOffscreenSurface>
#include <QOpenGLContext>
#include <QOpenGLVersionFunctionsFactory>
#include <QtTest>
#include <bit>
#include <cmath>
#include <random>

using namespace lightloom;
using glm::dvec3;
using glm::dvec4;
using glm::vec3;
using glm::vec4;

namespace {

constexpr int kSide = 256; // kSide^2 inputs

/// A shared function (or a few) under test: the same call three times.
struct Twin {
    const char* name;
    const char* glsl; ///< expression of type vec4 in the inputs a, b (vec4)
    vec4 (*shared)(vec4 a, vec4 b);
    dvec4 (*wanted)(dvec4 a, dvec4 b);
    float low, high;         ///< range of random inputs
    bool unit = false;       ///< the inputs' xyz are directions
    double tolerance = 2e-6; ///< of max(1, |wanted|)
    bool huge = false;       ///< survives values of 1e18 too
};

vec4 v4(vec3 v) { return vec4(v.x, v.y, v.z, 0.0f); }
vec4 v4(float v) { return vec4(v, 0.0f, 0.0f, 0.0f); }
dvec4 d4(double v) { return dvec4(v, 0.0, 0.0, 0.0); }
vec3 xyz(vec4 v) { return vec3(v.x, v.y, v.z); }
dvec3 xyz(dvec4 v) { return dvec3(v.x, v.y, v.z); }
unsigned bits(double v) { return static_cast<unsigned>(v); }

double halfInDouble(unsigned h)
{
    const int exponent = static_cast<int>((h >> 10) & 31), mantissa = static_cast<int>(h & 1023);
    const double value = exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
    return (h & 0x8000) != 0 ? -value : value;
}

dvec3 directionInDouble(unsigned theta, unsigned phi)
{
    const double t = std::acos(-1.0) * theta / 255.0, p = 2.0 * std::acos(-1.0) * phi / 256.0;
    return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

dvec3 toneInDouble(dvec3 c)
{
    c = glm::max(c, dvec3(0.0));
    const double peak = std::max({c.x, c.y, c.z});
    if (peak <= 0.7) return c;
    const double x = (peak - 0.7) / 0.3, held = 0.7 + 0.3 * (x / (x + 1.0));
    const double k = 0.15 * (peak - held), fade = k / (1.0 + k);
    return glm::min(glm::mix(c / peak * held, dvec3(held), fade), dvec3(1.0));
}

double srgbInDouble(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055; }

/// CIELAB (D65) to linear Rec.709, written from CIE 15 and IEC 61966-2-1.
dvec3 labInDouble(dvec3 lab)
{
    const double y = (lab.x + 16.0) / 116.0;
    const auto inverse = [](double f) { return f > 24.0 / 116.0 ? f * f * f : (f - 16.0 / 116.0) * 108.0 / 841.0; };
    const dvec3 xyz(0.9504559 * inverse(y + lab.y / 500.0), inverse(y), 1.0890578 * inverse(y - lab.z / 200.0));
    return {dot(dvec3(3.2409699, -1.5373832, -0.4986108), xyz), dot(dvec3(-0.9692436, 1.8759675, 0.0415551), xyz),
            dot(dvec3(0.0556301, -0.2039770, 1.0569715), xyz)};
}

dvec3 sequentialInDouble(double t)
{
    t = std::clamp(t, 0.0, 1.0);
    const double s = t + t * (1.0 - t) * (-0.08473851 + 0.6448521 * t - 0.3074642 * t * t);
    const double a = (1.0 - s) * (1.0 - s), b = 2.0 * s * (1.0 - s), c = s * s; // Bernstein's form of the parabola
    return labInDouble(a * dvec3(14, 24, -40) + b * dvec3(54, 62, 6) + c * dvec3(94, -8, 45));
}

dvec3 divergingInDouble(double t)
{
    const double a = std::min(std::abs(t), 1.0);
    return labInDouble((1.0 - a) * dvec3(96, 0, 0) + a * (t < 0.0 ? dvec3(36, 24, -58) : dvec3(36, 54, 32)));
}

dvec3 metalInDouble(dvec3 f0, double alpha, dvec3 n, dvec3 l, dvec3 v)
{
    const double nl = glm::dot(n, l), nv = glm::dot(n, v);
    if (nl <= 0.0 || nv <= 0.0) return dvec3(0.0);
    const dvec3 h = (l + v) / std::max(glm::length(l + v), 1e-4);
    const double a2 = std::max(alpha * alpha, 1e-4), nh = std::max(glm::dot(n, h), 0.0);
    const double d = a2 / (std::acos(-1.0) * std::pow(nh * nh * (a2 - 1.0) + 1.0, 2.0));
    const double lambdaL = nv * std::sqrt(nl * nl * (1.0 - a2) + a2),
                 lambdaV = nl * std::sqrt(nv * nv * (1.0 - a2) + a2);
    const double lh = std::clamp(glm::dot(l, h), 0.0, 1.0);
    return glm::mix(f0, dvec3(1.0), std::pow(1.0 - lh, 5.0)) * (d * 0.5 / std::max(lambdaL + lambdaV, 1e-4)) * nl;
}

/// Weights of the cubic B-spline (or Catmull-Rom's spline) at vertices -1, 0, 1, 2, from their matrices.
dvec4 cubicInDouble(double t, bool isSpline)
{
    const dvec4 powers(1.0, t, t * t, t * t * t);
    const double spline[4][4] = {{1, -3, 3, -1}, {4, 0, -6, 3}, {1, 3, 3, -3}, {0, 0, 0, 1}};
    const double catmull[4][4] = {{0, -1, 2, -1}, {2, 0, -5, 3}, {0, 1, 4, -3}, {0, 0, -1, 1}};
    dvec4 out(0.0);
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 4; ++k) out[i] += (isSpline ? spline[i][k] / 6.0 : catmull[i][k] / 2.0) * powers[k];
    }
    return out;
}

/// Weighted sum over vertices -1 to 2 of a function that is linear between neighbours, from the two reads.
double readsInDouble(dvec4 reads, dvec4 values)
{
    const double low = glm::mix(values[0], values[1], reads.x + 1.0),
                 high = glm::mix(values[2], values[3], reads.z - 1.0);
    return reads.y * low + reads.w * high;
}

double fadeInDouble(double excess, double width) { return std::clamp(0.5 - 0.5 * excess / width, 0.0, 1.0); }

double sightInDouble(double away, unsigned sight)
{
    const unsigned way = away > 0.0 ? sight / 256 : sight % 256;
    return way == 255 ? 1.0 : fadeInDouble(std::abs(away) - way / 127.5 - 0.05, 0.05);
}

/// `terms` of three numbers each one after the other, as texels hold them, times factors.
dvec3 termsInDouble(const std::vector<dvec4>& texels, const std::vector<double>& factors)
{
    dvec3 sum(0.0);
    for (std::size_t t = 0; t < factors.size(); ++t) {
        for (std::size_t c = 0; c < 3; ++c) sum[int(c)] += factors[t] * texels[(3 * t + c) / 4][int((3 * t + c) % 4)];
    }
    return sum;
}

// clang-format off
const Twin kTwins[] = {
    {"grid sight", "vec4(gridSight(a.xyz, uvec3(abs(b.xyz) * 65535.0)), gridSide(a.xyz, vec3(0.3, -0.4, 1.2)), 0.0, 0.0)",
     [](vec4 a, vec4 b) {
         const glm::uvec3 sight(bits(std::abs(b.x) * 65535.0f), bits(std::abs(b.y) * 65535.0f), bits(std::abs(b.z) * 65535.0f));
         return vec4(shader::gridSight(xyz(a), sight), shader::gridSide(xyz(a), vec3(0.3f, -0.4f, 1.2f)), 0, 0); },
     [](dvec4 a, dvec4 b) {
         double seen = 1.0;
         for (int i = 0; i < 3; ++i) seen *= sightInDouble(a[i], bits(double(std::abs(float(b[i])) * 65535.0f)));
         const double before = -dot(xyz(a), dvec3(0.3f, -0.4f, 1.2f)) / 1.3;
         return dvec4(seen, std::clamp(before / 0.1, 0.0, 1.0), 0, 0); }, -1, 1, false, 4e-6},
    {"grid lean", "vec4(gridLean(a.xyz + 0.25, uvec3(abs(b.xyz) * 65535.0), b.zxy), 0.0, 0.0, 0.0)",
     [](vec4 a, vec4 b) {
         const glm::uvec3 sight(bits(std::abs(b.x) * 65535.0f), bits(std::abs(b.y) * 65535.0f), bits(std::abs(b.z) * 65535.0f));
         return vec4(shader::gridLean(xyz(a) + 0.25f, sight, vec3(b.z, b.x, b.y)), 0, 0, 0); },
     [](dvec4 a, dvec4 b) {
         double most = 0.0;
         for (int i = 0; i < 3; ++i) {
             const bool isUp = float(a[i]) + 0.25f > 0.0f;
             const unsigned sight = bits(double(std::abs(float(b[i])) * 65535.0f));
             if ((isUp ? sight / 256 : sight % 256) < 255) most = std::max(most, (isUp ? -1.0 : 1.0) * b[(i + 2) % 3]);
         }
         return dvec4(std::min(most / 0.1, 1.0), 0, 0, 0); }, -1, 1},
    {"grid inside", "vec4(gridInside(a.xyz, vec3(-0.75, -0.5, -1.0), vec3(0.5, 0.75, 0.875), 0.25), 0.0, 0.0, 0.0)",
     [](vec4 a, vec4) {
         return vec4(shader::gridInside(xyz(a), vec3(-0.75f, -0.5f, -1.0f), vec3(0.5f, 0.75f, 0.875f), 0.25f), 0, 0, 0); },
     [](dvec4 a, dvec4) {
         const double depth = std::min({a.x + 0.75, 0.5 - a.x, a.y + 0.5, 0.75 - a.y, a.z + 1.0, 0.875 - a.z});
         const double t = std::clamp(depth / 0.25, 0.0, 1.0);
         return dvec4(t * t * (3.0 - 2.0 * t), 0, 0, 0); }, -1, 1},
    {"spline reads", "gridSplineReads(a.x)",
     [](vec4 a, vec4) { return shader::gridSplineReads(a.x); },
     [](dvec4 a, dvec4) {
         const dvec4 w = cubicInDouble(a.x, true);
         return dvec4(w[1] / (w[0] + w[1]) - 1.0, w[0] + w[1], 1.0 + w[3] / (w[2] + w[3]), w[2] + w[3]); }, 0, 1},
    {"catmull-rom", "gridCatmullRom(a.x)",
     [](vec4 a, vec4) { return shader::gridCatmullRom(a.x); },
     [](dvec4 a, dvec4) { return cubicInDouble(a.x, false); }, 0, 1},
    {"between axes", "vec4(gridBetweenAxes(a, b, a + b, a - b, b + b, a.xyz), 0.0)",
     [](vec4 a, vec4 b) { return v4(shader::gridBetweenAxes(a, b, a + b, a - b, b + b, xyz(a))); },
     [](dvec4 a, dvec4 b) {
         const auto linear = [](double n) { return n * (1.0 - std::abs(n)); };
         return dvec4(termsInDouble({a, b, a + b, a - b, b + b}, {linear(a.x), linear(a.y), linear(a.z), a.x * a.y, a.y * a.z, a.z * a.x}), 0); }, -1, 1, false, 4e-6},
    {"harmonics", "vec4(gridFirstOrder(a, b, a - b, a.xyz) + gridSecondOrder(b + b, a + b, a, b, a.xyz), 0.0)",
     [](vec4 a, vec4 b) { return v4(shader::gridFirstOrder(a, b, a - b, xyz(a)) + shader::gridSecondOrder(b + b, a + b, a, b, xyz(a))); },
     [](dvec4 a, dvec4 b) {
         return dvec4(termsInDouble({a, b, a - b, b + b, a + b, a, b}, {1.0, a.x, a.y, a.z, a.x * a.y, a.y * a.z, a.z * a.x, a.x * a.x - a.y * a.y, 3.0 * a.z * a.z - 1.0}), 0); }, -1, 1, false, 4e-6},
    {"half", "vec4(halfValue(uint(a.x)), halfValue(uint(a.y)), 0.0, 0.0)",
     [](vec4 a, vec4) { return vec4(shader::halfValue(bits(a.x)), shader::halfValue(bits(a.y)), 0, 0); },
     [](dvec4 a, dvec4) { return dvec4(halfInDouble(bits(a.x)), halfInDouble(bits(a.y)), 0, 0); }, 0, 65535.99f, false, 0},
    {"direction", "vec4(directionValue(uint(a.x), uint(a.y)), 0.0)",
     [](vec4 a, vec4) { return v4(shader::directionValue(bits(a.x), bits(a.y))); },
     [](dvec4 a, dvec4) { return dvec4(directionInDouble(bits(a.x), bits(a.y)), 0); }, 0, 255.99f},
    {"vdl", "vec4(vdlIlluminance(abs(b.xyz), a.xyz, vec3(0.6, 0.0, 0.8)), 0.0)",
     [](vec4 a, vec4 b) { return v4(shader::vdlIlluminance(glm::abs(xyz(b)), xyz(a), vec3(0.6f, 0, 0.8f))); },
     [](dvec4 a, dvec4 b) { return dvec4(glm::abs(xyz(b)) * std::max(0.0, 0.6f * a.x + 0.8f * a.z), 0); }, -1, 1, true},
    {"octree position", "vec4(octreePosition(a.xyz, vec3(-2.0, 1.0, 0.5), 0.25), 0.0)",
     [](vec4 a, vec4) { return v4(shader::octreePosition(xyz(a), vec3(-2, 1, 0.5f), 0.25f)); },
     [](dvec4 a, dvec4) { return dvec4((xyz(a) - dvec3(-2, 1, 0.5)) * 4.0, 0); }, -8, 8, false, 2e-6, true},
    {"side", "vec4(sideDirection(a.xyz, uint(abs(b.w) * 255.0)), 0.0)",
     [](vec4 a, vec4 b) { return v4(shader::sideDirection(xyz(a), bits(std::abs(b.w) * 255.0f))); },
     [](dvec4 a, dvec4 b) {
         const dvec3 n = xyz(a), axis = std::abs(a.x) < double(0.6f) ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
         const dvec3 t = glm::normalize(glm::cross(axis, n));
         const double turn = 2.0 * std::acos(-1.0) * bits(double(std::abs(float(b.w)) * 255.0f)) / 256.0;
         return dvec4(std::cos(turn) * t + std::sin(turn) * glm::cross(n, t), 0); }, -1, 1, true},
    {"octree descent", "vec4(vec3(brickTexel(ivec3(b.xyz), octreeChild(ivec3(a.xyz), int(a.w) / 8, 6))), octreeHolds(ivec3(a.xyz), 5) ? 1.0 : 0.0)",
     [](vec4 a, vec4 b) {
         const glm::ivec3 cell(xyz(a)), texel = shader::brickTexel(glm::ivec3(xyz(b)), shader::octreeChild(cell, int(a.w) / 8, 6));
         return vec4(vec3(texel), shader::octreeHolds(cell, 5) ? 1 : 0); },
     [](dvec4 a, dvec4 b) {
         const double half = std::exp2(5 - std::floor(std::floor(a.w) / 8)); // side of a child's subtree in cells
         const dvec3 child = glm::mod(glm::floor(glm::floor(xyz(a)) / half), dvec3(2.0));
         const bool holds = std::max({a.x, a.y, a.z}) < 32.0;
         return dvec4(2.0 * glm::floor(xyz(b)) + child, holds); }, 0, 47.99f, false, 0},
    {"texel", "vec4((texelIsNode(uvec4(a)) ? 1.0 : 0.0) + (texelIsSplit(uvec4(a)) ? 2.0 : 0.0), float(texelEntries(uvec4(a))), float(texelAddress(uvec4(a))), float(texelBrick(uvec4(a)).y))",
     [](vec4 a, vec4) {
         const glm::uvec4 t(bits(a.x), bits(a.y), bits(a.z), bits(a.w));
         return vec4((shader::texelIsNode(t) ? 1 : 0) + (shader::texelIsSplit(t) ? 2 : 0), shader::texelEntries(t), shader::texelAddress(t), shader::texelBrick(t).y); },
     [](dvec4 a, dvec4) {
         const dvec4 t = glm::floor(a);
         return dvec4(t.w == 1.0 ? 1.0 : t.w == 255.0 ? 2.0 : 0.0, t.w == 255.0 ? 0.0 : std::max(t.w - 1.0, 0.0), t.x + 256.0 * t.y + 65536.0 * t.z, t.y); }, 0, 255.99f, false, 0},
    {"row", "vec4(vec2(rowTexel(int(a.x), 1 + int(a.y) / 64)), 0.0, 0.0)",
     [](vec4 a, vec4) { return vec4(glm::vec2(shader::rowTexel(int(a.x), 1 + int(a.y) / 64)), 0, 0); },
     [](dvec4 a, dvec4) {
         const double width = 1.0 + std::floor(std::floor(a.y) / 64.0), number = std::floor(a.x);
         return dvec4(number - width * std::floor(number / width), std::floor(number / width), 0, 0); }, 0, 65535, false, 0},
    {"corner weight", "vec4(cornerWeight(a.xyz, ivec3(b.xyz * 2.0)), 0.0, 0.0, 0.0)",
     [](vec4 a, vec4 b) { return v4(shader::cornerWeight(xyz(a), glm::ivec3(xyz(b) * 2.0f))); },
     [](dvec4 a, dvec4 b) {
         const auto one = [](double f, double c) { return c < 0.5 ? 1.0 - f : f; };
         return d4(one(a.x, b.x) * one(a.y, b.y) * one(a.z, b.z)); }, 0, 0.9999f},
    {"spot", "vec4(spotFactor(a.x, 0.9, 0.7), spotFactor(a.y, 0.8, 0.8), 0.0, 0.0)",
     [](vec4 a, vec4) { return vec4(shader::spotFactor(a.x, 0.9f, 0.7f), shader::spotFactor(a.y, 0.8f, 0.8f), 0, 0); },
     [](dvec4 a, dvec4) {
         const auto one = [](double c, double in, double out) { return std::pow(std::clamp((c - out) / std::max(in - out, double(1e-4f)), 0.0, 1.0), 2.0); };
         return dvec4(one(a.x, 0.9f, 0.7f), one(a.y, 0.8f, 0.8f), 0, 0); }, -1, 1, false, 1e-3},
    {"patch", "vec4(patchFactor(a.x, a.y, abs(b.x) * 100.0, abs(b.y)), 0.0, 0.0, 0.0)",
     [](vec4 a, vec4 b) { return v4(shader::patchFactor(a.x, a.y, std::abs(b.x) * 100.0f, std::abs(b.y))); },
     [](dvec4 a, dvec4 b) {
         const double area = std::abs(b.y), squared = std::abs(b.x) * 100.0;
         if (area == 0.0) return d4(0.0);
         return d4(std::max(a.x, 0.0) * std::max(a.y, 0.0) / (squared / area + 1.0 / std::acos(-1.0))); }, -1, 1},
    {"lambert", "vec4(lambert(a.xyz, b.xyz), 0.0)",
     [](vec4 a, vec4 b) { return v4(shader::lambert(xyz(a), xyz(b))); },
     [](dvec4 a, dvec4 b) { return dvec4(xyz(a) * xyz(b) / std::acos(-1.0), 0); }, 0, 1e4f, false, 2e-6, true},
    {"metal", "vec4(metalReflects(vec3(0.9, 0.6, 0.3), 0.3, vec3(0.0, 0.0, 1.0), a.xyz, b.xyz), 0.0)",
     [](vec4 a, vec4 b) { return v4(shader::metalReflects(vec3(0.9f, 0.6f, 0.3f), 0.3f, vec3(0, 0, 1), xyz(a), xyz(b))); },
     [](dvec4 a, dvec4 b) { return dvec4(metalInDouble(dvec3(0.9, 0.6, 0.3), 0.3, dvec3(0, 0, 1), xyz(a), xyz(b)), 0); }, -1, 1, true, 2e-5},
    {"exposure", "vec4(exposureScale(a.x), 0.0, 0.0, 0.0)",
     [](vec4 a, vec4) { return v4(shader::exposureScale(a.x)); },
     [](dvec4 a, dvec4) { return d4(1.0 / (1.2 * std::pow(2.0, a.x))); }, -4, 20, false, 4e-6},
    {"tone", "vec4(toneCurve(a.xyz, kToneSoft), 0.0)",
     [](vec4 a, vec4) { return v4(shader::toneCurve(xyz(a), shader::kToneSoft)); },
     [](dvec4 a, dvec4) { return dvec4(toneInDouble(xyz(a)), 0); }, -0.1f, 8, false, 2e-6, true},
    {"sequential", "vec4(sequentialColour(a.x), 0.0)",
     [](vec4 a, vec4) { return v4(shader::sequentialColour(a.x)); },
     [](dvec4 a, dvec4) { return dvec4(sequentialInDouble(a.x), 0); }, -0.1f, 1.1f, false, 4e-6, true},
    {"diverging", "vec4(divergingColour(a.x), 0.0)",
     [](vec4 a, vec4) { return v4(shader::divergingColour(a.x)); },
     [](dvec4 a, dvec4) { return dvec4(divergingInDouble(a.x), 0); }, -1.1f, 1.1f, false, 4e-6, true},
    {"screen", "vec4(screenColour(a.xyz, 0.25, kToneNone), srgbDecode(min(abs(b.x) / 8.0, 1.0)))",
     [](vec4 a, vec4 b) { return vec4(shader::screenColour(xyz(a), 0.25f, shader::kToneNone), shader::srgbDecode(std::min(std::abs(b.x) / 8.0f, 1.0f))); },
     [](dvec4 a, dvec4 b) {
         const auto one = [](double v) { return srgbInDouble(std::clamp(v * 0.25, 0.0, 1.0)); };
         const double e = std::min(std::abs(b.x) / 8.0, 1.0), back = e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4);
         return dvec4(one(a.x), one(a.y), one(a.z), back); }, -0.1f, 8, false, 4e-6, true},
};
// clang-format on

/// Random inputs, and in front of them zeros, axes, denormals and the ends of the range.
std::vector<vec4> inputs(const Twin& twin, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(twin.low, twin.high);
    std::vector<vec4> all;
    const float denormal = std::bit_cast<float>(0x00000fffu);
    for (const float v : {0.0f, denormal, twin.low, twin.high, 1.0f}) {
        if (v >= twin.low && v <= twin.high && !twin.unit) all.emplace_back(v);
    }
    if (twin.huge) all.emplace_back(1e18f);
    for (int axis = 0; axis < 3; ++axis) {
        vec4 v(0.0f);
        v[axis] = std::min(1.0f, twin.high);
        all.push_back(v);
        if (twin.low < 0.0f) all.push_back(v * std::max(-1.0f, twin.low));
    }
    while (all.size() < kSide * kSide) {
        vec4 v(value(random), value(random), value(random), value(random));
        if (twin.unit) {
            const float length = glm::length(xyz(v));
            if (length < 0.1f || length > 1.0f) continue;
            v = vec4(xyz(v) / length, v.w);
        }
        all.push_back(v);
    }
    // b must not start with the same specials as a, or pairs of a special and a random value never meet
    if (seed % 2 == 0) std::rotate(all.begin(), all.begin() + 7, all.end());
    return all;
}

double distance(vec4 got, dvec4 wanted)
{
    double worst = 0.0;
    for (int i = 0; i < 4; ++i) {
        const double error = std::abs(double(got[i]) - wanted[i]) / std::max(1.0, std::abs(wanted[i]));
        worst = error <= worst ? worst : error; // NaN wins
    }
    return worst;
}

} // namespace

class ShaderTwinsTest : public QObject {
    Q_OBJECT
    QOffscreenSurface surface_;
    QOpenGLContext context_;
    Gl* gl_ = nullptr;

    std::vector<vec4> onGpu(const Twin& twin, const std::vector<vec4>& a, const std::vector<vec4>& b)
    {
        const QByteArray text =
            QByteArray("#version 330 core\n"
                       "#include \"shared_limits.glsl\"\n#include \"common_colour.glsl\"\n"
                       "#include \"common_false_colour.glsl\"\n"
                       "#include \"common_ivg.glsl\"\n"
                       "#include \"common_octree.glsl\"\n#include \"common_shading.glsl\"\n"
                       "#include \"common_vdl.glsl\"\n"
                       "uniform sampler2D inputA, inputB;\nout vec4 result;\nvoid main()\n{\n"
                       "    vec4 a = texelFetch(inputA, ivec2(gl_FragCoord.xy), 0);\n"
                       "    vec4 b = texelFetch(inputB, ivec2(gl_FragCoord.xy), 0);\n    result = ") +
            twin.glsl + ";\n}\n";
        const ShaderLibrary library([&](const QString& name) -> std::optional<QByteArray> {
            if (name == "twin.frag") return text;
            QFile file(":/shaders/" + name);
            return file.open(QIODevice::ReadOnly) ? std::optional(file.readAll()) : std::nullopt;
        });
        const Result<GlProgram> program = library.link(*gl_, "fullscreen.vert", "twin.frag");
        if (!program) {
            qWarning("%s", program.error().message.c_str());
            return {};
        }
        const GlTexture inA = makeTexture2D(*gl_, GL_RGBA32F, glm::ivec2(kSide), GL_RGBA, GL_FLOAT, a.data());
        const GlTexture inB = makeTexture2D(*gl_, GL_RGBA32F, glm::ivec2(kSide), GL_RGBA, GL_FLOAT, b.data());
        const GlTexture out = makeTexture2D(*gl_, GL_RGBA32F, glm::ivec2(kSide), GL_RGBA, GL_FLOAT, nullptr);
        const GLuint colour = out.id();
        const Result<GlFramebuffer> target = makeFramebuffer(*gl_, {&colour, 1}, 0);
        if (!target) return {};
        const GlVertexArray empty(*gl_);
        gl_->glBindVertexArray(empty.id());
        gl_->glViewport(0, 0, kSide, kSide);
        program->use();
        program->setTexture("inputA", 0, GL_TEXTURE_2D, inA.id());
        program->setTexture("inputB", 1, GL_TEXTURE_2D, inB.id());
        drawFullscreen(*gl_);
        std::vector<vec4> result(kSide * kSide);
        gl_->glReadPixels(0, 0, kSide, kSide, GL_RGBA, GL_FLOAT, result.data());
        return result;
    }

private Q_SLOTS:
    void initTestCase()
    {
        surface_.create();
        QVERIFY(context_.create() && context_.makeCurrent(&surface_));
        gl_ = QOpenGLVersionFunctionsFactory::get<Gl>(&context_);
        QVERIFY(gl_ != nullptr && gl_->initializeOpenGLFunctions());
    }

    void gpuCppAndDoubleAgree_data()
    {
        QTest::addColumn<int>("index");
        for (int i = 0; i < int(std::size(kTwins)); ++i) QTest::newRow(kTwins[i].name) << i;
    }
    void gpuCppAndDoubleAgree()
    {
        QFETCH(int, index);
        const Twin& twin = kTwins[index];
        const auto a = inputs(twin, unsigned(2 * index + 1)), b = inputs(twin, unsigned(2 * index + 2));
        const auto gpu = onGpu(twin, a, b);
        QCOMPARE(gpu.size(), a.size());
        double worstTwin = 0.0, worstTruth = 0.0;
        std::size_t at = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            const vec4 cpp = twin.shared(a[i], b[i]);
            const double twins = distance(gpu[i], dvec4(cpp)), truth = distance(cpp, twin.wanted(a[i], b[i]));
            if (!(twins <= worstTwin) || !(truth <= worstTruth)) at = i;
            worstTwin = twins <= worstTwin ? worstTwin : twins;
            worstTruth = truth <= worstTruth ? worstTruth : truth;
        }
        qInfo("%s: GPU - C++ %.2g, C++ - double %.2g of max(1, value)", twin.name, worstTwin, worstTruth);
        const bool fine = worstTwin <= twin.tolerance && worstTruth <= twin.tolerance;
        QVERIFY2(fine, qPrintable(QString("input %1: a = (%2 %3 %4 %5), b = (%6 %7 %8 %9)")
                                      .arg(at)
                                      .arg(a[at].x)
                                      .arg(a[at].y)
                                      .arg(a[at].z)
                                      .arg(a[at].w)
                                      .arg(b[at].x)
                                      .arg(b[at].y)
                                      .arg(b[at].z)
                                      .arg(b[at].w)));
    }

    void twoReadsAreAllFourVertices() // what the B-spline's reads are for
    {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> value(0.0, 1.0);
        for (int i = 0; i < 1000; ++i) {
            const double t = i / 999.0;
            const dvec4 values(value(random), value(random), value(random), value(random));
            const double wanted = dot(cubicInDouble(t, true), values);
            const double is = readsInDouble(dvec4(shader::gridSplineReads(static_cast<float>(t))), values);
            QVERIFY(std::abs(is - wanted) <= 1e-6);
        }
    }

    void includesComeOnceAndCyclesAreErrors()
    {
        const ShaderLibrary library([](const QString& name) -> std::optional<QByteArray> {
            if (name == "a") return "#version 330 core\n#include \"b\"\n#include \"c\"\nlast\n";
            if (name == "b") return "#include \"c\"\nin b\n";
            if (name == "c") return "in c\n";
            if (name == "loop") return "#include \"pool\"\n";
            if (name == "pool") return "#include \"loop\"\n";
            if (name == "hole") return "#include \"nothing\"\n";
            return std::nullopt;
        });
        const Result<QByteArray> text = library.expand("a");
        QVERIFY(text);
        QCOMPARE(text->count("in c"), 1);
        QVERIFY(text->contains("#line 4 0\nlast"));
        const Result<QByteArray> loop = library.expand("loop"), hole = library.expand("hole");
        QVERIFY(!loop && QString::fromStdString(loop.error().message).contains("includes itself"));
        QVERIFY(!hole && QString::fromStdString(hole.error().message).contains("nothing, included by hole"));
    }
};

int main(int argc, char** argv)
{
    setDefaultGlFormat();
    QGuiApplication application(argc, argv);
    ShaderTwinsTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "tst_gui_shader_twins.moc"
