// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/ivg/irradiance_grid.h"

namespace lightloom {

/// How textures hold a grid's numbers: as they are, or (remap `paper` alone) the three vectors of each direction as one
/// colour, their lengths, and one direction, that of their sum (RR-6983, section 4.2).
enum class GridPacking { exact, compressed };

/// An irradiance grid as the plain arrays that 3D textures are made from: the mixture of its layers under its mix, and
/// what its look-up rule needs (shaders/mode_ivg.frag).
///
/// `light` is one RGBA16F texture of slabs, each a texel per vertex. Slab s stands at lattice.vertices() times
/// (s % slabs.x, s / slabs.x % slabs.y, s / (slabs.x * slabs.y)). By direction d (-x +x -y +y -z +z) come `sideTexels`
/// slabs each, then `sharedTexels`, then one per direction if `hasSlopes`:
///   flux, joined  side: I_d . d, A: trust of its axis; slopes: of that along d per cell, A unused
///   paper         side: x, y and z of the vectors, each RGB, A: trust
///   compressed    side: lengths, A: trust; direction xyz, A unused
///   joined        shared: 18 numbers of the six terms between the axes, then their trust
///   harmonic      shared: 27 numbers of the nine terms, then their trust
/// Numbers are multiplied by the trust beside them and divided by `scale`, so that weighted sums and their weights come
/// from the same reads, filtered or not: sum of texels times their weights, divided by the sum's trust, times `scale`.
///
/// `sight` is RGBA16UI, a texel per vertex: R, G, B its sight along x, y, z (GridOpenness::sight; low byte the negative
/// way), A: 1 if the vertex knows any light. `places`, RGBA32F, where the B-spline meets slopes: xyz trust of the
/// axis times vertex number along it; a half could not tell far vertices apart. Otherwise empty.
struct GpuGrid {
    GridLattice lattice;
    GridShow show;
    GridPacking packing = GridPacking::exact;
    int sideTexels = 1, sharedTexels = 0;
    bool hasSlopes = true;
    glm::ivec3 slabs{1};              ///< along the axes of the texture
    float scale = 1.0f;               ///< power of two that keeps numbers within half floats
    std::vector<std::uint16_t> light; ///< 4 * size().x * size().y * size().z
    std::vector<std::uint16_t> sight; ///< 4 by vertex
    std::vector<float> places;        ///< 4 by vertex, or none
    std::size_t openVertices = 0;     ///< that know light

    std::shared_ptr<const GpuGrid> inside; ///< a finer grid within, in the same form; null: there is none
    Bounds box;                            ///< where it answers, scene space (GridInside)
    float fade = 0.0f;                     ///< metres, from the box's faces

    [[nodiscard]] glm::ivec3 size() const { return slabs * lattice.vertices(); } ///< texels of `light`
    [[nodiscard]] int slabCount() const { return 6 * sideTexels + sharedTexels + (hasSlopes ? 6 : 0); }
    [[nodiscard]] std::size_t memoryBytes() const ///< with that of the grid inside
    {
        return 2 * (light.size() + sight.size()) + 4 * places.size() + (inside ? inside->memoryBytes() : 0);
    }
};

/// With the finer grid inside, if there is one. Errors: `compressed` asked of another remap than `paper`; more texels
/// than memory can hold (says how many).
[[nodiscard]] Result<GpuGrid> makeGpuGrid(const IrradianceGrid& grid, GridPacking packing = GridPacking::exact);

/// How many slabs along each axis, at least `count` in all, so that the longest side of the texture is shortest.
[[nodiscard]] glm::ivec3 slabBox(glm::ivec3 vertices, int count);

} // namespace lightloom
