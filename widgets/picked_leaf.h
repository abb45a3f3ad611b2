// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "core/ivg/irradiance_grid.h"
#include "core/octree/leaf_pick.h"
#include "core/voxel/voxel_cuts.h"
#include <QMetaType>
#include <cstdint>

namespace lightloom {

struct BakeView;

/// What voxels know beside what a leaf of an octree does.
struct PickedVoxel {
    struct Entry {
        glm::vec3 direct{0.0f}, indirect{0.0f}; ///< lux that fall on it
        glm::vec3 radiosity{0.0f};              ///< lm/m2 that it sends on
    };
    int cells = 0;               ///< along the longest side of the scene
    std::vector<Entry> entries;  ///< as those of the leaf
    std::optional<Lightcut> cut; ///< that lights the point; nothing: another lookup does
    LightcutParams asked;        ///< of the cut
    glm::vec3 everyLight{0.0f};  ///< lux that all voxels one by one give the point, where the cut took some together
    std::size_t lights = 0;      ///< so many
    int samples = 0;             ///< voxels at random that light the point; 0: another lookup does
    glm::vec3 lux{0.0f};         ///< of these
};

/// What a grid of irradiance vectors knows of a place on a surface.
struct PickedGrid {
    glm::vec3 point{0.0f}, normal{0.0f};
    GridLattice lattice;               ///< that lights it most, the finer one inside or the outer
    bool isInside = false;             ///< it is the finer one
    glm::vec3 lux{0.0f};               ///< indirect, on this surface
    bool isLit = false;                ///< there is an answer
    float noise = -1.0f;               ///< lux; negative: not known
    std::vector<glm::vec3> vertices;   ///< that light it, scene space
    std::array<glm::vec3, 6> around{}; ///< lux there on what faces -x +x -y +y -z +z
};

/// A leaf that was picked in the viewport, and where its light came from.
struct PickedLeaf {
    /// Nothing: the point lies in none. Of voxels by lightcuts the entry that answers has the point's light, in at most
    /// eight directions.
    std::optional<LeafPick> leaf;
    std::optional<PickedVoxel> voxel;           ///< nothing: the leaf is an octree's
    std::optional<PickedGrid> grid;             ///< of a grid, which has no leaves
    std::vector<glm::vec3> photons;             ///< gathered for the entry that answers, all lamps that are on
    std::shared_ptr<const IndirectField> field; ///< that was asked
};

/// What `view` keeps at `p` facing `n`. Some milliseconds; any thread.
[[nodiscard]] PickedLeaf pickedLeaf(const BakeView& view, glm::vec3 p, glm::vec3 n);

} // namespace lightloom

Q_DECLARE_METATYPE(lightloom::PickedLeaf)
