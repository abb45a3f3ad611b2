// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include "core/photonmap/photon_map.h"
#include "core/photonmap/surface_area.h"
#include <optional>

namespace lightloom {

/// One orientation of a picked leaf, with its light under the octree's mix.
struct PickedEntry {
    OctreeEntry surface;
    std::vector<Vdl> lights; ///< all lamps' lights, merged as the window shows them; black ones left out; of a colour
                             ///< octree none
    glm::vec3 lux{0.0f};     ///< on a surface that faces along the entry's normal
};

/// What an octree keeps where a point lies, for whoever wants to look inside.
struct LeafPick {
    glm::vec3 point{0.0f}, normal{0.0f}; ///< that were asked for, scene space
    int depth = 0;
    glm::ivec3 cell{0};
    glm::vec3 low{0.0f}, high{0.0f}; ///< corners of the cell
    std::vector<PickedEntry> entries;
    int answers = -1;    ///< number of the entry that answers for `normal`; -1: none does
    glm::vec3 lux{0.0f}; ///< indirect, at the point, interpolated
    bool isLit = false;  ///< there is an answer at the point
};

/// Nothing where the point lies in no leaf.
[[nodiscard]] std::optional<LeafPick> pickLeaf(const LightOctree& octree, glm::vec3 p, glm::vec3 n);

/// Positions of the photons of one light group that the bake gathered for an entry of the leaf: the bake's own gather,
/// run again on this leaf alone. `map` and `params` as baked.
[[nodiscard]] std::vector<glm::vec3> gatheredPhotons(const LightOctree& octree, const LeafPick& leaf, int entry,
                                                     const PhotonMap& map, const SurfaceArea& area,
                                                     const BakeParams& params);

} // namespace lightloom
