// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/result.h"
#include "core/ivg/irradiance_grid.h"

namespace lightloom {

/// What a bake of a grid will take, bytes; computed before it.
struct GridMemory {
    double kept = 0.0; ///< the finished field with its layers, as IrradianceGrid::memoryBytes counts
    double most = 0.0; ///< at once while it is made, with sums, segments of a batch and kept ways
};

/// What decides on it.
struct GridMemoryJob {
    int groups = 1; ///< light groups that are on
    std::uint64_t photons = 0;
    double segmentsPerPhoton = 0.0;     ///< mean over the light groups
    double mostSegmentsPerPhoton = 0.0; ///< of one of them
    double mostPathBytes = 0.0;         ///< of kept ways, over all groups
    GridEstimator estimator = GridEstimator::crossings;
    GridRemap remap = GridRemap::joined;
    double fittedArea = 0.0; ///< m2, of the surface that light is fitted to; 0: none
    bool isSmoothed = false;
    bool isShown = false; ///< snapshots are published meanwhile: one is shown while the next is made
};
[[nodiscard]] GridMemory gridMemory(const GridLattice& lattice, const GridMemoryJob& job);

/// Error out of memory where `most` is more than nine tenths of this machine's memory, or vertices cannot be counted.
[[nodiscard]] Result<Done> checkGridFits(const GridLattice& lattice, const GridMemoryJob& job);

} // namespace lightloom
