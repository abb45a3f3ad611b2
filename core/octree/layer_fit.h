// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include "core/octree/vdl_cluster.h"
#include "core/photonmap/density.h"

namespace lightloom {

/// Drops what an adaptive layer did not use. Others stay as they are.
void dropUnused(VdlLayer& layer);

/// What one thread needs to fit entries.
struct FitScratch {
    Gathered gathered; ///< of the entry that was fitted last: photons that its directions come from
    ClusterScratch clusters;
    std::vector<LightVector> lights;
    Density density;    ///< of the entry that was fitted last
    bool isFew = false; ///< `gathered` reaches further than leaves of this depth should, to hold enough photons
    Density near;       ///< then: within the width that they should have, however few photons lie there
};

/// A layer with room for every entry of the geometry, all black.
[[nodiscard]] std::shared_ptr<VdlLayer> emptyLayer(const OctreeGeometry& geometry, int group, const BakeParams& params);

/// Kernels for the leaves of a geometry. Leaves deeper than octree.depth are there to show what larger kernels blur:
/// theirs are no wider than kDetailRadius leaves, unless it takes more to hold kDetailPhotons.
struct LeafKernels {
    DensityKernel usual;
    DensityKernel sparse; ///< in place of `usual` where that holds fewer than `sparse.count` photons
    bool isDetail = false;
    static LeafKernels of(const OctreeGeometry& geometry, const PhotonMap& map, const SurfaceArea& area,
                          const BakeParams& params);
};
inline constexpr float kDetailRadius = 1.5f;
inline constexpr std::uint32_t kDetailPhotons = 24; ///< enough not to show as a dark speck

/// Gathers and clusters the entries of one layer. Any number of threads may fit different entries.
class LayerFit {
public:
    LayerFit(const OctreeGeometry& geometry, const PhotonMap& map, const SurfaceArea& area, const BakeParams& params,
             VdlLayer& layer);
    /// True if the entry's kernel had no area worth the name.
    bool fit(std::uint32_t e, FitScratch& s) const;
    [[nodiscard]] const DensityKernel& kernel() const { return kernels_.usual; }

private:
    const OctreeGeometry& geometry_;
    const PhotonMap& map_;
    const SurfaceArea& area_;
    VdlForm form_;
    VdlLayer& layer_;
    LeafKernels kernels_;
};

} // namespace lightloom
