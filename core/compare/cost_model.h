// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

/// What a bake will cost in CPU-seconds, foretold from a small one (docs/decisions/007).
namespace lightloom {

/// Time of gathering and fitting one entry for one light group, measured.
struct GatherSample {
    double count = 0, photons = 0; ///< K, and photons per group
    double gatherSeconds = 0;      ///< nearest photons and clustering, without the area
    double areaSeconds = 0;        ///< surface under the kernel
};

/// Sums of what the stages cost, each as it grows:
///   rays, lamps, reach, area: fixed        shoot: N         tree: M log2 M for M photons stored
///   octree of depth d: as measured         gather: entries (base + each K + area(K/N)), per light group;
///   gather and tree grow a little with the map's size, since photons of large maps are fetched from further away
struct CostModel {
    double fixedSeconds = 0;
    double groups = 1;                          ///< lamps that are on
    double shootPerPhoton = 0;                  ///< seconds for one photon of one group
    double storedPerPhoton = 1;                 ///< photons stored of one that is shot
    double treePerNLogN = 0;                    ///< seconds
    double gatherBase = 0, gatherPerPhoton = 0; ///< seconds per entry, and per entry and photon of K
    double areaBase = 0, areaPerRatio = 0;      ///< seconds per entry, and per entry and unit of K/N
    double measuredWith = 0; ///< photons stored per group when all this was measured; 0: as many as there will be

    struct Depth {
        int depth = 0;
        double buildSeconds = 0, entries = 0;
    };
    std::vector<Depth> depths; ///< those that were built; none: the method has no octree

    /// Sets gather and area rates from measured entries.
    void fitGather(std::span<const GatherSample> samples);

    /// Seconds of a bake that makes only `depth`, which must be in `depths` (or 0 where there are none).
    [[nodiscard]] double seconds(int depth, double count, double photons) const;
};

} // namespace lightloom
