// SPDX-License-Identifier: Apache-2.0
#include "core/transport/voxel_lines.h"
#include <cassert>

namespace lightloom {
namespace {

constexpr std::uint16_t VoxelPlace::*kDigits[] = {&VoxelPlace::v, &VoxelPlace::u, &VoxelPlace::slice}; // least first

/// One pass of a radix sort: stable, by one coordinate.
void sortBy(std::uint16_t VoxelPlace::*digit, int cells, std::vector<VoxelPlace>& places,
            std::vector<VoxelPlace>& spare)
{
    std::vector<std::uint32_t> next(static_cast<std::size_t>(cells) + 1, 0);
    for (const VoxelPlace& p : places) ++next[p.*digit + std::size_t(1)];
    for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
    spare.resize(places.size());
    for (const VoxelPlace& p : places) spare[next[p.*digit]++] = p;
    places.swap(spare);
}

/// floor(-step * slice / largest + 1/2), largest > 0.
int stepsAside(int step, int slice, int largest)
{
    const int twice = largest - 2 * step * slice, whole = twice / (2 * largest);
    return twice < whole * 2 * largest ? whole - 1 : whole;
}

} // namespace

VoxelOrders::VoxelOrders(const SurfaceVoxels& voxels)
{
    static_assert(kMostVoxels <= 65'536);
    std::vector<VoxelPlace> spare;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<VoxelPlace>& places = orders_[static_cast<std::size_t>(axis)];
        places.reserve(voxels.voxels.size());
        for (std::uint32_t i = 0; i < voxels.voxels.size(); ++i) {
            const glm::ivec3 cell = voxels.voxels[i];
            assert(glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) &&
                   glm::all(glm::lessThan(cell, glm::ivec3(voxels.cells))));
            const auto at = [&](int a) { return static_cast<std::uint16_t>(cell[a % 3]); };
            places.push_back({at(axis), at(axis + 1), at(axis + 2), i});
        }
        for (const auto digit : kDigits) sortBy(digit, voxels.cells, places, spare);
    }
}

LineNumbers::LineNumbers(const LineDirection& direction, int cells)
{
    static_assert(2ll * kLargestStep * kMostVoxels < 1 << 20); // products stay far from the largest int
    assert(cells >= 1 && cells <= kMostVoxels);
    const int axis = direction.major, a = direction.step[axis], b = direction.step[(axis + 1) % 3],
              c = direction.step[(axis + 2) % 3];
    assert(a > 0 && a <= kLargestStep && glm::abs(b) <= a && glm::abs(c) <= a);
    // steps aside rise or fall with the slice: the last one is the furthest
    const int lastU = stepsAside(b, cells - 1, a), lastV = stepsAside(c, cells - 1, a);
    width_ = static_cast<std::uint32_t>(cells + glm::abs(lastV));
    count_ = static_cast<std::uint32_t>(cells + glm::abs(lastU)) * width_;
    offsets_.resize(static_cast<std::size_t>(cells));
    for (int slice = 0; slice < cells; ++slice) {
        const int u = stepsAside(b, slice, a) - glm::min(lastU, 0), v = stepsAside(c, slice, a) - glm::min(lastV, 0);
        offsets_[static_cast<std::size_t>(slice)] =
            static_cast<std::uint32_t>(u) * width_ + static_cast<std::uint32_t>(v);
    }
}

} // namespace lightloom
