// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_fit.h"
#include "core/base/units.h"
#include <algorithm>

namespace lightloom {
namespace {

constexpr float kLeast = 0.25f, kMost = 4.0f; ///< of what a value was
/// Of a cell's face: as much surface that reads a direction counts as much as what the air says. Less is hardly
/// evidence: in creases few small patches of a cell face a way, and which ones depends on the finest carving.
constexpr float kLittleSurface = 0.01f;
constexpr std::size_t kBlock = 256; ///< patches

/// How one patch reads the grid, and what it misses there.
struct Reading {
    struct Corner {
        std::uint32_t vertex;
        glm::vec3 part; ///< by axis, of the patch's whole light
    };
    std::array<Corner, 8> corners; ///< trilinear: no more
    std::size_t count = 0;
    std::array<std::uint8_t, 3> side{}; ///< by axis: the direction that is read
    glm::vec3 missing{0.0f};            ///< lux
};

Reading readingOf(const IrradianceGrid& grid, const SurfacePatch& patch, const glm::vec3& illuminance)
{
    Reading reading;
    glm::vec3 lux;
    GridCorners corners;
    if (!grid.findCorners(patch.position, patch.normal, corners) || !grid.lookup(patch.position, patch.normal, lux))
        return reading;
    glm::vec3 sum(0.0f);
    for (const GridCorner& c : corners) {
        const glm::vec3 weight =
            c.weight * glm::vec3(grid.trust(c.vertex, 0), grid.trust(c.vertex, 1), grid.trust(c.vertex, 2));
        if (weight == glm::vec3(0.0f)) continue;
        reading.corners[reading.count++] = {static_cast<std::uint32_t>(c.vertex), weight};
        sum += weight;
    }
    glm::vec3 perAxis(0.0f);
    float known = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
        reading.side[static_cast<std::size_t>(axis)] = static_cast<std::uint8_t>(sideOf(axis, patch.normal));
        if (sum[axis] <= 0.0f) continue;
        const float square = patch.normal[axis] * patch.normal[axis];
        perAxis[axis] = square / sum[axis];
        known += square;
    }
    if (known <= 0.0f) {
        reading.count = 0;
        return reading;
    }
    for (std::size_t i = 0; i < reading.count; ++i) reading.corners[i].part *= perAxis / known;
    reading.missing = illuminance - lux;
    return reading;
}

} // namespace

SurfaceFit fitToSurface(const IrradianceGrid& grid, const GridSurface& surface, std::span<const LandedLight> landed,
                        Workers& workers)
{
    const std::vector<SurfacePatch>& patches = surface.patches();
    std::vector<Reading> readings(patches.size());
    workers.run((patches.size() + kBlock - 1) / kBlock, {}, [&](std::size_t block) {
        for (std::size_t i = block * kBlock; i < std::min(patches.size(), (block + 1) * kBlock); ++i)
            readings[i] = readingOf(grid, patches[i], landed[i].illuminance);
    });

    const std::size_t count = grid.geometry().lattice.vertexCount();
    std::vector<std::array<float, 6>> weights(count, std::array<float, 6>{});
    SurfaceFit fit;
    fit.correction.assign(count, std::array<glm::vec3, 6>{});
    fit.variance.assign(count, std::array<float, 6>{});
    fit.fitted.assign(count, 0);
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const Reading& reading = readings[i];
        for (std::size_t k = 0; k < reading.count; ++k) {
            const Reading::Corner& corner = reading.corners[k];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const float weight = patches[i].area * corner.part[static_cast<int>(axis)];
                fit.correction[corner.vertex][reading.side[axis]] += weight * reading.missing;
                weights[corner.vertex][reading.side[axis]] += weight;
                // not by area: of the least patches there is next to nothing
                const float part = corner.part[static_cast<int>(axis)];
                fit.variance[corner.vertex][reading.side[axis]] += part * part * landed[i].fluxVariance;
            }
        }
    }
    for (std::size_t v = 0; v < count; ++v) {
        for (std::size_t d = 0; d < 6; ++d) {
            const float weight = weights[v][d];
            if (weight <= 0.0f) continue;
            const float little = kLittleSurface * grid.geometry().lattice.faceArea(static_cast<int>(d / 2));
            const float trusted = weight / (weight + little);
            glm::vec3& correction = fit.correction[v][d];
            const glm::vec3 value = grid.keptAt(v)[d]; // flux comes first in `joined`
            correction = trusted * glm::clamp(correction / weight, (kLeast - 1.0f) * value, (kMost - 1.0f) * value);
            // no more than the clamp lets through, also where there is next to no surface
            const float most = kMost * luminance(value);
            const double parts = static_cast<double>(fit.variance[v][d]), sum = static_cast<double>(weight);
            const auto ofSurface = static_cast<float>(
                std::min(parts / (sum * sum), static_cast<double>(most) * static_cast<double>(most)));
            const float air = 1.0f - trusted;
            fit.variance[v][d] = trusted * trusted * ofSurface + air * air * grid.variance(v)[d];
            fit.fitted[v] = static_cast<std::uint8_t>(fit.fitted[v] | 1u << d);
        }
    }
    return fit;
}

} // namespace lightloom
