// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/octree/light_octree.h"
#include "core/octree/vdl_cluster.h"
#include "core/photonmap/density.h"

namespace lightloom {

/// What one thread needs to fit entries.
struct FitScratch {
    Gathered gathered; ///< of the entry that was fitted last
    ClusterScratch clusters;
    std::vector<LightVector> lights;
};

/// A layer with room for every entry of the geometry, all black.
[[nodiscard]] std::shared_ptr<VdlLayer> emptyLayer(const OctreeGeometry& geometry, int group, const BakeParams& params);

/// Gathers and clusters the entries of one layer. Any number of threads may fit different entries.
class LayerFit {
public:
    LayerFit(const OctreeGeometry& geometry, const PhotonMap& map, const SurfaceArea& area, const BakeParams& params,
             VdlLayer& layer);
    /// True if the entry's kernel had no area worth the name.
    bool fit(std::uint32_t e, FitScratch& s) const;
    [[nodiscard]] const DensityKernel& kernel() const { return kernel_; }

private:
    const OctreeGeometry& geometry_;
    const PhotonMap& map_;
    const SurfaceArea& area_;
    VdlForm form_;
    VdlLayer& layer_;
    DensityKernel kernel_;
};

} // namespace lightloom
