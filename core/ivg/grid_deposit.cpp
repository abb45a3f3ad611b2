// SPDX-License-Identifier: Apache-2.0
#include "core/ivg/grid_deposit.h"
#include "core/base/units.h"
#include "core/base/wide_vectors.h"
#include "core/ivg/grid_walk.h"
#include <algorithm>
#include <atomic>
#include <cmath>

namespace lightloom {
namespace {

/// What is summed at one face or in one octant of a cell: the vector's components R x y z, G x y z, B x y z, then
/// squares of luminance for the variance (one for faces, one per axis for cells).
constexpr std::size_t kSummed = 12, kSquares = 9;

struct alignas(64) Slot {
    std::array<float, kSummed> sums{};
    std::uint64_t parts = 0; ///< of the face, what is open (GridOpenness::faceParts)
    void add(std::size_t four, const Floats4& values) { lanesOf<Floats4>(sums.data(), four) += values; }
};
using Totals = std::array<double, kSummed>;

constexpr std::size_t kSlabBytes = 1 << 20; ///< of slots that a thread works on at a time: they stay in its cache

/// A segment in grid coordinates.
struct GridSegment {
    glm::vec3 from, to, toLight, flux;
    float length;  ///< metres
    bool isInside; ///< both ends are in the grid, and with them all between
};

/// The planes of one axis that a segment crosses, in little memory: slabs look at all segments, and most cross others.
struct ShortRange {
    std::int16_t first = 0, last = -1;
    explicit ShortRange(PlaneRange r = {})
        : first(static_cast<std::int16_t>(r.first)), last(static_cast<std::int16_t>(r.last))
    {
    }
    [[nodiscard]] PlaneRange within(PlaneRange o) const { return PlaneRange{first, last}.within(o); }
};

/// What one block of photons left, ready to be summed.
struct SegmentList {
    RawVector<GridSegment> segments;
    std::array<std::vector<ShortRange>, 3> crossed; ///< by axis and segment
};

std::size_t slotsPerVertex(GridEstimator estimator) { return estimator == GridEstimator::tracks ? 8 : 6; }

std::array<Floats4, 3> packed(const glm::vec3& w, const glm::vec3& flux, const glm::vec3& squares)
{
    const glm::vec3 r = w * flux.x, g = w * flux.y, b = w * flux.z;
    return {Floats4{r.x, r.y, r.z, g.x}, Floats4{g.y, g.z, b.x, b.y}, Floats4{b.z, squares.x, squares.y, squares.z}};
}

/// Resizes what is to be written anew: nothing is copied, and what is too small is freed before, not after.
template<class Vector>
void resizeAnew(Vector& values, std::size_t size)
{
    if (values.capacity() < size) {
        values = Vector();
        values.reserve(size + size / 16); // blocks differ
    }
    values.resize(size);
}

std::uint64_t bitOf(float x, float y, int parts)
{
    const int i = std::min(static_cast<int>(x * static_cast<float>(parts)), parts - 1);
    const int j = std::min(static_cast<int>(y * static_cast<float>(parts)), parts - 1);
    return std::uint64_t{1} << (i + parts * j);
}

glm::mat3 matrixOf(const Totals& sums, double scale)
{
    glm::mat3 m;
    for (int channel = 0; channel < 3; ++channel) {
        for (int c = 0; c < 3; ++c)
            m[channel][c] = static_cast<float>(sums[static_cast<std::size_t>(3 * channel + c)] * scale);
    }
    return m;
}

} // namespace

/// Slots of one estimator, empty between calls. They lie by (axis, plane, v, u, side) for faces, by (vertex, octant)
/// for cells, so that a slab of planes is one stretch of memory.
struct GridDeposit::Work {
    Work(std::shared_ptr<const GridGeometry> at, GridEstimator how) : geometry(std::move(at)), estimator(how)
    {
        slots.resize(slotsPerVertex(how) * lattice().vertexCount());
        if (isTracks()) return;
        for (std::size_t i = 0; i < lattice().vertexCount(); ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                for (int side = 0; side < 2; ++side)
                    slots[faceIndex(axis, lattice().vertex(i), side)].parts =
                        openness().faceParts[i][std::size_t(axis)];
            }
        }
    }
    [[nodiscard]] const GridLattice& lattice() const { return geometry->lattice; }
    [[nodiscard]] const GridOpenness& openness() const { return geometry->openness; }
    [[nodiscard]] bool isTracks() const { return estimator == GridEstimator::tracks; }

    [[nodiscard]] std::size_t faceIndex(int axis, glm::ivec3 vertex, int side) const
    {
        const glm::ivec3 n = lattice().vertices();
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const std::size_t row = std::size_t(vertex[axis]) * std::size_t(n[v]) + std::size_t(vertex[v]);
        return 2 * (std::size_t(axis) * lattice().vertexCount() + row * std::size_t(n[u]) + std::size_t(vertex[u])) +
               std::size_t(side);
    }

    /// Grid planes of `axis`, or layers of cells, that one task takes.
    struct Slab {
        int axis;
        PlaneRange planes;
    };
    [[nodiscard]] std::vector<Slab> slabs() const
    {
        const glm::ivec3 n = lattice().vertices();
        std::vector<Slab> all;
        for (int axis = isTracks() ? 2 : 0; axis < 3; ++axis) {
            const std::size_t perPlane =
                std::size_t(n[(axis + 1) % 3]) * std::size_t(n[(axis + 2) % 3]) * (isTracks() ? 8 : 2) * sizeof(Slot);
            const int step = std::max(1, static_cast<int>(kSlabBytes / perPlane));
            for (int plane = 0; plane < n[axis]; plane += step)
                all.push_back({axis, {plane, std::min(plane + step, n[axis]) - 1}});
        }
        return all;
    }

    std::uint64_t cross(const SegmentList& list, const Slab& slab)
    {
        std::uint64_t count = 0;
        const std::vector<ShortRange>& crossed = list.crossed[static_cast<std::size_t>(slab.axis)];
        for (std::size_t i = 0; i < crossed.size(); ++i) {
            const PlaneRange planes = crossed[i].within(slab.planes);
            if (planes.first <= planes.last) count += cross(list.segments[i], slab.axis, planes);
        }
        return count;
    }

    std::uint64_t cross(const GridSegment& s, int axis, PlaneRange planes)
    {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        glm::vec3 w = s.toLight;
        const float along = std::abs(w[axis]), light = luminance(s.flux);
        float square = light * along;
        if (estimator == GridEstimator::crossings) {
            w /= std::max(along, kLeastCosine);
            w[axis] = std::copysign(1.0f, w[axis]);
            square = light;
        }
        const std::array<Floats4, 3> values = packed(w, s.flux, glm::vec3(square * square, 0.0f, 0.0f));
        const int side = s.to[axis] < s.from[axis] ? 1 : 0; // light comes from where the photon does
        const auto mostU = static_cast<float>(lattice().cells[u]), mostV = static_cast<float>(lattice().cells[v]);
        const auto rowU = std::size_t(lattice().cells[u] + 1), rowV = std::size_t(lattice().cells[v] + 1);
        Slot* const first = slots.data() + 2 * std::size_t(axis) * lattice().vertexCount() + std::size_t(side);
        std::uint64_t count = 0;
        forPlanes(s.from, s.to, axis, planes, [&](int plane, float atU, float atV) {
            if (!s.isInside && !(atU >= 0.0f && atU <= mostU && atV >= 0.0f && atV <= mostV)) return;
            const int i = static_cast<int>(atU + 0.5f), j = static_cast<int>(atV + 0.5f);
            Slot& slot = first[2 * ((std::size_t(plane) * rowV + std::size_t(j)) * rowU + std::size_t(i))];
            if (slot.parts != ~std::uint64_t{0}) {
                const float x = atU + 0.5f - static_cast<float>(i), y = atV + 0.5f - static_cast<float>(j);
                if ((slot.parts & bitOf(x, y, GridOpenness::kParts)) == 0) return;
            }
            for (std::size_t k = 0; k < values.size(); ++k) slot.add(k, values[k]);
            ++count;
        });
        return count;
    }

    std::uint64_t pass(const SegmentList& list, const Slab& slab)
    {
        std::uint64_t count = 0;
        for (const GridSegment& s : list.segments) count += pass(s, slab);
        return count;
    }

    std::uint64_t pass(const GridSegment& s, const Slab& slab)
    {
        const float low = std::min(s.from.z, s.to.z), high = std::max(s.from.z, s.to.z);
        if (high < static_cast<float>(slab.planes.first) - 0.5f || low > static_cast<float>(slab.planes.last) + 0.5f)
            return 0;
        const float light = luminance(s.flux);
        const std::array<Floats4, 3> values = packed(s.toLight, s.flux, light * light * s.toLight * s.toLight);
        const std::size_t octant =
            (s.toLight.x > 0.0f ? 1u : 0u) + (s.toLight.y > 0.0f ? 2u : 0u) + (s.toLight.z > 0.0f ? 4u : 0u);
        std::uint64_t count = 0;
        forPieces(s.from, s.to, lattice().cells, slab.planes, [&](const glm::ivec3& vertex, float begin, float share) {
            const std::size_t index = lattice().index(vertex);
            const glm::vec3 middle = s.from + (begin + 0.5f * share) * (s.to - s.from) - glm::vec3(vertex) + 0.5f;
            const int level = std::clamp(static_cast<int>(middle.z * 4.0f), 0, 3);
            const std::uint64_t bit = bitOf(glm::max(middle.x, 0.0f), glm::max(middle.y, 0.0f), 4) << (16 * level);
            if ((openness().cellParts[index] & bit) == 0) return;
            Slot& slot = slots[8 * index + octant];
            const float way = share * s.length;
            const Floats4 last{way, way * way, way * way, way * way};
            slot.add(0, values[0] * way);
            slot.add(1, values[1] * way);
            slot.add(2, values[2] * last);
            ++count;
        });
        return count;
    }

    [[nodiscard]] GridSegment toGrid(const PhotonSegment& s) const
    {
        // far enough to leave the grid from anywhere in it
        const glm::vec3 size = glm::vec3(lattice().cells) * lattice().cellSize;
        const float length = std::min(s.length, 2.0f * glm::length(size));
        const glm::vec3 from = lattice().toGrid(s.from), to = lattice().toGrid(s.from + length * s.travel);
        const bool isInside = glm::all(glm::greaterThanEqual(glm::min(from, to), glm::vec3(0.0f))) &&
                              glm::all(glm::lessThanEqual(glm::max(from, to), glm::vec3(lattice().cells)));
        return {from, to, -s.travel, s.flux, length, isInside};
    }

    void read(const SegmentBlock& block, SegmentList& list) const
    {
        resizeAnew(list.segments, block.segments.size());
        std::ranges::transform(block.segments, list.segments.begin(),
                               [&](const PhotonSegment& s) { return toGrid(s); });
        for (int axis = 0; axis < (isTracks() ? 0 : 3); ++axis) {
            const PlaneRange all{0, lattice().cells[axis]};
            auto& crossed = list.crossed[static_cast<std::size_t>(axis)];
            resizeAnew(crossed, list.segments.size());
            std::ranges::transform(list.segments, crossed.begin(), [&](const GridSegment& s) {
                return ShortRange(crossedPlanes(s.from[axis], s.to[axis]).within(all));
            });
        }
    }

    /// Moves the sums of a stretch of slots to totals.
    void settle(std::size_t first, std::size_t end, std::vector<Totals>& totals)
    {
        for (std::size_t i = first; i < end; ++i) {
            for (std::size_t k = 0; k < kSummed; ++k) totals[i][k] += static_cast<double>(slots[i].sums[k]);
            slots[i].sums = {};
        }
    }

    /// m2, what is open of a face; 0 where nothing is.
    [[nodiscard]] double openArea(std::size_t index, int axis) const
    {
        const glm::ivec3 vertex = lattice().vertex(index);
        double area = static_cast<double>(lattice().faceArea(axis) * openness().faceShare[index][axis]);
        for (const int across : {(axis + 1) % 3, (axis + 2) % 3}) area *= isBorder(vertex, across) ? 0.5 : 1.0;
        return area;
    }
    [[nodiscard]] double openVolume(std::size_t index) const
    {
        const glm::ivec3 vertex = lattice().vertex(index);
        double volume = static_cast<double>(lattice().cellVolume() * openness().cellShare[index]);
        for (int axis = 0; axis < 3; ++axis) volume *= isBorder(vertex, axis) ? 0.5 : 1.0;
        return volume;
    }
    [[nodiscard]] bool isBorder(glm::ivec3 vertex, int axis) const
    {
        return vertex[axis] == 0 || vertex[axis] == lattice().cells[axis];
    }

    std::shared_ptr<const GridGeometry> geometry;
    GridEstimator estimator;
    std::vector<Slot> slots;
    std::vector<SegmentList> lists; // of the call's blocks
};

GridDeposit::GridDeposit(std::shared_ptr<const GridGeometry> geometry, GridEstimator estimator)
    : GridDeposit(std::make_shared<Work>(std::move(geometry), estimator))
{
}
GridDeposit::GridDeposit(std::shared_ptr<Work> work) : work_(std::move(work)), totals_(work_->slots.size(), Totals{}) {}
GridDeposit::~GridDeposit() = default;

std::unique_ptr<GridDeposit> GridDeposit::another() const
{
    return std::unique_ptr<GridDeposit>(new GridDeposit(work_));
}

bool GridDeposit::add(std::span<const SegmentBlock* const> blocks, Workers& workers, const std::stop_token& stop)
{
    Work& work = *work_;
    work.lists.resize(std::max(work.lists.size(), blocks.size()));
    const bool isRead = workers.run(blocks.size(), stop, [&](std::size_t b) { work.read(*blocks[b], work.lists[b]); });
    if (!isRead) return false;
    const auto slabs = work.slabs();
    std::atomic<std::uint64_t> deposits = 0;
    const bool isSummed = workers.run(slabs.size(), stop, [&](std::size_t task) {
        std::uint64_t count = 0;
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            if (stop.stop_requested()) return;
            const SegmentList& list = work.lists[b];
            count += work.isTracks() ? work.pass(list, slabs[task]) : work.cross(list, slabs[task]);
        }
        deposits += count;
    });
    deposits_ += deposits;
    if (!isSummed || stop.stop_requested()) return false;
    constexpr std::size_t kStretch = 4096;
    const std::size_t stretches = (work.slots.size() + kStretch - 1) / kStretch;
    return workers.run(stretches, stop, [&](std::size_t s) {
        work.settle(s * kStretch, std::min(work.slots.size(), (s + 1) * kStretch), totals_);
    });
}

std::uint64_t GridDeposit::deposits() const { return deposits_; }

GridLayer GridDeposit::layer(int group, double scale) const
{
    const Work& work = *work_;
    const GridLattice& lattice = work.lattice();
    GridLayer layer{group, {}, {}};
    layer.vectors.resize(lattice.vertexCount(), IrradianceVectors{});
    layer.variance.resize(lattice.vertexCount(), {});
    for (std::size_t i = 0; i < lattice.vertexCount(); ++i) {
        for (std::size_t d = 0; d < 6; ++d) {
            const int axis = static_cast<int>(d / 2), side = static_cast<int>(d % 2);
            const double open = work.isTracks() ? work.openVolume(i) : work.openArea(i, axis);
            if (open <= 0.0) continue;
            Totals total{};
            double square = 0.0;
            if (work.isTracks()) {
                for (std::size_t octant = 0; octant < 8; ++octant) {
                    if (static_cast<int>(octant >> axis & 1) != side) continue;
                    const Totals& part = totals_[8 * i + octant];
                    for (std::size_t k = 0; k < kSquares; ++k) total[k] += part[k];
                    square += part[kSquares + std::size_t(axis)];
                }
            } else {
                total = totals_[work.faceIndex(axis, lattice.vertex(i), side)];
                square = total[kSquares];
            }
            layer.vectors[i][d] = matrixOf(total, scale / open);
            layer.variance[i][d] = static_cast<float>(square * (scale / open) * (scale / open));
        }
    }
    return layer;
}

double GridDeposit::bytesFor(const GridLattice& lattice, GridEstimator estimator, int groups)
{
    return static_cast<double>(lattice.vertexCount() * slotsPerVertex(estimator)) *
           static_cast<double>(sizeof(Slot) + static_cast<std::size_t>(groups) * sizeof(Totals));
}

double GridDeposit::bytesPerSegment() { return sizeof(GridSegment) + 3 * sizeof(ShortRange); }

} // namespace lightloom
