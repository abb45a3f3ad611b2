// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/photonmap/photon_map.h"
#include <array>
#include <span>

namespace lightloom {

/// Sums over the photons of a kernel, in order, with positions in the plane through `p` across unit `n`.
class PhotonSums {
public:
    PhotonSums(const PhotonMap& map, glm::vec3 p, glm::vec3 n);

    void add(std::span<const std::uint32_t> numbers) { add(place_, numbers.data(), numbers.size(), sums_.data()); }

    /// Illuminance by weights w.x + w.y x + w.z y per photon, 1/m2.
    [[nodiscard]] glm::dvec3 lux(glm::dvec3 w) const;
    [[nodiscard]] double value(glm::dvec3 w) const; ///< its luminance
    /// Standard error of the value: photons arrive like rain.
    [[nodiscard]] double noise(glm::dvec3 w) const;

private:
    struct Place {
        const Photon* photons;
        float p[3], tangent[3], bitangent[3];
    };
    /// Four numbers each: flux per channel times 1, x, y; squared luminous flux times (1, x, y) and (xx, xy, yy).
    enum Row { flux, fluxX, fluxY, squares, squaresSecond, rows };
    static void add(const Place& place, const std::uint32_t* numbers, std::size_t count, double* sums);
    [[nodiscard]] double at(Row row, std::size_t i) const { return sums_[4 * row + i]; }
    [[nodiscard]] glm::dvec3 row(Row row) const { return {at(row, 0), at(row, 1), at(row, 2)}; }

    Place place_;
    alignas(32) std::array<double, 4 * rows> sums_{};
};

} // namespace lightloom
