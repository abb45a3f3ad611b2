// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/irradiance_vectors.h"
#include "core/base/units.h"
#include <cmath>
#include <vector>

namespace lightloom {
namespace {

constexpr std::size_t kNumbers = 18, kTerms = 9;

/// Integral of |x|^i |y|^j z^k over the hemisphere z > 0: a quotient of gamma functions.
double hemisphereMoment(int i, int j, int k)
{
    const auto half = [](int power) { return std::tgamma(0.5 * (power + 1)); };
    return half(i) * half(j) * half(k) / std::tgamma(0.5 * (i + j + k + 3));
}

/// A polynomial in x, y, z as powers with factors; the nine terms of second order, each orthogonal to the others.
struct Power {
    double factor;
    std::array<int, 3> power;
};
const std::array<std::vector<Power>, kTerms>& terms()
{
    static const std::array<std::vector<Power>, kTerms> all{{{{1.0, {0, 0, 0}}},
                                                             {{1.0, {1, 0, 0}}},
                                                             {{1.0, {0, 1, 0}}},
                                                             {{1.0, {0, 0, 1}}},
                                                             {{1.0, {1, 1, 0}}},
                                                             {{1.0, {0, 1, 1}}},
                                                             {{1.0, {1, 0, 1}}},
                                                             {{1.0, {2, 0, 0}}, {-1.0, {0, 2, 0}}},
                                                             {{3.0, {0, 0, 2}}, {-1.0, {0, 0, 0}}}}};
    return all;
}

/// Integral of a term times w_component over the hemisphere around a direction.
double vectorOf(const std::vector<Power>& term, std::size_t direction, int component)
{
    const int axis = static_cast<int>(direction / 2);
    const double sign = direction % 2 == 0 ? -1.0 : 1.0;
    double sum = 0.0;
    for (const Power& p : term) {
        std::array<int, 3> power = p.power;
        ++power[static_cast<std::size_t>(component)];
        const int along = power[static_cast<std::size_t>(axis)];
        const int u = power[static_cast<std::size_t>((axis + 1) % 3)],
                  v = power[static_cast<std::size_t>((axis + 2) % 3)];
        if (u % 2 != 0 || v % 2 != 0) continue; // odd across the hemisphere
        sum += p.factor * (along % 2 != 0 ? sign : 1.0) * hemisphereMoment(u, v, along);
    }
    return sum;
}

/// What a clamped cosine leaves of each order (Ramamoorthi and Hanrahan 2001).
double cosineFactor(std::size_t term)
{
    constexpr double pi = std::numbers::pi;
    return term == 0 ? pi : term < 4 ? 2.0 * pi / 3.0 : 0.25 * pi;
}

using Fit = std::array<std::array<float, kNumbers>, kTerms>;

/// From the 18 numbers of a channel to the nine of its irradiance: least squares by the normal equations (condition
/// 2.9), solved by elimination, each term then convolved with the cosine.
Fit makeFit()
{
    std::array<std::array<double, kTerms>, kNumbers> model;
    for (std::size_t row = 0; row < kNumbers; ++row) {
        for (std::size_t t = 0; t < kTerms; ++t)
            model[row][t] = vectorOf(terms()[t], row / 3, static_cast<int>(row % 3));
    }
    std::array<std::array<double, kTerms + kNumbers>, kTerms> rows{};
    for (std::size_t i = 0; i < kTerms; ++i) {
        for (std::size_t j = 0; j < kTerms; ++j) {
            for (const auto& row : model) rows[i][j] += row[i] * row[j];
        }
        for (std::size_t k = 0; k < kNumbers; ++k) rows[i][kTerms + k] = model[k][i];
    }
    for (std::size_t pivot = 0; pivot < kTerms; ++pivot) { // positive definite: no need to choose pivots
        const double scale = 1.0 / rows[pivot][pivot];
        for (double& x : rows[pivot]) x *= scale;
        for (std::size_t i = 0; i < kTerms; ++i) {
            if (i == pivot) continue;
            const double factor = rows[i][pivot];
            for (std::size_t k = 0; k < kTerms + kNumbers; ++k) rows[i][k] -= factor * rows[pivot][k];
        }
    }
    Fit fit;
    for (std::size_t t = 0; t < kTerms; ++t) {
        for (std::size_t k = 0; k < kNumbers; ++k)
            fit[t][k] = static_cast<float>(cosineFactor(t) * rows[t][kTerms + k]);
    }
    return fit;
}

glm::vec3 componentOf(const IrradianceVectors& vectors, std::size_t direction, int component)
{
    const glm::mat3& v = vectors[direction];
    return {v[0][component], v[1][component], v[2][component]};
}

glm::vec3 fitted(std::size_t term, const IrradianceVectors& vectors)
{
    static const Fit fit = makeFit();
    glm::vec3 sum(0.0f);
    for (std::size_t k = 0; k < kNumbers; ++k)
        sum += fit[term][k] * componentOf(vectors, k / 3, static_cast<int>(k % 3));
    return sum;
}

} // namespace

glm::vec3 alongAxis(const IrradianceVectors& vectors, std::size_t d)
{
    return componentOf(vectors, d, static_cast<int>(d / 2)) * (d % 2 == 0 ? -1.0f : 1.0f);
}

std::span<const RemapPart> remapParts(GridRemap remap)
{
    static constexpr std::array<RemapPart, 4> kJoined{{{0, 2, 0}, {2, 2, 1}, {4, 2, 2}, {6, 6, -1}}};
    static constexpr std::array<RemapPart, 1> kHarmonic{{{0, 9, -1}}};
    static constexpr std::array<RemapPart, 3> kPaper{{{0, 6, 0}, {6, 6, 1}, {12, 6, 2}}};
    switch (remap) {
    case GridRemap::joined:
        return kJoined;
    case GridRemap::harmonic:
        return kHarmonic;
    case GridRemap::flux:
        return std::span(kJoined).first(3);
    case GridRemap::paper:
        break;
    }
    return kPaper;
}

void keepForRemap(GridRemap remap, const IrradianceVectors& vectors, std::span<glm::vec3> kept)
{
    if (remap == GridRemap::paper) {
        for (std::size_t k = 0; k < kNumbers; ++k) kept[k] = componentOf(vectors, k / 3, static_cast<int>(k % 3));
        return;
    }
    if (remap == GridRemap::harmonic) {
        for (std::size_t t = 0; t < kTerms; ++t) kept[t] = fitted(t, vectors);
        return;
    }
    for (std::size_t d = 0; d < 6; ++d) kept[d] = alongAxis(vectors, d);
    if (remap == GridRemap::flux) return;
    for (std::size_t t = 0; t < 6; ++t) kept[6 + t] = fitted(1 + t, vectors);
}

RemapForm remapForm(GridRemap remap, const RemapPart& part, const glm::vec3& n)
{
    RemapForm form;
    if (part.axis < 0) {
        if (remap == GridRemap::harmonic) {
            const std::array<float, kTerms> terms{
                1.0f, n.x, n.y, n.z, n.x * n.y, n.y * n.z, n.z * n.x, n.x * n.x - n.y * n.y, 3.0f * n.z * n.z - 1.0f};
            for (std::size_t t = 0; t < terms.size(); ++t) form.add(t, terms[t]);
            return form;
        }
        // On the axes flux is exact, and what lies behind the surface does not count there; harmonics know how light
        // goes on between them. Of H(n) - sum of n_a^2 H(+-a), which is 0 on the axes, all but these terms cancel.
        const glm::vec3 linear = n * (1.0f - glm::abs(n));
        const std::array<float, 6> between{linear.x, linear.y, linear.z, n.x * n.y, n.y * n.z, n.z * n.x};
        for (std::size_t t = 0; t < between.size(); ++t) form.add(part.first + t, between[t]);
        return form;
    }
    const std::size_t side = sideOf(part.axis, n);
    const float square = n[part.axis] * n[part.axis];
    if (remap != GridRemap::paper) {
        form.add(side, square);
        return form;
    }
    for (std::size_t c = 0; c < 3; ++c) form.add(3 * side + c, square * n[static_cast<int>(c)]);
    return form;
}

glm::vec3 remapIrradiance(GridRemap remap, std::span<const glm::vec3> kept, const glm::vec3& n)
{
    glm::vec3 sum(0.0f);
    for (const RemapPart& part : remapParts(remap)) sum += remapForm(remap, part, n).of(kept);
    return sum;
}

} // namespace lightloom
