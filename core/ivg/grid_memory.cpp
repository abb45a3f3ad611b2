// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_memory.h"
#include "core/base/memory_use.h"
#include "core/ivg/grid_batches.h"
#include "core/ivg/grid_deposit.h"
#include "core/ivg/grid_smooth.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace lightloom {

namespace {

/// Of the surface's patches, of what lands on them, and of the grid of one lamp that is fitted.
double fitBytes(const GridLattice& lattice, const GridMemoryJob& job)
{
    const auto vertices = static_cast<double>(lattice.vertexCount());
    const double perVertex = static_cast<double>(IrradianceGrid::bytesPerVertex(GridRemap::joined)) +
                             static_cast<double>(GridLayer::kFitBytesPerVertex) + 2.0 * sizeof(std::array<float, 6>) +
                             2.0 * sizeof(std::uint32_t);
    const glm::vec3 cell = lattice.cellSize;
    const double cellFace = std::cbrt(static_cast<double>(cell.x * cell.y * cell.z));
    const double patches = GridSurface::patchesFor(job.fittedArea, cellFace * cellFace);
    return vertices * perVertex + patches * (GridSurface::kBytesPerPatch + kFitBytesPerPatch +
                                             SurfaceLight::kBytesPerPatch * static_cast<double>(job.groups));
}

} // namespace

GridMemory gridMemory(const GridLattice& lattice, const GridMemoryJob& job)
{
    const auto vertices = static_cast<double>(lattice.vertexCount());
    const bool isFitted = job.fittedArea > 0.0;
    const std::size_t layerBytes = GridLayer::kBytesPerVertex + (isFitted ? GridLayer::kFitBytesPerVertex : 0);
    const double layers = vertices * static_cast<double>(layerBytes * static_cast<std::size_t>(job.groups));
    const double field = vertices * static_cast<double>(IrradianceGrid::bytesPerVertex(job.remap));
    const double geometry = vertices * static_cast<double>(GridOpenness::kBytesPerVertex);
    GridMemory memory;
    memory.kept = geometry + layers + field;

    const double segments = job.segmentsPerPhoton * static_cast<double>(job.photons);
    const std::uint64_t batchPhotons = largestGridBatch(segmentBlocks(job.photons)) * kSegmentBlock;
    const double inBatch = job.mostSegmentsPerPhoton * static_cast<double>(std::min(batchPhotons, job.photons));
    const double ways = std::min(job.mostPathBytes, segments * sizeof(PhotonSegment) * job.groups);
    const double batch = inBatch * (sizeof(PhotonSegment) + GridDeposit::bytesPerSegment() +
                                    (isFitted ? SurfaceLight::kBytesPerSegment : 0.0));
    // what smoothing takes is less than the grid of one lamp, and comes before it and after
    const double fit = isFitted ? fitBytes(lattice, job) : job.isSmoothed ? vertices * kSmoothBytesPerVertex : 0.0;
    const double shown = job.isShown ? 2.0 * (layers + field) : 0.0;
    const double sums = GridDeposit::bytesFor(lattice, job.estimator, job.groups) + layers;
    const double flux = vertices * sizeof(std::array<glm::vec3, 6>); // of one lamp, where slopes are found
    memory.most = geometry + ways + std::max(sums + batch + shown + fit, layers + field + flux);
    return memory;
}

Result<Done> checkGridFits(const GridLattice& lattice, const GridMemoryJob& job)
{
    // in double: the product may be beyond whole numbers
    const double vertices = (lattice.cells.x + 1.0) * (lattice.cells.y + 1.0) * (lattice.cells.z + 1.0);
    const double wanted = gridMemory(lattice, job).most, have = 0.9 * machineMemoryBytes();
    if (wanted <= have && vertices < 2e9) return Done{};
    return Error{
        Error::Kind::outOfMemory,
        fmt::format("a grid of {} x {} x {} cells for {} light groups needs about {:.1f} GiB, this machine has "
                    "{:.1f}; lower grid.size",
                    lattice.cells.x, lattice.cells.y, lattice.cells.z, job.groups, wanted / (1 << 30),
                    have / (1 << 30))};
}

} // namespace lightloom
