// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/ray_scene.h"
#include <array>
#include <atomic>
#include <memory>

namespace lightloom {

/// A point that catches photons: those that cross the disc around it from its front.
struct CatchPoint {
    glm::vec3 position, normal; ///< normal unit
    float radius = 0.0f;        ///< metres
};

/// Discs that count the light crossing them: E = flux / (pi r^2), averaged over the disc, on surfaces and in mid-air
/// alike. Any number of threads may send light; sums are whole numbers of a power of two of flux, so the order does not
/// matter and the bits are the same.
class CausticDiscs {
public:
    static constexpr std::size_t kCells = 8; ///< equal parts of a disc: two rings of four quarters

    /// `scale`: flux that the sums stay below, lumen.
    CausticDiscs(const RayScene& rays, const std::vector<CatchPoint>& points, double scale);
    ~CausticDiscs();
    CausticDiscs(const CausticDiscs&) = delete;
    CausticDiscs& operator=(const CausticDiscs&) = delete;

    /// Light that goes from `from` to `to`; `past` metres further, so that a disc on the surface at `to` is crossed.
    void send(glm::vec3 from, glm::vec3 to, float past, glm::vec3 flux) const;

    [[nodiscard]] glm::dvec3 illuminance(std::size_t point) const; ///< lux per channel
    /// Luminance of the illuminance (lux) on each of the disc's parts.
    [[nodiscard]] std::array<double, kCells> parts(std::size_t point) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The largest radius up to `most` (at least a fiftieth of it) at which the disc around the point lies free of other
/// surfaces: what stands on a floor must not shade the part of a disc that reaches behind it.
[[nodiscard]] float clearRadius(const RayScene& rays, glm::vec3 position, glm::vec3 normal, float most);

} // namespace lightloom
