// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_memory.h"
#include "core/base/memory_use.h"
#include "core/ivg/grid_batches.h"
#include "core/ivg/grid_deposit.h"
#include <algorithm>
#include <fmt/format.h>

namespace lightloom {

GridMemory gridMemory(const GridLattice& lattice, const GridMemoryJob& job)
{
    const auto vertices = static_cast<double>(lattice.vertexCount());
    const double layers =
        vertices * static_cast<double>(GridLayer::kBytesPerVertex * static_cast<std::size_t>(job.groups));
    const double field = vertices * static_cast<double>(IrradianceGrid::bytesPerVertex(job.remap));
    const double geometry = vertices * static_cast<double>(GridOpenness::kBytesPerVertex);
    GridMemory memory;
    memory.kept = geometry + layers + field;

    const double segments = job.segmentsPerPhoton * static_cast<double>(job.photons);
    const std::uint64_t batchPhotons = largestGridBatch(segmentBlocks(job.photons)) * kSegmentBlock;
    const double inBatch = job.mostSegmentsPerPhoton * static_cast<double>(std::min(batchPhotons, job.photons));
    const double ways = std::min(job.mostPathBytes, segments * sizeof(PhotonSegment) * job.groups);
    const double batch = inBatch * (sizeof(PhotonSegment) + GridDeposit::bytesPerSegment());
    const double shown = job.isShown ? 2.0 * (layers + field) : 0.0;
    const double sums = GridDeposit::bytesFor(lattice, job.estimator, job.groups) + layers;
    const double flux = vertices * sizeof(std::array<glm::vec3, 6>); // of one lamp, where slopes are found
    memory.most = geometry + ways + std::max(sums + batch + shown, layers + field + flux);
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
