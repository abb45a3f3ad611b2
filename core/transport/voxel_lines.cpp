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

/// Which way a normal faces: one of 24 parts of the sphere.
std::size_t facing(glm::vec3 n)
{
    const glm::vec3 size = glm::abs(n);
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    return axis * 8 + std::size_t(n.x < 0.0f) * 4 + std::size_t(n.y < 0.0f) * 2 + std::size_t(n.z < 0.0f);
}

/// Lays the entries of voxels that are in order into slots.
class SlotFiller {
public:
    SlotFiller(const SurfaceVoxels& voxels, const SurfaceBends& bends, WalkOrder& order)
        : voxels_(voxels), bends_(bends), order_(order)
    {
        const std::size_t slots = voxels.entries.size() + WalkOrder::kSpare;
        for (std::vector<std::uint32_t>* field : {&order.entry, &order.voxel, &order.uv, &order.edges})
            field->resize(slots);
        order.slice.resize(slots), order.planes.resize(slots);
        for (std::vector<float>* field :
             {&order.x, &order.y, &order.z, &order.area, &order.bend, &order.bendX, &order.bendY, &order.bendZ})
            field->resize(slots);
    }

    void fill()
    {
        const std::vector<VoxelPlace>& places = order_.places;
        std::size_t first = 0, end = 0;
        for (int slice = 0; slice < voxels_.cells; ++slice, first = end) {
            while (end < places.size() && places[end].slice == slice) ++end;
            fillSlice(std::span(places).subspan(first, end - first));
        }
        order_.firstSlot.push_back(next_);
        std::fill(order_.entry.begin() + next_, order_.entry.end(), WalkOrder::kNoEntry);
    }

private:
    static constexpr std::size_t kBent = 24, kSeveral = 48;
    [[nodiscard]] std::size_t kindOf(const VoxelPlace& place) const
    {
        const std::uint32_t first = voxels_.firstEntry[place.voxel];
        if (voxels_.firstEntry[place.voxel + 1] - first > 1) return kSeveral;
        return facing(voxels_.entries[first].normal) + (bends_.isBent(first) ? kBent : 0);
    }
    void fillSlice(std::span<const VoxelPlace> places)
    {
        std::array<std::vector<VoxelPlace>, kSeveral + 1>& kinds = byKind_;
        for (std::vector<VoxelPlace>& kind : kinds) kind.clear();
        for (const VoxelPlace& place : places) kinds[kindOf(place)].push_back(place);
        order_.firstSlot.push_back(next_);
        for (std::size_t k = 0; k <= kSeveral; ++k) {
            if (k == kBent) order_.firstBent.push_back(next_);
            if (k == kSeveral) order_.firstOfSeveral.push_back(next_);
            for (const VoxelPlace& place : kinds[k]) fillVoxel(place);
        }
    }
    void fillVoxel(const VoxelPlace& place)
    {
        for (std::uint32_t e = voxels_.firstEntry[place.voxel]; e < voxels_.firstEntry[place.voxel + 1]; ++e, ++next_) {
            const Orientation& o = voxels_.entries[e];
            order_.entry[next_] = e, order_.voxel[next_] = place.voxel, order_.area[next_] = o.area;
            order_.slice[next_] = place.slice;
            const glm::vec3 at = (o.centroid - voxels_.lattice.lowest) / voxels_.cellSize();
            order_.planes[next_] = {at, glm::dot(at, o.normal), o.normal, static_cast<float>(place.slice)};
            order_.uv[next_] = place.u | static_cast<std::uint32_t>(place.v) << 16;
            order_.x[next_] = o.normal.x, order_.y[next_] = o.normal.y, order_.z[next_] = o.normal.z;
            const SurfaceBend& bend = bends_.bends[e];
            order_.edges[next_] = bends_.number[e];
            order_.bend[next_] = bend.least, order_.bendX[next_] = bend.most.x, order_.bendY[next_] = bend.most.y,
            order_.bendZ[next_] = bend.most.z;
        }
    }

    const SurfaceVoxels& voxels_;
    const SurfaceBends& bends_;
    WalkOrder& order_;
    std::uint32_t next_ = 0;
    std::array<std::vector<VoxelPlace>, kSeveral + 1> byKind_;
};

/// The same for the papers' walk, in lexicographic order: what it reads, and no more.
void fillPlain(const SurfaceVoxels& voxels, WalkOrder& order)
{
    const std::size_t slots = order.places.size() + WalkOrder::kSpare;
    order.entry.resize(slots, WalkOrder::kNoEntry), order.uv.resize(slots);
    order.x.resize(slots), order.y.resize(slots), order.z.resize(slots);
    std::uint32_t slot = 0;
    for (int slice = 0; slice <= voxels.cells; ++slice) {
        order.firstSlot.push_back(slot);
        for (; slot < order.places.size() && order.places[slot].slice == slice; ++slot) {
            const VoxelPlace& place = order.places[slot];
            const glm::vec3 n = voxels.entries[place.voxel].normal;
            order.entry[slot] = place.voxel;
            order.uv[slot] = place.u | static_cast<std::uint32_t>(place.v) << 16;
            order.x[slot] = n.x, order.y[slot] = n.y, order.z[slot] = n.z;
        }
    }
}

/// floor(-step * slice / largest + 1/2), largest > 0.
int stepsAside(int step, int slice, int largest)
{
    const int twice = largest - 2 * step * slice, whole = twice / (2 * largest);
    return twice < whole * 2 * largest ? whole - 1 : whole;
}

} // namespace

std::shared_ptr<const SurfaceVoxels> voxelsFor(VoxelLines lines, std::shared_ptr<const SurfaceVoxels> voxels)
{
    if (lines == VoxelLines::covered) return voxels;
    return std::make_shared<const SurfaceVoxels>(withMeanNormals(*voxels));
}

VoxelOrders::VoxelOrders(const SurfaceVoxels& voxels, VoxelLines lines)
    : lines_(lines), rows_(std::make_shared<const RowOrder>(voxels.entries))
{
    static_assert(kMostVoxels <= 65'536);
    assert(lines == VoxelLines::covered || voxels.entries.size() == voxels.voxels.size());
    std::vector<VoxelPlace> spare;
    SurfaceBends bends = lines == VoxelLines::covered ? surfaceBends(voxels) : SurfaceBends{};
    for (int axis = 0; axis < 3; ++axis) {
        WalkOrder& order = orders_[static_cast<std::size_t>(axis)];
        order.places.reserve(voxels.voxels.size());
        for (std::uint32_t i = 0; i < voxels.voxels.size(); ++i) {
            const glm::ivec3 cell = voxels.voxels[i];
            assert(glm::all(glm::greaterThanEqual(cell, glm::ivec3(0))) &&
                   glm::all(glm::lessThan(cell, glm::ivec3(voxels.cells))));
            const auto at = [&](int a) { return static_cast<std::uint16_t>(cell[a % 3]); };
            order.places.push_back({at(axis), at(axis + 1), at(axis + 2), i});
        }
        for (const auto digit : kDigits) sortBy(digit, voxels.cells, order.places, spare);
        lines == VoxelLines::covered ? SlotFiller(voxels, bends, order).fill() : fillPlain(voxels, order);
    }
    edges_ = std::move(bends.edges);
}

std::size_t VoxelOrders::memoryBytes() const
{
    std::size_t bytes = edges_.size() * sizeof(SurfaceBends::Edges) + rows_->memoryBytes();
    for (const WalkOrder& order : orders_) {
        constexpr std::size_t kSlot =
            4 * sizeof(std::uint32_t) + sizeof(std::uint16_t) + 8 * sizeof(float) + sizeof(Plane);
        bytes += order.places.size() * sizeof(VoxelPlace) + order.entry.size() * kSlot;
    }
    return bytes;
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
