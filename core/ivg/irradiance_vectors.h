// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/params/grid_choices.h"
#include <array>
#include <glm/glm.hpp>
#include <span>

/// Irradiance vectors and what follows from them for a surface (RR-6983, sections 3.2 and 4.1; docs/methods).
namespace lightloom {

/// I_delta, the integral of L w over the hemisphere around delta, w pointing to where the light comes from, for delta =
/// -x +x -y +y -z +z; columns R, G, B; lux.
using IrradianceVectors = std::array<glm::mat3, 6>;
/// Index of the vector on the side of `axis` that `n` faces.
[[nodiscard]] inline std::size_t sideOf(int axis, const glm::vec3& n)
{
    return static_cast<std::size_t>(2 * axis + (n[axis] < 0.0f ? 0 : 1));
}

/// I_delta . delta, lux per channel: the irradiance of a surface that faces direction `d`.
[[nodiscard]] glm::vec3 alongAxis(const IrradianceVectors& vectors, std::size_t d);

/// Numbers kept per vertex and channel for a remap.
[[nodiscard]] constexpr std::size_t remapSize(GridRemap remap)
{
    constexpr std::array<std::size_t, 4> kSizes{12, 9, 6, 18};
    return kSizes[static_cast<std::size_t>(remap)];
}

/// The numbers kept of a remap fall into parts that may be known or not each on its own, where walls stand in the way:
/// one per axis, and one that needs all three.
struct RemapPart {
    std::size_t first, count; ///< of the numbers kept
    int axis;                 ///< 0 to 2; -1: all
};
[[nodiscard]] std::span<const RemapPart> remapParts(GridRemap remap);

/// What a remap keeps of six vectors: remapSize vec3, RGB each. All of them are linear in the vectors, so that weighted
/// sums may be taken before or after.
///   joined    I_delta . delta per direction; then of the harmonics x, y, z, xy, yz, zx
///   harmonic  of the irradiance as a function of the normal: 1, x, y, z, xy, yz, zx, x2 - y2, 3 z2 - 1
///   flux      I_delta . delta per direction
///   paper     the vectors, direction by direction, x y z
void keepForRemap(GridRemap remap, const IrradianceVectors& vectors, std::span<glm::vec3> kept);

/// What a part adds to the irradiance of a surface: a sum of numbers kept, each times a factor that only the normal
/// decides. Of a surface that faces along an axis few are left, or none.
class RemapForm {
public:
    struct Term {
        std::size_t number; ///< of those kept of a vertex
        float factor;
    };
    void add(std::size_t number, float factor)
    {
        if (factor != 0.0f) terms_[count_++] = {number, factor};
    }
    [[nodiscard]] bool isEmpty() const { return count_ == 0; }
    /// Lux per channel; `kept` is all of a vertex.
    [[nodiscard]] glm::vec3 of(std::span<const glm::vec3> kept) const
    {
        glm::vec3 sum(0.0f);
        for (std::size_t i = 0; i < count_; ++i) sum += terms_[i].factor * kept[terms_[i].number];
        return sum;
    }

private:
    std::array<Term, 9> terms_;
    std::size_t count_ = 0;
};

/// For a surface that faces `n` (unit). A part of an axis stands for n_axis^2 of the whole; one of all axes for
/// everything in `harmonic`, and for a correction that is 0 on the axes in `joined`. Harmonics may give values below 0.
[[nodiscard]] RemapForm remapForm(GridRemap remap, const RemapPart& part, const glm::vec3& n);
/// The sum of all parts.
[[nodiscard]] glm::vec3 remapIrradiance(GridRemap remap, std::span<const glm::vec3> kept, const glm::vec3& n);

} // namespace lightloom
