// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/compare/legend.h"
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace lightloom {

class VoxelField;

/// What voxels are coloured by over the picture.
enum class VoxelMarks { none, radiosity, area, normal };

/// Entries of surface voxels as discs of their area, the lights of a lightcut. Never changed once made.
struct VoxelDiscs {
    struct Disc {
        glm::vec3 centre{0.0f}; ///< scene space
        float radius = 0.0f;    ///< metres
        glm::vec3 normal{0.0f};
        glm::u8vec4 colour{0}; ///< as shown
    };
    std::vector<Disc> discs; ///< by entry
    float cellSize = 0.0f;   ///< metres
    VoxelMarks by = VoxelMarks::none;
    HeatmapStyle scale; ///< of the colours, but of normals: lm/m2, logarithmic; or of a cell's face
};

/// `radiosity`: luminance of what an entry sends on of all its light, under the field's mix; `area`: over a cell's
/// face; both in false colour. `normal`: x y z from -1 to 1 as red, green and blue. Null for `none`.
[[nodiscard]] std::shared_ptr<const VoxelDiscs> voxelDiscs(const VoxelField& field, VoxelMarks by);

} // namespace lightloom
