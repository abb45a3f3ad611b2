// SPDX-License-Identifier: Apache-2.0
#include "core/base/rng.h"
#include "core/scene/cornell_walls.h"
#include "core/scene/sample_scenes.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace lightloom {
namespace {

/// One of twelve edge directions of a cube for a lattice point (Perlin 2002), dotted with `d`.
double gradient(std::int64_t x, std::int64_t y, std::int64_t z, glm::dvec3 d)
{
    const auto word = [](std::int64_t v) { return static_cast<std::uint64_t>(v); };
    const std::uint64_t h = mixBits(word(x) * 0x9E3779B97F4A7C15ull ^ mixBits(word(y) ^ mixBits(word(z)))) % 12;
    const double a = h < 8 ? d.x : d.y, b = h < 4 ? d.y : d.z;
    return ((h & 1u) != 0 ? -a : a) + ((h & 2u) != 0 ? -b : b);
}

/// Smooth noise with cells of size 1, about -1 .. 1, zero at lattice points. Sums and products only: the same bits on
/// every machine.
double noise(glm::dvec3 p)
{
    const glm::dvec3 cell = glm::floor(p), f = p - cell;
    const glm::dvec3 w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 o(corner & 1, (corner >> 1) & 1, corner >> 2);
        const double weight = (o.x ? w.x : 1.0 - w.x) * (o.y ? w.y : 1.0 - w.y) * (o.z ? w.z : 1.0 - w.z);
        const auto at = [&](int axis) { return static_cast<std::int64_t>(cell[axis]) + o[axis]; };
        sum += weight * gradient(at(0), at(1), at(2), f - glm::dvec3(o));
    }
    return sum;
}

/// Where the point of the unit sphere at `d` goes, metres. A star-shaped stone, then stretched, twisted and stood on a
/// flat foot: each step maps space one to one, so the surface never meets itself.
glm::vec3 displaced(glm::dvec3 d)
{
    double radius = 1.0, amplitude = 0.25, frequency = 1.3;
    for (int octave = 0; octave < 5; ++octave) {
        radius += amplitude * noise(frequency * d + glm::dvec3(17.3, 4.1, 9.7) * double(octave + 1));
        amplitude *= 0.42;
        frequency *= 2.13;
    }
    glm::dvec3 p = radius * d * glm::dvec3(1.0, 1.7, 1.0);
    const double waist = 0.92 - 0.14 * p.y, angle = 0.8 * p.y;
    const double c = std::cos(angle) * waist, s = std::sin(angle) * waist;
    p = {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
    const double foot = -1.35;
    if (p.y < foot) p.y = foot + 0.01 * (p.y - foot);
    const glm::dvec3 inBox = glm::dvec3(0.278, -0.001, 0.275) + 0.11 * (p - glm::dvec3(0.0, foot, 0.0));
    return glm::vec3(glm::round(inBox * 0x1p20) * 0x1p-20); // steps of a micrometre: libraries' last digits vanish
}

/// How many vertices each ring of latitude gets, pole to pole: `half` in all (twice that many triangles), each at least
/// 3, in proportion to its length.
std::vector<std::size_t> ringCounts(std::size_t half)
{
    const double pi = std::numbers::pi, area = 4.0 * pi / (2.0 * static_cast<double>(half));
    const double height = std::sqrt(area * std::sqrt(3.0)); // of an equilateral triangle of that area
    const double wanted = std::max(1.0, std::round(pi / height) - 1.0);
    const std::size_t rings =
        std::clamp<std::size_t>(static_cast<std::size_t>(wanted), 1, std::max<std::size_t>(half / 4, 1));
    std::vector<double> length(rings);
    double sum = 0.0;
    for (std::size_t r = 0; r < rings; ++r) {
        length[r] = std::sin(pi * static_cast<double>(r + 1) / static_cast<double>(rings + 1));
        sum += length[r];
    }
    std::vector<std::size_t> counts(rings);
    std::size_t used = 0;
    for (std::size_t r = 0; r < rings; ++r) {
        counts[r] = std::max<std::size_t>(3, static_cast<std::size_t>(length[r] / sum * static_cast<double>(half)));
        used += counts[r];
    }
    for (std::size_t k = 0; used != half; ++k) { // rounding's rest, spread over the long rings in the middle
        const std::size_t span = std::max<std::size_t>(1, rings / 2);
        std::size_t& count = counts[(rings - span) / 2 + k % span];
        if (used < half)
            ++count, ++used;
        else if (count > 3)
            --count, --used;
    }
    return counts;
}

/// Closed sphere-like mesh of exactly 2 * `half` triangles, nearly equilateral before displacement.
Mesh figureMesh(std::size_t half)
{
    const double pi = std::numbers::pi;
    const std::vector<std::size_t> counts = ringCounts(half);
    Mesh mesh;
    mesh.positions.push_back(displaced({0.0, 1.0, 0.0}));
    for (std::size_t r = 0; r < counts.size(); ++r) {
        const double polar = pi * static_cast<double>(r + 1) / static_cast<double>(counts.size() + 1);
        for (std::size_t i = 0; i < counts[r]; ++i) {
            const double around = 2.0 * pi * static_cast<double>(i) / static_cast<double>(counts[r]);
            const double s = std::sin(polar);
            mesh.positions.push_back(displaced({s * std::cos(around), std::cos(polar), s * std::sin(around)}));
        }
    }
    mesh.positions.push_back(displaced({0.0, -1.0, 0.0}));
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        mesh.triangles.emplace_back(static_cast<unsigned>(a), static_cast<unsigned>(b), static_cast<unsigned>(c));
    };
    const std::size_t last = mesh.positions.size() - 1;
    for (std::size_t i = 0; i < counts.front(); ++i) add(0, 1 + (i + 1) % counts.front(), 1 + i);
    std::size_t upper = 1;
    for (std::size_t r = 0; r + 1 < counts.size(); ++r) {
        const std::size_t n = counts[r], m = counts[r + 1], lower = upper + n;
        for (std::size_t i = 0, j = 0; i < n || j < m;) { // whichever ring is behind goes on
            if (j == m || (i < n && (i + 1) * m <= (j + 1) * n)) {
                add(upper + i, upper + (i + 1) % n, lower + j % m);
                ++i;
            } else {
                add(upper + i % n, lower + (j + 1) % m, lower + j);
                ++j;
            }
        }
        upper = lower;
    }
    const std::size_t end = counts.back();
    for (std::size_t i = 0; i < end; ++i) add(last, upper + i, upper + (i + 1) % end);
    return mesh;
}

void addSmoothNormals(Mesh& mesh)
{
    std::vector<glm::dvec3> sum(mesh.positions.size(), glm::dvec3(0.0));
    for (const glm::uvec3 t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const glm::dvec3 n = glm::cross(b - a, c - a); // long where the triangle is large
        sum[t.x] += n, sum[t.y] += n, sum[t.z] += n;
    }
    mesh.normals.reserve(sum.size());
    for (const glm::dvec3 n : sum) {
        const double length = glm::length(n);
        mesh.normals.push_back(length > 0.0 ? glm::vec3(n / length) : glm::vec3(0.0f, 1.0f, 0.0f));
    }
}

} // namespace

Result<Scene> figureScene(std::uint64_t triangles)
{
    if (triangles < kLeastFigureTriangles || triangles > kMostFigureTriangles) {
        return Error{Error::Kind::badInput, fmt::format("figure cannot have {} triangles; give {} to {}", triangles,
                                                        kLeastFigureTriangles, kMostFigureTriangles)};
    }
    SceneBuilder builder("figure");
    const CornellMaterials m = addCornellWalls(builder);
    Mesh figure = figureMesh((triangles - m.triangles) / 2);
    addSmoothNormals(figure);
    builder.add("Figure", std::move(figure), builder.addMaterial("plaster", {0.76f, 0.74f, 0.70f}));
    addCornellCameras(builder);
    builder.addCamera("Close to the figure", {0.12f, 0.36f, -0.05f}, {0.28f, 0.22f, 0.28f}, 50.0f);
    builder.setExposure(2.5f);
    return builder.finish();
}

} // namespace lightloom
