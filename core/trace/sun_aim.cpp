// SPDX-License-Identifier: Apache-2.0
#include "core/trace/sun_aim.h"
#include "core/base/hash.h"
#include "core/base/sampling.h"
#include "core/base/units.h"
#include "core/trace/material.h"
#include <algorithm>
#include <cmath>
#include <limits>

namespace lightloom {
namespace {

constexpr std::uint32_t kSide = 64, kCells = kSide * kSide; ///< of equal area: squared radius times angle
constexpr std::uint32_t kRays = 4, kBounces = 4;            ///< per cell, and from each surface one of them meets
constexpr double kEven = 0.15;                              ///< chance that a photon is shot evenly
constexpr float kFar = std::numeric_limits<float>::infinity();

/// Within the unit square that `onDisc` takes.
glm::vec2 inCell(std::uint32_t cell, float u1, float u2)
{
    return {(static_cast<float>(cell / kSide) + u1) / static_cast<float>(kSide),
            (static_cast<float>(cell % kSide) + u2) / static_cast<float>(kSide)};
}

/// Over a cell and its eight neighbours: where little is passed on, the few rays of one cell may all miss it, and the
/// photons that are shot there all the same would be as heavy as twenty others.
double meanAround(const std::vector<double>& of, std::uint32_t cell)
{
    const std::uint32_t ring = cell / kSide, sector = cell % kSide;
    double sum = 0.0;
    int count = 0;
    for (std::uint32_t r = ring > 0 ? ring - 1 : 0; r <= std::min(ring + 1, kSide - 1); ++r) {
        for (const std::uint32_t s : {sector + kSide - 1, sector, sector + 1}) {
            sum += of[r * kSide + s % kSide];
            ++count;
        }
    }
    return sum / count;
}

} // namespace

SunAim::SunAim(const RayScene& rays, glm::vec3 travel, glm::vec3 centre, float radius)
    : travel_(travel), centre_(centre), radius_(radius)
{
    sums_.resize(kCells);
    std::vector<double> passed(kCells);
    for (std::uint32_t cell = 0; cell < kCells; ++cell) passed[cell] = passedOn(rays, cell);
    double all = 0.0;
    for (std::uint32_t cell = 0; cell < kCells; ++cell) sums_[cell] = all += std::sqrt(meanAround(passed, cell));
    for (std::uint32_t cell = 0; cell < kCells; ++cell) {
        const double even = static_cast<double>(cell + 1) / kCells;
        sums_[cell] = all > 0.0 ? (1.0 - kEven) * sums_[cell] / all + kEven * even : even;
    }
}

glm::vec3 SunAim::onDisc(glm::vec2 u) const
{
    const glm::vec2 d = radius_ * sampleDisc(u.x, u.y);
    return centre_ + Frame(travel_).toWorld({d.x, d.y, -2.0f * radius_});
}

/// Part of a cell's light that arrives at a second surface.
double SunAim::passedOn(const RayScene& rays, std::uint32_t cell) const
{
    Rng rng(0, hashName("sun aim"), cell);
    double sum = 0.0;
    for (std::uint32_t i = 0; i < kRays; ++i) {
        const float u1 = rng.uniform(), u2 = rng.uniform();
        Hit hit;
        if (!rays.intersect(onDisc(inCell(cell, u1, u2)), travel_, kFar, hit)) continue;
        const Surface surface = surfaceAt(rays, hit);
        const float reflected = luminance(surface.diffuse + surface.specular);
        const Frame frame(hit.facing());
        const glm::vec3 origin = rays.leave(hit.position, hit.facing());
        std::uint32_t met = 0;
        for (std::uint32_t j = 0; j < kBounces; ++j) {
            const float v1 = rng.uniform(), v2 = rng.uniform();
            Hit next;
            met += rays.intersect(origin, frame.toWorld(sampleCosineHemisphere(v1, v2)), kFar, next) ? 1 : 0;
        }
        sum += static_cast<double>(reflected) * met / kBounces;
        if (!(surface.glass.share > 0.0f)) continue;
        // straight on through glass, whatever it bends: near enough for an aim
        Hit beyond;
        if (rays.intersect(rays.leave(hit.position, -hit.facing()), travel_, kFar, beyond))
            sum += static_cast<double>(surface.glass.share);
    }
    return sum / kRays;
}

glm::vec3 SunAim::pick(Rng& rng, float& weight) const
{
    const double at = rng.uniformDouble();
    const auto found = std::ranges::upper_bound(sums_, at);
    const auto cell = static_cast<std::uint32_t>(std::min<std::ptrdiff_t>(found - sums_.begin(), kCells - 1));
    const double chance = sums_[cell] - (cell > 0 ? sums_[cell - 1] : 0.0);
    weight = static_cast<float>(1.0 / (kCells * chance));
    const float u1 = rng.uniform(), u2 = rng.uniform();
    return onDisc(inCell(cell, u1, u2));
}

} // namespace lightloom
