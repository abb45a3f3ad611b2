// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/transport/surface_voxels.h"
#include <array>

namespace lightloom {

/// How surface bends away from its tangent plane about an entry: its curvature along a unit direction t of that plane
/// is least + (most . t)^2, per cell; none where it is hollow.
struct SurfaceBend {
    float least = 0.0f;
    glm::vec3 most{0.0f};
};

/// How a scene's surface bends, entry by entry, by what is in the voxel and in the 26 about it.
struct SurfaceBends {
    /// Normals beyond edges that are open outwards, the rest 0.
    using Edges = std::array<glm::vec3, 4>;
    std::vector<SurfaceBend> bends;    ///< by least squares over the normals of like entries
    std::vector<std::uint32_t> number; ///< of an entry's edges in `edges`; 0: none
    std::vector<Edges> edges;
    [[nodiscard]] bool isBent(std::size_t entry) const
    {
        return bends[entry].least > 0.0f || bends[entry].most != glm::vec3(0.0f) || number[entry] != 0;
    }
};

/// O(voxels).
[[nodiscard]] SurfaceBends surfaceBends(const SurfaceVoxels& voxels);

} // namespace lightloom
