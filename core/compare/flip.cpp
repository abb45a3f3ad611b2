// SPDX-License-Identifier: Apache-2.0
// Names and constants follow the paper's section 4. Every filter in it is a sum of separable ones, so each runs as a
// row and a column pass.
#include "core/compare/flip.h"
#include "core/base/units.h"
#include <algorithm>
#include <cassert>
#include <cmath>

namespace lightloom {
namespace {

constexpr float kColourExponent = 0.7f;  // q_c
constexpr float kFeatureExponent = 0.5f; // q_f
constexpr float kSplitAt = 0.4f;         // p_c, as a fraction of the largest colour difference
constexpr float kSplitTo = 0.95f;        // p_t
constexpr float kFeatureWidth = 0.082f;  // w, degrees: peak of the eye's edge detection

using Plane = std::vector<float>;

struct Size {
    int width, height;
    [[nodiscard]] std::size_t count() const
    {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
    [[nodiscard]] std::size_t index(int x, int y) const
    {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
};

/// Linear Rec.709 to XYZ, relative to the D65 white that (1,1,1) gives. Rows of the standard's matrix.
glm::vec3 toRelativeXyz(glm::vec3 c)
{
    constexpr float xr = 0.4123908f, xg = 0.3575843f, xb = 0.1804808f;
    constexpr float yr = 0.2126390f, yg = 0.7151687f, yb = 0.0721923f;
    constexpr float zr = 0.0193308f, zg = 0.1191948f, zb = 0.9505322f;
    return {(xr * c.x + xg * c.y + xb * c.z) / (xr + xg + xb), (yr * c.x + yg * c.y + yb * c.z) / (yr + yg + yb),
            (zr * c.x + zg * c.y + zb * c.z) / (zr + zg + zb)};
}

/// Linearised CIELAB: the opponent space in which the eye's contrast sensitivity is known.
glm::vec3 toOpponent(glm::vec3 c)
{
    const glm::vec3 v = toRelativeXyz(c);
    return {116.0f * v.y - 16.0f, 500.0f * (v.x - v.y), 200.0f * (v.y - v.z)};
}

glm::vec3 relativeXyzOf(glm::vec3 opponent)
{
    const float y = (opponent.x + 16.0f) / 116.0f;
    return {y + opponent.y / 500.0f, y, y - opponent.z / 200.0f};
}

/// Inverse of `toRelativeXyz`, found once from the matrix itself so that the two cannot drift apart.
const glm::mat3& fromRelativeXyz()
{
    static const glm::mat3 inverse =
        glm::inverse(glm::mat3(toRelativeXyz({1, 0, 0}), toRelativeXyz({0, 1, 0}), toRelativeXyz({0, 0, 1})));
    return inverse;
}

float labCurve(float t)
{
    constexpr float delta = 6.0f / 29.0f;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3.0f * delta * delta) + 4.0f / 29.0f;
}

/// CIELAB with the Hunt effect: chroma counts less where it is dark.
glm::vec3 toHuntLab(glm::vec3 relativeXyz)
{
    const float x = labCurve(relativeXyz.x), y = labCurve(relativeXyz.y), z = labCurve(relativeXyz.z);
    const float lightness = 116.0f * y - 16.0f;
    return {lightness, 0.01f * lightness * 500.0f * (x - y), 0.01f * lightness * 200.0f * (y - z)};
}

/// Distance for large colour differences: city block between lightness and chroma (HyAB).
float hyab(glm::vec3 a, glm::vec3 b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

/// `kernel` has an odd number of taps, weights rising in x. Beyond the border the border pixel goes on.
Plane filterRows(const Plane& in, Size size, const std::vector<float>& kernel)
{
    const int radius = static_cast<int>(kernel.size() / 2);
    Plane out(size.count());
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            float sum = 0.0f;
            for (int k = -radius; k <= radius; ++k) {
                const int from = std::clamp(x + k, 0, size.width - 1);
                sum += kernel[static_cast<std::size_t>(k + radius)] * in[size.index(from, y)];
            }
            out[size.index(x, y)] = sum;
        }
    }
    return out;
}

Plane filterColumns(const Plane& in, Size size, const std::vector<float>& kernel)
{
    const int radius = static_cast<int>(kernel.size() / 2);
    Plane out(size.count(), 0.0f);
    for (int y = 0; y < size.height; ++y) {
        for (int k = -radius; k <= radius; ++k) {
            const int from = std::clamp(y + k, 0, size.height - 1);
            const float weight = kernel[static_cast<std::size_t>(k + radius)];
            for (int x = 0; x < size.width; ++x) out[size.index(x, y)] += weight * in[size.index(x, from)];
        }
    }
    return out;
}

template<class F>
std::vector<float> kernelOf(int radius, F weight)
{
    std::vector<float> kernel;
    for (int k = -radius; k <= radius; ++k) kernel.push_back(weight(static_cast<float>(k)));
    return kernel;
}

float sumOf(const std::vector<float>& kernel)
{
    float sum = 0.0f;
    for (const float w : kernel) sum += w;
    return sum;
}

/// Contrast sensitivity of one opponent channel as two Gaussians a sqrt(pi/b) exp(-pi^2 x^2 / b), x in degrees.
struct Sensitivity {
    float a1, b1, a2, b2;
};
constexpr Sensitivity kAchromatic{1.0f, 0.0047f, 0.0f, 1e-5f}, kRedGreen{1.0f, 0.0053f, 0.0f, 1e-5f},
    kBlueYellow{34.1f, 0.04f, 13.5f, 0.025f};

Plane seen(const Plane& channel, Size size, const Sensitivity& s, float pixelsPerDegree)
{
    const float widest = std::max({kAchromatic.b1, kRedGreen.b1, kBlueYellow.b1, kBlueYellow.b2});
    const int radius = static_cast<int>(std::ceil(3.0f * std::sqrt(widest / (2.0f * kPi * kPi)) * pixelsPerDegree));
    Plane out(size.count(), 0.0f);
    float total = 0.0f;
    for (const auto& [a, b] : {std::pair(s.a1, s.b1), std::pair(s.a2, s.b2)}) {
        if (a == 0.0f) continue;
        const auto kernel = kernelOf(radius, [&, width = b](float k) {
            const float degrees = k / pixelsPerDegree;
            return std::exp(-kPi * kPi * degrees * degrees / width);
        });
        const float weight = a * std::sqrt(kPi / b), sum = sumOf(kernel);
        const Plane part = filterColumns(filterRows(channel, size, kernel), size, kernel);
        for (std::size_t i = 0; i < out.size(); ++i) out[i] += weight * part[i];
        total += weight * sum * sum;
    }
    for (float& v : out) v /= total;
    return out;
}

std::vector<Plane> planesOf(const FloatImage& image)
{
    std::vector<Plane> planes(3, Plane(image.pixels.size()));
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const glm::vec3 p = image.pixels[i];
        const auto inside = [](float v) { return v > 0.0f ? std::min(v, 1.0f) : 0.0f; };
        const glm::vec3 opponent = toOpponent({inside(p.x), inside(p.y), inside(p.z)});
        for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)][i] = opponent[c];
    }
    return planes;
}

/// What the eye resolves of a picture, in the space colours are compared in.
std::vector<glm::vec3> perceived(const std::vector<Plane>& planes, Size size, float pixelsPerDegree)
{
    const Plane y = seen(planes[0], size, kAchromatic, pixelsPerDegree);
    const Plane cx = seen(planes[1], size, kRedGreen, pixelsPerDegree);
    const Plane cz = seen(planes[2], size, kBlueYellow, pixelsPerDegree);
    std::vector<glm::vec3> out(size.count());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const glm::vec3 rgb = fromRelativeXyz() * relativeXyzOf({y[i], cx[i], cz[i]});
        out[i] = toHuntLab(toRelativeXyz(glm::clamp(rgb, 0.0f, 1.0f)));
    }
    return out;
}

/// Colour difference mapped to [0,1]: the span up to p_c of the largest takes p_t of the range.
float mappedDifference(float difference, float largest)
{
    const float powered = std::pow(difference, kColourExponent), split = kSplitAt * largest;
    if (powered < split) return kSplitTo / split * powered;
    return std::min(1.0f, kSplitTo + (powered - split) / (largest - split) * (1.0f - kSplitTo));
}

/// Strength of edges and of points (first and second derivative of a Gaussian as wide as the eye's detector).
struct Features {
    Plane edges, points;
};

Features featuresOf(const Plane& achromatic, Size size, float pixelsPerDegree)
{
    Plane normalised(achromatic.size());
    for (std::size_t i = 0; i < normalised.size(); ++i) normalised[i] = (achromatic[i] + 16.0f) / 116.0f;

    const float sigma = 0.5f * kFeatureWidth * pixelsPerDegree;
    const int radius = static_cast<int>(std::ceil(3.0f * sigma));
    const auto gauss = [&](float k) { return std::exp(-k * k / (2.0f * sigma * sigma)); };
    // across the derivative the kernel is a unit Gaussian; along it positive weights sum to 1, negative ones to -1
    std::vector<float> across = kernelOf(radius, gauss);
    for (const float sum = sumOf(across); float& w : across) w /= sum;
    const auto balanced = [](std::vector<float> kernel) {
        float up = 0.0f, down = 0.0f;
        for (const float w : kernel) (w > 0.0f ? up : down) += w;
        for (float& w : kernel) w /= w > 0.0f ? up : -down;
        return kernel;
    };
    const auto first = balanced(kernelOf(radius, [&](float k) { return -k * gauss(k); }));
    const auto second =
        balanced(kernelOf(radius, [&](float k) { return (k * k / (sigma * sigma) - 1.0f) * gauss(k); }));

    const auto magnitude = [&](const std::vector<float>& along) {
        Plane x = filterColumns(filterRows(normalised, size, along), size, across);
        const Plane y = filterColumns(filterRows(normalised, size, across), size, along);
        for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::hypot(x[i], y[i]);
        return x;
    };
    return {magnitude(first), magnitude(second)};
}

} // namespace

ScalarImage flipMap(const FloatImage& image, const FloatImage& reference, float pixelsPerDegree)
{
    assert(image.isSameSize(reference));
    const Size size{image.width, image.height};
    const std::vector<Plane> planesA = planesOf(image), planesB = planesOf(reference);
    const std::vector<glm::vec3> a = perceived(planesA, size, pixelsPerDegree);
    const std::vector<glm::vec3> b = perceived(planesB, size, pixelsPerDegree);
    const Features featuresA = featuresOf(planesA[0], size, pixelsPerDegree);
    const Features featuresB = featuresOf(planesB[0], size, pixelsPerDegree);
    const float largest =
        std::pow(hyab(toHuntLab(toRelativeXyz({0, 1, 0})), toHuntLab(toRelativeXyz({0, 0, 1}))), kColourExponent);

    ScalarImage map{image.width, image.height, {}};
    map.values.reserve(size.count());
    for (std::size_t i = 0; i < size.count(); ++i) {
        const float colour = mappedDifference(hyab(a[i], b[i]), largest);
        const float feature = std::max(std::abs(featuresA.edges[i] - featuresB.edges[i]),
                                       std::abs(featuresA.points[i] - featuresB.points[i]));
        const float strength = std::pow(std::min(1.0f, feature / std::sqrt(2.0f)), kFeatureExponent);
        map.values.push_back(std::pow(colour, 1.0f - strength));
    }
    return map;
}

double meanOf(const ScalarImage& map)
{
    if (map.values.empty()) return 0.0;
    double sum = 0;
    for (const float v : map.values) sum += double{v};
    return sum / static_cast<double>(map.values.size());
}

} // namespace lightloom
