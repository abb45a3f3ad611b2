// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/trace/ray_scene.h"
#include <array>
#include <utility>
#include <vector>

namespace lightloom {

/// Faces of one instance, all seen from the same side, welded where positions are equal to the bit. Corners run
/// counter-clockwise as seen from that side.
struct PatchMesh {
    std::vector<std::uint32_t> sides;           ///< 2 * triangle, + 1 for its back
    std::vector<glm::uvec3> corners;            ///< into `positions`
    std::vector<std::uint8_t> isTurned;         ///< per face: its corners are a, c, b of the triangle
    std::vector<glm::dvec3> positions, normals; ///< scene space; normals per face, unit
    std::vector<double> areas;                  ///< m2, per face
};

/// A connected piece of it, a chart to be.
struct Patch {
    const PatchMesh* mesh = nullptr;
    std::vector<std::uint32_t> faces; ///< into the mesh's, rising
    /// Per face: the faces (numbers within the patch) across its edges 0-1, 1-2 and 2-0; -1: border, crease, or an edge
    /// that is not shared by exactly two.
    std::vector<std::array<std::int32_t, 3>> neighbours;
};

/// `sides` of one instance and one kind (front or back), rising; faces without area are left out.
[[nodiscard]] PatchMesh patchMesh(const RayScene& rays, const std::vector<std::uint32_t>& sides);

/// Connected pieces, joined across edges where the surface bends by less than `kCreaseCosine`.
[[nodiscard]] std::vector<Patch> connectedPatches(const PatchMesh& mesh);

/// Cuts a patch of at least two faces into two connected ones that grow from two distant faces, Voronoi fashion: each
/// face goes to the nearer one, where steps across bends are long. O(n log n).
[[nodiscard]] std::pair<Patch, Patch> halved(const Patch& patch);

inline constexpr double kCreaseCosine = 0.64; ///< 50 degrees
} // namespace lightloom
